"""``make designs``: prints what each design of a scene's networks costs, without synthesis."""

import sys
import textwrap

from golden.input_error import InputError, suggest
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.files import check_output, replace_file
from tactus.report.draw.designs import is_drawn, picture_of
from tactus.report.measure.designs import FAMILIES, designs, refused_lines
from tactus.scene import load_scene
from tactus.scene.building import compared


def family_of(name: str) -> str:
    """A name of ``FAMILIES``; none is the first."""
    if not name:
        return next(iter(FAMILIES))
    if name not in FAMILIES:
        raise InputError(
            f"FAMILY={name}: no such family, expected one of {', '.join(FAMILIES)}"
            f"{suggest(name, list(FAMILIES))}"
        )
    return name


def main() -> None:
    arguments = arguments_of("designs", __doc__)
    family = family_of(arguments.family)
    scene = load_scene(arguments.scene)
    path = arguments.picture
    if path:
        if path.suffix != ".svg":
            raise InputError(f"PICTURE={path}: expected a name that ends in .svg")
        check_output(path, scene.own_files, own=is_drawn, force=arguments.force, key="PICTURE")
    stop_if_dry_run(
        f"compare the designs of scene {scene.name}" + (f" and write {path}" if path else "")
    )
    rows, refused = compared(scene)
    print("\n".join(designs(scene, rows, family).lines()))
    if refused:
        print()
        for line in refused_lines(refused):
            print(textwrap.fill(line, 100, subsequent_indent="  "))
    if path:
        with replace_file(path) as temporary:
            temporary.write_text(picture_of(scene, rows, family), encoding="utf-8")
        print(f"wrote {path}")


if __name__ == "__main__":
    sys.exit(run(main))
