"""``make image``: writes the memory image of a scene, in three formats."""

import sys

from tactus.core.cli import run, stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.scene import load_scene
from tactus.scene.image import hardware_of, scene_image, write_image


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
        f"{len(data)} bytes, "
        f"check {data[-2:].hex()}"
    )


if __name__ == "__main__":
    sys.exit(run(main))
