"""``make certify``: write a certificate of a scene's export, and run its script.

``build/<scene>/certificate`` holds the export, what it was made from, and a script that shows that
it computes the network of the scene (docs/certificate.md). The script runs at once, and the page
says what it found. The exit code is that of the script, with 0 for amber.
"""

import shutil
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

from golden.input_error import InputError
from tactus.certify.delivered import (
    CELLS,
    LANGUAGES,
    OUTPUT,
    SCRIPT,
    STEPS,
    CertifyOptions,
    StepResult,
    check,
    deliver,
    read_results,
    write_digests,
)
from tactus.certify.page import write_page
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.files import check_room, replace_folder
from tactus.core.folders import BUILD
from tactus.core.hold import held
from tactus.core.machine import processor_line, processor_minutes
from tactus.core.progress import stage
from tactus.scene import Scene
from tactus.verify.benches.runner import export, ready_scene
from tactus.verify.sign_off.netlist import chosen
from tactus.verify.sign_off.unknown import UNKNOWN

# After so many seconds without a line, one says what is running.
SILENCE = 15.0


def certify(scene: Scene, wanted: CertifyOptions, build: Path = BUILD) -> list[StepResult]:
    """Write the certificate of a scene; return what its script found."""
    with (
        stage(f"{scene.name}: exporting"),
        ThreadPoolExecutor() as pool,
    ):
        list(pool.map(lambda language: export(scene, language, build), LANGUAGES))
    # Tools run in folders of their own, so the path is absolute.
    with replace_folder((build / scene.name / "certificate").resolve()) as folder:
        with room_in(folder):
            print(f"{scene.name}: writing the certificate", flush=True)
            parts = ["reading"]

            def tell(text: str) -> None:
                print(f"  {text}", flush=True)
                parts.append(text)

            with stage(lambda: f"  still {parts[-1]}", quick=True, pause=SILENCE):
                made = deliver(scene, build, folder, wanted, tell)
            digests = write_digests(folder)
            print(f"{scene.name}: running {SCRIPT}", flush=True)
            with stage(lambda: f"  still {_running(folder, wanted)}", quick=True, pause=SILENCE):
                check(folder)
        results = read_results(folder)
        write_page(made, results, digests, folder)
        if all(result.colour != "red" for result in results):
            shutil.rmtree(folder / OUTPUT)
        write_digests(folder)
    return results


def _running(folder: Path, wanted: CertifyOptions) -> str:
    """The step of the script that runs, which is the one behind the last result."""
    due = [step for step in STEPS if step != CELLS or wanted.families]
    return f"step {due[min(len(read_results(folder)), len(due) - 1)]}"


@contextmanager
def room_in(folder: Path) -> Iterator[None]:
    """Say so if a step failed, or may have, because a disk is full: tools do not always tell."""
    try:
        yield
    except (InputError, OSError, RuntimeError, subprocess.SubprocessError):
        check_room(folder.parent, "the hardware")
        raise
    check_room(folder.parent, "the hardware")


def main() -> int:
    arguments = arguments_of("certify", __doc__)
    scene = ready_scene(arguments.scene)
    families = chosen(arguments.netlist) if arguments.netlist else []
    folder = BUILD / scene.name / "certificate"
    stop_if_dry_run(f"export scene {scene.name}, write {folder} and run its {SCRIPT}")
    wanted = CertifyOptions(
        arguments.frames,
        arguments.seed,
        tuple(name for name in families if name != UNKNOWN),
        arguments.recorded,
    )
    with held([BUILD / scene.name]):
        results = certify(scene, wanted)
    print(f"wrote {folder / 'certificate.html'}")
    print(processor_line(processor_minutes()))
    return int(any(result.colour == "red" for result in results))


if __name__ == "__main__":
    sys.exit(run(main))
