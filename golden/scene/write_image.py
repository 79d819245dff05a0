"""``python -m golden.scene.write_image``: the memory image of a scene, in three forms."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from golden.cli import run, would
from golden.engine.image import Image
from golden.engine.program import WORD_WIDTH
from golden.files import replace_folder
from golden.folders import BUILD
from golden.input_error import InputError
from golden.networks.engine import Engine
from golden.scene import Scene, load_scene
from golden.scene.image import scene_image

_DIGITS = WORD_WIDTH // 4


def hex_text(image: Image) -> str:
    """A word a line, the whole memory: what ``$readmemh`` reads."""
    return "".join(f"{word:0{_DIGITS}x}\n" for word in image.contents)


def mem_text(image: Image, name: str) -> str:
    """Address, word and what the word stands for, up to the last word that is used."""
    lines = [
        f"@{address:03x} {word:0{_DIGITS}x} // {note}".removesuffix(" // ")
        for address, (word, note) in enumerate(zip(image.words, image.notes, strict=True))
    ]
    heading = f"// Image of scene {name}, {image.inputs} samples a frame, for {image.sizes.text()}."
    return "\n".join([heading, *lines]) + "\n"


def write_image(image: Image, name: str, folder: Path) -> None:
    """Write ``<name>.hex``, ``.mem`` and ``.bin`` into ``folder``, replacing it as a whole."""
    with replace_folder(folder) as temporary:
        (temporary / f"{name}.hex").write_text(hex_text(image), encoding="utf-8")
        (temporary / f"{name}.mem").write_text(mem_text(image, name), encoding="utf-8")
        (temporary / f"{name}.bin").write_bytes(image.to_bytes())


def hardware_of(scene: Scene) -> Engine:
    """The engine of a scene that can be reloaded.

    Raises
    ------
    InputError
        For a scene of other hardware.
    """
    if scene.design_options.get("reload"):
        core = scene.twin().core
        assert isinstance(core, Engine), "only an engine has the option reload"
        return core
    raise InputError(
        f"{scene.path}: hardware.reload: got false, expected true, or HARDWARE= a scene where it is"
    )


def main() -> None:
    parser = argparse.ArgumentParser(prog="make image", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("--hardware", help="scene whose hardware it is for; otherwise its own")
    parser.add_argument("--build", type=Path, default=BUILD)
    arguments = parser.parse_args()
    scene = load_scene(arguments.scene)
    hardware = load_scene(arguments.hardware) if arguments.hardware else scene
    image = scene_image(scene, hardware_of(hardware))
    folder = arguments.build / scene.name / "image"
    would(f"write {folder}")
    write_image(image, scene.name, folder)
    sizes, data = image.sizes, image.to_bytes()
    print(
        f"wrote {folder}, {len(image.words)} of {sizes.program_words} program words, "
        f"{image.program.addresses} of {sizes.operand_words} operand words, {len(data)} bytes, "
        f"check {data[-2:].hex()}"
    )


if __name__ == "__main__":
    sys.exit(run(main))
