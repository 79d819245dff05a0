"""The cells, clocks and errors of one network in every design."""

import numpy as np

from golden.networks.arrangement import process_real
from golden.networks.network import Network
from golden.networks.parallel import Parallel
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from tactus.report.measure.networks import COST, FAMILY, scenes
from tactus.report.measure.table import Row, Table
from tactus.scene import Scene, load_scene
from tactus.synth.budget import is_recorded, read_budget

# The scene whose weights are used.
OF = "digit-single"
RANDOM_FRAMES = 2000


def one_network(seed: int) -> Table:
    """Every scene with the network of ``OF``, or with one of few digits for the same task.

    The design ``parallel`` is added, because no such scene names it.
    """
    source = load_scene(OF)
    alike = [
        scene
        for scene in scenes()
        if scene.weights_paths == source.weights_paths
        or (scene.training.digits and scene.outputs == source.outputs)
    ]
    parallel = Parallel.of(source.mlps(), source.settings())
    designs: list[tuple[str, Scene, Network]] = [(s.name, s, s.twin()) for s in alike]
    designs.append(("", source, parallel))
    recorded = source.vectors().codes
    random = random_frames(seed, recorded.shape[1])
    rows: list[Row] = []
    for name, scene, design in designs:
        known = name and is_recorded(scene.path)
        cells = read_budget(scene.path)[FAMILY].get(design.entity) if known else None
        errors = [
            mean_error(design.process(x), floating_point(scene, x)) for x in (recorded, random)
        ]
        rows.append(
            {
                "scene": name or None,
                "design": design.block,
                "activation": scene.activation_text,
                **{kind: cells[kind] if cells else None for kind in COST},
                "latency clocks": design.output_clocks[-1],
                "interval clocks": design.interval,
                "recorded, 2^-13": errors[0],
                "random, 2^-13": errors[1],
            }
        )
    return Table.of(
        "one_network",
        rows,
        f"The network 4:16:4 of {OF}, with weights of 18 bits, in every design. digit-fast, "
        "digit-fast-clock and digit-fast-ternary have a network with few digits in its weights. "
        "The cells are for Virtex-II, with the hierarchy as exported, as make synth recorded them. "
        "The errors are the mean magnitude of the difference from the same network in floating "
        "point, saturated as the outputs are, in units of 2^-13, over all outputs of the recorded "
        f"frames and of {RANDOM_FRAMES} random ones.",
    )


def random_frames(seed: int, inputs: int) -> Codes:
    """Random frames in which every code is equally likely."""
    shape = (RANDOM_FRAMES, inputs)
    return np.random.default_rng(seed).integers(SIGNAL.low, SIGNAL.high + 1, shape)


def floating_point(scene: Scene, frames: Codes) -> Real:
    """The outputs of a scene's networks in floating point."""
    x = SIGNAL.to_real(frames)
    return process_real(scene.arrangement, scene.mlps(), x, scene.scheme.real)


def mean_error(outputs: Codes, real: Real) -> float:
    """The mean magnitude of the error in units of 2**-13, over frames and outputs.

    outputs, shape (frames, outputs): The output codes.
    real, the same shape: The results in floating point. Beyond the range of codes, its end counts
        as right.
    """
    reached = np.clip(real, SIGNAL.to_real(SIGNAL.low), SIGNAL.to_real(SIGNAL.high))
    return float(np.abs(SIGNAL.to_real(outputs) - reached).mean() * (1 << SIGNAL.frac))
