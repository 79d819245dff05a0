"""``make certify``: write a certificate of a scene's export, and run its script.

``build/<scene>/certificate`` holds the export, what it was made from, and a script that shows that
it computes the network of the scene (docs/certificate.md). The script runs at once, and the page
says what it found. The exit code is that of the script, with 0 for amber.
"""

import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tactus.certify.delivered import (
    LANGUAGES,
    OUTPUT,
    SCRIPT,
    STEPS,
    StepResult,
    check,
    deliver,
    frames_of,
    read_results,
    write_digests,
)
from tactus.certify.page import write_page
from tactus.core.cli import stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.files import replace_folder
from tactus.core.folders import BUILD
from tactus.core.hold import held
from tactus.core.machine import processor_line, processor_minutes
from tactus.core.progress import stage
from tactus.scene import Scene
from tactus.verify.benches.runner import export, ready_scene

# After so many seconds without a line, one says what is running.
SILENCE = 15.0


def certify(
    scene: Scene,
    random: int | None,
    seed: int,
    recorded: int | None = None,
    build: Path = BUILD,
) -> list[StepResult]:
    """Write the certificate of a scene, with frames as in ``frames_of``; return what its script
    found."""
    with (
        stage(f"{scene.name}: exporting"),
        ThreadPoolExecutor() as pool,
    ):
        list(pool.map(lambda language: export(scene, language, build), LANGUAGES))
    # Tools run in folders of their own, so the path is absolute.
    with replace_folder((build / scene.name / "certificate").resolve()) as folder:
        print(f"{scene.name}: writing the certificate", flush=True)
        with stage("  still writing", quick=True, pause=SILENCE):
            frames = frames_of(scene, random, seed, recorded)
            properties = deliver(scene, build, folder, frames)
        digests = write_digests(folder)
        print(f"{scene.name}: running {SCRIPT}", flush=True)
        # The step that runs is the one behind the last result.
        with stage(
            lambda: f"  still step {[*STEPS, STEPS[-1]][len(read_results(folder))]}",
            quick=True,
            pause=SILENCE,
        ):
            check(folder)
        results = read_results(folder)
        write_page(scene, frames, seed, properties, results, digests, folder)
        if all(result.colour != "red" for result in results):
            shutil.rmtree(folder / OUTPUT)
        write_digests(folder)
    return results


def main() -> int:
    arguments = arguments_of("certify", __doc__)
    scene = ready_scene(arguments.scene)
    folder = BUILD / scene.name / "certificate"
    stop_if_dry_run(f"export scene {scene.name}, write {folder} and run its {SCRIPT}")
    with held([BUILD / scene.name]):
        results = certify(scene, arguments.frames, arguments.seed, arguments.recorded)
    print(f"wrote {folder / 'certificate.html'}")
    print(processor_line(processor_minutes()))
    return int(any(result.colour == "red" for result in results))
