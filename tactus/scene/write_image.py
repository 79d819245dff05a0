"""Writes the memory image of a scene as files, in three formats."""

from pathlib import Path

from golden.engine.image import Image
from golden.engine.program import WORD_WIDTH
from golden.input_error import InputError
from golden.networks.engine import Engine
from tactus.core.files import replace_folder
from tactus.scene import Scene

_DIGITS = WORD_WIDTH // 4


def hex_text(image: Image) -> str:
    """The whole memory, one word per line, as ``$readmemh`` reads it."""
    return "".join(f"{word:0{_DIGITS}x}\n" for word in image.contents)


def mem_text(image: Image, name: str) -> str:
    """Address, word and meaning of every word, up to the last word that is used."""
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
    """The reloadable engine of a scene."""
    if scene.design_options.get("reload"):
        core = scene.twin().core
        assert isinstance(core, Engine), "only an engine has the option reload"
        return core
    raise InputError(
        f"{scene.path}: hardware.reload: got false, expected true, or HARDWARE= with a "
        "scene whose engine can be reloaded"
    )
