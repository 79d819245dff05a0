"""The error of an adder graph, split into its causes."""

from collections.abc import Iterator

import numpy as np

from golden.layers.constant_matrix import ConstantMatrix
from golden.networks.adder_graph import AdderGraph
from golden.numbers.fixed import Codes
from golden.numbers.real import Real
from tactus.report.measure.one_network import floating_point, mean_error, random_frames
from tactus.report.measure.table import Cell, Table
from tactus.scene import load_scene

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
