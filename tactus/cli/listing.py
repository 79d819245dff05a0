"""``make listing``: prints the program of a scene's engine, with a line for every step.

For a network without a program, whose products are made by adders, it prints every adder.
"""

import sys

from golden.common.block import walk
from golden.engine.lane_listing import lane_listing
from golden.input_error import InputError
from golden.layers.constant_matrix import ConstantMatrix
from golden.layers.listing import listing as adders
from golden.learning.listing import lesson_listing
from golden.networks.adder_graph import AdderGraph
from golden.networks.engine import Engine
from golden.networks.learning_engine import LearningEngine
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.scene import load_scene


def main() -> None:
    scene = load_scene(arguments_of("listing", __doc__).scene)
    blocks = list(walk(scene.twin()))
    matrices = [block for block in blocks if isinstance(block, ConstantMatrix)]
    if matrices:
        stop_if_dry_run(f"print the adders of {len(matrices)} matrices")
        print("\n\n".join("\n".join(adders(matrix)) for matrix in matrices))
        return
    lessons = [block for block in blocks if isinstance(block, LearningEngine)]
    if lessons:
        stop_if_dry_run(f"print the program of {lessons[0].entity}")
        print("\n".join(lesson_listing(lessons[0].program)))
        return
    engines = [block for block in blocks if isinstance(block, Engine)]
    if not engines:
        raise InputError(
            f"{scene.path}: hardware.design: got {scene.design}, which has no program, expected "
            f"{Engine.block} or {AdderGraph.block}"
        )
    (engine,) = engines
    stop_if_dry_run(f"print the program of {engine.entity}")
    print("\n".join(lane_listing(engine.graph, engine.program)))


if __name__ == "__main__":
    sys.exit(run(main))
