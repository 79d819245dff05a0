"""``make network``: writes a network of a scene as .npz, .mat or .onnx."""

import argparse
import sys
from pathlib import Path

from golden.input_error import InputError, suggest
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.files import check_output
from tactus.network_files.network_file import check_target, write_network
from tactus.scene import Scene, SceneNetwork, load_scene


def member_of(scene: Scene, output: str | None) -> SceneNetwork:
    """The network that computes ``output``, which may be None if the scene has one network."""
    if output is None and len(scene.members) == 1:
        return scene.members[0]
    for member in scene.members:
        if output in member.outputs:
            return member
    raise InputError(
        f"OUTPUT={output or ''}: scene {scene.name} has {len(scene.members)} networks, expected "
        f"one of {', '.join(scene.outputs)}{suggest(output or '', scene.outputs)}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(prog="make network", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("file", type=Path)
    parser.add_argument("--output", help="an output of the network, if the scene has several")
    parser.add_argument("--force", action="store_true", help="replace a file that is there")
    arguments = parser.parse_args()
    scene = load_scene(arguments.scene)
    network = member_of(scene, arguments.output).load()
    check_target(arguments.file)
    check_output(arguments.file, scene.own_files, force=arguments.force)
    stop_if_dry_run(f"write {arguments.file}")
    write_network(arguments.file, network)
    print(f"wrote {arguments.file}, {':'.join(str(n) for n in network.shape)}")


if __name__ == "__main__":
    sys.exit(run(main))
