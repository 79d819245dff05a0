"""``python -m golden.engine SCENE``: the program of a scene's engine, a line for every step."""

from __future__ import annotations

import argparse
import sys

from golden.block import walk
from golden.cli import CommandError, run, would
from golden.engine.listing import listing
from golden.networks.engine import Engine
from golden.scene import load_scene


def main() -> None:
    parser = argparse.ArgumentParser(prog="make listing", description=__doc__)
    parser.add_argument("scene")
    scene = load_scene(parser.parse_args().scene)
    engines = [block for block in walk(scene.twin()) if isinstance(block, Engine)]
    if not engines:
        raise CommandError(
            f"{scene.path}: hardware.design: got {scene.design}, which has no program, expected "
            f"{Engine.block}"
        )
    (engine,) = engines
    would(f"print the program of {engine.entity}")
    print("\n".join(listing(engine.graph, engine.program)))


if __name__ == "__main__":
    sys.exit(run(main))
