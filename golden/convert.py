"""``python -m golden.convert SCENE FILE``: the scene's network as .npz, .mat or .onnx."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from golden.cli import run
from golden.network_file import write_network
from golden.scene import load_scene


def main() -> None:
    parser = argparse.ArgumentParser(prog="make network", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("file", type=Path)
    arguments = parser.parse_args()
    scene = load_scene(arguments.scene)
    write_network(arguments.file, scene.mlp())
    print(f"wrote {arguments.file}, {':'.join(str(n) for n in scene.shape)}")


if __name__ == "__main__":
    sys.exit(run(main))
