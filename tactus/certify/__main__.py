"""``make certify``: write a certificate of a scene's export, and run its script.

``build/<scene>/certificate`` holds the export, what it was made from, and a script that shows that
it computes the network of the scene (docs/certificate.md). The script runs at once, and the page
says what it found. The exit code is that of the script, with 0 for amber.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

from golden.input_error import InputError
from tactus.certify.benches import bench_result
from tactus.certify.delivered import (
    CELLS,
    LANGUAGES,
    SCRIPT,
    STEPS,
    CertifyOptions,
    check,
    deliver,
    write_digests,
)
from tactus.certify.page import write_page
from tactus.certify.picture import draw_page, picture_file
from tactus.certify.results import OUTPUT, StepResult, read_results
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.files import check_output, check_room, replace_folder
from tactus.core.folders import BUILD
from tactus.core.hold import held
from tactus.core.machine import processor_line, processor_minutes
from tactus.core.progress import Heartbeat, duration, stage
from tactus.scene import Scene
from tactus.verify.benches.runner import export, ready_scene
from tactus.verify.sign_off.netlist import chosen
from tactus.verify.sign_off.unknown import UNKNOWN

# After so many seconds without a line, one says what is running.
SILENCE = 15.0


def certify(scene: Scene, wanted: CertifyOptions, build: Path = BUILD) -> list[StepResult]:
    """Write the certificate of a scene; return what its script and the benches found."""
    with (
        stage(f"{scene.name}: exporting"),
        ThreadPoolExecutor() as pool,
    ):
        list(pool.map(lambda language: export(scene, language, build), LANGUAGES))
    # Tools run in folders of their own, so the path is absolute.
    with replace_folder((build / scene.name / "certificate").resolve()) as folder:
        with room_in(folder):
            print(f"{scene.name}: writing the certificate", flush=True)
            with Told() as told:
                made = deliver(scene, build, folder, wanted, told.tell)
            digests = write_digests(folder)
            print(f"{scene.name}: running {SCRIPT}", flush=True)
            with Told(lambda: _running(folder, wanted)):
                check(folder)
        results = [*read_results(folder), bench_result(made.benches, len(made.jobs))]
        write_page(made, results, digests, folder)
        if all(result.colour != "red" for result in results):
            shutil.rmtree(folder / OUTPUT)
        write_digests(folder)
    return results


def _tell(text: str) -> None:
    print(f"  {text}", flush=True)


def _running(folder: Path, wanted: CertifyOptions) -> str:
    """The step of the script that runs, which is the one behind the last result."""
    due = [step for step in STEPS if step != CELLS or wanted.families]
    done = len(read_results(folder))
    return f"step {due[done]}" if done < len(due) else ""


class Told:
    """Prints each part of a long work when it begins, and again while it is the newest one.

    now: The part that runs, where it is not told; empty for none.
    """

    def __init__(self, now: Callable[[], str] | None = None) -> None:
        self._newest = ""
        self._now = now or (lambda: self._newest)
        self._began = self._printed = time.monotonic()
        self._heartbeat = Heartbeat(self._beat)

    def __enter__(self) -> Told:
        self._heartbeat.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        self._heartbeat.__exit__(*error)

    def tell(self, text: str) -> None:
        """Print that a part begins."""
        _tell(text)
        self._newest, self._printed = text, time.monotonic()

    def _beat(self) -> None:
        now = time.monotonic()
        if now - self._printed >= SILENCE and (text := self._now()):
            self._printed = now
            _tell(f"still {text}, {duration(now - self._began)} in all")


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
    """Run as ``python -m tactus.certify``."""
    arguments = arguments_of("certify", __doc__)
    picture = picture_file(arguments.picture) if arguments.picture else None
    scene = ready_scene(arguments.scene)
    if picture:
        check_output(picture, scene.own_files, force=arguments.force, key="PICTURE")
    families = chosen(arguments.netlist) if arguments.netlist else []
    folder = BUILD / scene.name / "certificate"
    stop_if_dry_run(f"export scene {scene.name}, write {folder} and run its {SCRIPT}")
    wanted = CertifyOptions(
        arguments.frames,
        arguments.seed,
        tuple(name for name in families if name != UNKNOWN),
        arguments.recorded,
        arguments.parts,
    )
    with held([BUILD / scene.name]):
        results = certify(scene, wanted)
    if picture:
        draw_page(folder / "certificate.html", picture)
    print(f"wrote {folder / 'certificate.html'}")
    print(processor_line(processor_minutes()))
    return int(any(result.colour == "red" for result in results))


if __name__ == "__main__":
    sys.exit(run(main))
