"""``make vhdl`` and ``make verilog``: export a scene, or without one the default scenes."""

import argparse
import shlex
from itertools import product
from pathlib import Path

from tactus.core.cli import stop_if_dry_run
from tactus.core.folders import BUILD
from tactus.core.hold import held
from tactus.core.progress import stage
from tactus.export.exporter import ORDER, compile_order, export, is_current, write_stamp
from tactus.export.hierarchy import LANGUAGES
from tactus.scene import DEFAULT_SCENES, Scene, load_scene
from tactus.scene.codes import range_lines, ranges, warn_saturating
from tactus.scene.vectors import warn_outside

# In the place of a language: every one, one after the other.
BOTH = "both"


def main() -> None:
    parser = argparse.ArgumentParser(prog="make vhdl", description=__doc__)
    parser.add_argument("scene", nargs="?", help=f"{' and '.join(DEFAULT_SCENES)} when left out")
    parser.add_argument("language", choices=[*sorted(LANGUAGES), BOTH])
    parser.add_argument("--build", type=Path, default=BUILD)
    arguments = parser.parse_args()
    names = DEFAULT_SCENES if arguments.scene is None else (arguments.scene,)
    scenes = [load_scene(name) for name in names]
    languages = sorted(LANGUAGES) if arguments.language == BOTH else [arguments.language]
    folders = [arguments.build / scene.name / tongue for scene in scenes for tongue in languages]
    with stage(f"building {' and '.join(scene.name for scene in scenes)}", quick=True):
        tops = [scene.twin().entity for scene in scenes]
    stop_if_dry_run(f"export {' and '.join(tops)} into {' and '.join(map(str, folders))}")
    with held(arguments.build / scene.name for scene in scenes):
        for folder, (scene, tongue) in zip(folders, product(scenes, languages), strict=True):
            with stage(f"exporting {scene.name} as {tongue}", quick=True):
                export_scene(scene, tongue, folder)
        for name in names:
            print(f"make prove SCENE={shlex.quote(name)} says whether it is right for every frame")


def export_scene(scene: Scene, language: str, folder: Path) -> None:
    """Export a scene unless its export is current, and print facts about it."""
    warn_outside(scene)
    warn_saturating(scene)
    design = scene.twin()
    if not is_current(scene, folder):
        export(scene, language, folder)
        write_stamp(scene, folder)
    count = len(compile_order(folder))
    print(f"{count} files in {folder}, top {design.entity}, compile order in {folder / ORDER}")
    for fact in design.core.facts():
        print(f"{design.core.entity}: {fact}")
    for line in scene.choice.lines() if scene.choice else []:
        print(f"hardware.design {scene.design}: {line}")
    if scene.front_end:
        print(f"front_end: {scene.front_end.describe()}")
    saturated = scene.twin().core.saturations(scene.vectors().codes)
    for line in [*ranges(scene), *range_lines(scene, saturated)]:
        print(line)
