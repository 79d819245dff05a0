"""``make image``: the image of a scene, for its own hardware or for that of another one."""

from pathlib import Path

from golden.engine.formats import WORD_WIDTH
from golden.engine.image import Image
from golden.input_error import InputError
from golden.networks.engine import Engine
from tactus.core.cli import stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.files import replace_folder
from tactus.scene import load_scene
from tactus.scene.scene import Scene


def scene_image(scene: Scene, hardware: Engine) -> Image:
    """The image with which ``hardware`` runs a scene.

    scene: It may have any design, but must use no past samples; only its networks enter the image.
    hardware: An engine that can be reloaded.
    """
    if hardware.loaded is None:
        raise InputError(f"{hardware.entity}: hardware.reload: got false, expected true")
    if not scene.window.plain:
        raise InputError(
            f"{scene.path}: data.window: got past samples, expected none: an image has no memory "
            "for past samples"
        )
    for key, got, known in (
        ("precision", scene.precision.name, Engine.precisions),
        ("activation", scene.activation, Engine.known_activations),
    ):
        if got not in known:
            raise InputError(
                f"{scene.path}: hardware.{key}: got {got!r}, expected {' or '.join(known)} for an "
                "image"
            )
    try:
        return hardware.image_for(scene.networks(), scene.arrangement, scene.settings().met)
    except InputError as error:
        raise InputError(f"{scene.path}: {error}") from None


_DIGITS = WORD_WIDTH // 4


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
        # The whole memory, one word per line, as $readmemh reads it.
        contents = "".join(f"{word:0{_DIGITS}x}\n" for word in image.contents)
        (temporary / f"{name}.hex").write_text(contents, encoding="utf-8")
        (temporary / f"{name}.mem").write_text(mem_text(image, name), encoding="utf-8")
        (temporary / f"{name}.bin").write_bytes(image.to_bytes())


def hardware_of(scene: Scene) -> Engine:
    if scene.design_options.get("reload"):
        core = scene.twin().core
        assert isinstance(core, Engine), "only an engine has the option reload"
        return core
    raise InputError(
        f"{scene.path}: hardware.reload: got false, expected true, or HARDWARE= with a "
        "scene whose engine can be reloaded"
    )


def main() -> None:
    arguments = arguments_of("image", __doc__)
    scene = load_scene(arguments.scene)
    hardware = load_scene(arguments.hardware) if arguments.hardware else scene
    image = scene_image(scene, hardware_of(hardware))
    folder = arguments.build / scene.name / "image"
    stop_if_dry_run(f"write {folder}")
    write_image(image, scene.name, folder)
    sizes, data = image.sizes, image.to_bytes()
    print(
        f"wrote {folder}, {len(image.words)} of {sizes.words} words of tables, weights and "
        f"program, {image.program.addresses} of {sizes.operand_words} operand words, "
        f"{len(data)} bytes, check {data[-2:].hex()}"
    )
