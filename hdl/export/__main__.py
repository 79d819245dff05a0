"""``python -m hdl.export SCENE LANGUAGE``: a scene as VHDL or Verilog, one file an entity.

The same scene gives the same bytes on every run (``hdl.export.repeatable``).
"""

from __future__ import annotations

import argparse
import platform
from pathlib import Path

import myhdl

from golden.files import writing
from golden.fingerprint import fingerprint, sources
from golden.scene import load_scene
from golden.scene.ranges import ranges
from golden.scene.vectors import warn_outside
from hdl.export.exporter import ORDER, export
from hdl.export.hierarchy import LANGUAGES
from hdl.export.repeatable import run_repeatable


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m hdl.export", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("language", choices=sorted(LANGUAGES))
    parser.add_argument("--build", type=Path, default=Path("build"))
    arguments = parser.parse_args()
    scene = load_scene(arguments.scene)
    warn_outside(scene)
    design = scene.twin()
    top = design.entity
    folder = arguments.build / scene.name / arguments.language
    stamp = folder.parent / f".{arguments.language}.stamp"
    inputs = [*sources("golden", "hdl"), *scene.files]
    versions = (myhdl.__version__, platform.python_version())
    if not _is_current(stamp, folder, inputs, versions):
        export(scene, arguments.language, folder)
        with writing(stamp):
            stamp.write_text(_state(folder, inputs, versions), encoding="utf-8")
    count = len((folder / ORDER).read_text().split())
    print(f"{count} files in {folder}, top {top}, compile order in {folder / ORDER}")
    for fact in design.core.facts():
        print(f"{design.core.entity}: {fact}")
    if scene.front_end:
        print(f"front_end: {scene.front_end.describe()}")
    for line in ranges(scene):
        print(line)


def _state(folder: Path, inputs: list[Path], versions: tuple[str, ...]) -> str:
    """What went in and what came out: a change of either asks for a new export."""
    return fingerprint([*inputs, folder], *versions)


def _is_current(stamp: Path, folder: Path, inputs: list[Path], versions: tuple[str, ...]) -> bool:
    return (
        stamp.is_file()
        and folder.is_dir()
        and stamp.read_text(encoding="utf-8", errors="replace") == _state(folder, inputs, versions)
    )


if __name__ == "__main__":
    run_repeatable("hdl.export", main)
