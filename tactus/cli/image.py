"""``make image``: writes the memory image of a scene, in three formats."""

import argparse
import sys
from pathlib import Path

from tactus.core.cli import run, stop_if_dry_run
from tactus.core.folders import BUILD
from tactus.scene import load_scene
from tactus.scene.image import hardware_of, scene_image, write_image


def main() -> None:
    parser = argparse.ArgumentParser(prog="make image", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("--hardware", help="scene whose hardware runs it; by default its own")
    parser.add_argument("--build", type=Path, default=BUILD)
    arguments = parser.parse_args()
    scene = load_scene(arguments.scene)
    hardware = load_scene(arguments.hardware) if arguments.hardware else scene
    image = scene_image(scene, hardware_of(hardware))
    folder = arguments.build / scene.name / "image"
    stop_if_dry_run(f"write {folder}")
    write_image(image, scene.name, folder)
    sizes, data = image.sizes, image.to_bytes()
    print(
        f"wrote {folder}, {len(image.words)} of {sizes.words} {sizes.kind}, "
        f"{image.program.addresses} of {sizes.operand_words} operand words, {len(data)} bytes, "
        f"check {data[-2:].hex()}"
    )


if __name__ == "__main__":
    sys.exit(run(main))
