"""The cells, clocks and errors of one network in every design, and what causes the errors."""

from collections.abc import Iterator

import numpy as np

from golden.layers.constant_matrix import ConstantMatrix
from golden.networks.adder_graph import AdderGraph
from golden.networks.arrangement import process_real
from golden.networks.network import Network
from golden.networks.parallel import Parallel
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from tactus.report.measure.costs import COST, FAMILY
from tactus.report.measure.networks import scenes
from tactus.report.measure.table import Cell, Table
from tactus.scene import Scene, load_scene
from tactus.synth.budget import read_budget
from tactus.synth.recorded import is_recorded

SCENES = ("digit-fast", "comparison/digit-fast-full")


def adder_errors(seed: int) -> Table:
    """The mean error of each scene on recorded and on random frames, with more and more causes."""
    rows: list[list[Cell]] = []
    for name in SCENES:
        scene = load_scene(name)
        design = scene.twin()
        assert isinstance(design, AdderGraph)
        recorded = scene.vectors().codes
        both = recorded, random_frames(seed, recorded.shape[1])
        real = [floating_point(scene, frames) for frames in both]
        for (cause, first), (_, second) in zip(*(stages(design, x) for x in both), strict=True):
            errors = map(mean_error, (first, second), real)
            rows.append([scene.name, cause, *errors])
    return Table(
        "adder_errors",
        ["scene", "cause", "recorded, 2^-13", "random, 2^-13"],
        rows,
        "The causes of error are added one after the other to the network in floating point. The "
        "figures are the mean magnitude of the difference, as in one_network.",
    )


def stages(design: AdderGraph, frames: Codes) -> Iterator[tuple[str, Real | Codes]]:
    """The outputs of a network of one hidden layer, each time with one cause of error more."""
    (first, second), (activations,) = design.layers, design.activations
    q = exact_sums(first, frames)

    def outputs(r: Real | Codes) -> Codes:
        # The constants contain half a step of the output.
        return np.clip(np.floor(exact_sums(second, r)), second.out_fmt.low, second.out_fmt.high)

    def tanh(codes: Real) -> Real:
        # The half step that the constants contain is removed.
        scale = 1 << second.in_fmt.frac
        return np.asarray(scale * np.tanh(codes / (1 << first.out_fmt.frac)) - 0.5)

    def tables(codes: Codes) -> Codes:
        columns = [a.process(codes[:, j]) for j, a in enumerate(activations)]
        return np.stack(columns, axis=-1)

    floored = np.floor(q).astype(np.int64)
    middles = np.asarray(floored + 0.5, dtype=np.float64)
    yield "weights, outputs rounded", outputs(tanh(q))
    yield "q in steps", outputs(tanh(middles))
    yield "tanh from tables", outputs(tables(floored))
    yield "bits cut in layer 1", outputs(tables(first.process(frames)))
    yield "bits cut in layer 2", design.process(frames)


def exact_sums(matrix: ConstantMatrix, values: Real | Codes) -> Real:
    """The exact sums of a matrix, in units of its results."""
    sums = values @ np.array(matrix.weights).T + np.array(matrix.biases)
    return np.asarray(sums / (1 << matrix.out_shift))


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
    rows: list[list[Cell]] = []
    for name, scene, design in designs:
        known = name and is_recorded(scene.path)
        cells = read_budget(scene.path)[FAMILY].get(design.entity) if known else None
        rows.append(
            [
                name or None,
                design.block,
                scene.activation_text,
                *(cells[kind] if cells else None for kind in COST),
                design.output_clocks[-1],
                design.interval,
                *(
                    mean_error(design.process(x), floating_point(scene, x))
                    for x in (recorded, random)
                ),
            ]
        )
    return Table(
        "one_network",
        [
            "scene",
            "design",
            "activation",
            *COST,
            "latency clocks",
            "interval clocks",
            "recorded, 2^-13",
            "random, 2^-13",
        ],
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
