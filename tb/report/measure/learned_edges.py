"""The functions that a network of learned functions adds up, and where the rows of data lie.

Such a network is held as three layers (``golden.function_network``). Here its edges are found in
these layers again, for networks that were trained and for those that a file brings.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from golden.dense import Dense, DenseNetwork, Trained
from golden.function import ITSELF
from golden.precision import SIGNAL
from golden.real import Real
from golden.scene import Scene
from tb.report.measure.table import Cell, Table

# The points of a curve, and the steps over which rows are counted.
POINTS, BINS = 25, 24
COLUMNS = [
    *("network", "node", "side", "of", "form", "low", "high"),
    *(f"value {n + 1}" for n in range(POINTS)),
    *(f"rows {n + 1}" for n in range(BINS)),
]
# The column of the first value, and what the column "side" tells: a function of an input of the
# node, or one of its sum.
VALUES = COLUMNS.index("value 1")
INPUT, SUM = "input", "sum"


@dataclass(frozen=True)
class Edge:
    """A function of one variable.

    Attributes
    ----------
    form : str
        "curved", "straight" or "flat".
    at : callable
        Gives the values at an array of places.
    """

    form: str
    at: Callable[[Real], Real]


def is_sum_of_functions(network: Trained) -> bool:
    """Whether a network's layers are those of a network of learned functions."""
    if not isinstance(network, DenseNetwork) or len(network.layers) != 3:
        return False
    copies, sums, _ = network.layers
    alone = (copies.weights != 0).sum(axis=1) <= 1
    return bool(copies.functions and sums.functions and alone.all())


def edges_table(
    name: str,
    networks: Sequence[tuple[Sequence[str], Sequence[str], DenseNetwork, Real]],
    note: str,
) -> Table:
    """A row for each edge of each network.

    Parameters
    ----------
    name : str
        Of the table.
    networks : sequence of tuples
        For each network the names of its outputs, the names of its inputs, the network, and the
        rows of its inputs, shape (rows, inputs).
    note : str
        Of the table.
    """
    rows: list[list[Cell]] = []
    for outputs, names, network, inputs in networks:
        for node, found in enumerate(nodes_of(network, inputs), 1):
            for side, place, edge, x in found:
                of = names[place] if side == INPUT else outputs[place]
                cells: list[Cell] = [", ".join(outputs), node, side, of, edge.form]
                rows.append([*cells, *curve(edge.at, x)])
    return Table(name, COLUMNS, rows, note)


def nodes_of(network: DenseNetwork, inputs: Real) -> Iterator[list[tuple[str, int, Edge, Real]]]:
    """For each hidden sum its edges: the side, the number of the input or output, and the rows."""
    copies, sums, last = network.layers
    hidden = copies.activate(inputs @ copies.weights.T + copies.biases)[0]
    rows = [(tuple(row), bias) for row, bias in zip(sums.weights, sums.biases, strict=True)]
    for one in dict.fromkeys(rows):
        weights, bias = one
        own = [n for n, row in enumerate(rows) if row == one]
        s = hidden @ np.array(weights) + bias
        inner = [
            (INPUT, i, _inner(copies, np.array(weights), i), x) for i, x in enumerate(inputs.T)
        ]
        outer = [(SUM, o, _outer(sums, last.weights[o], own), s) for o in range(last.nodes)]
        yield inner + outer


def _inner(copies: Dense, weights: Real, source: int) -> Edge:
    """The part of a hidden sum that depends on one input."""
    nodes = [n for n in np.flatnonzero(weights) if copies.weights[n, source]]

    def at(x: Real) -> Real:
        total = np.zeros_like(x)
        for n in nodes:
            q = copies.weights[n, source] * x + copies.biases[n]
            total += weights[n] * copies.functions[n].value(q)
        return total

    return Edge(_form([copies.functions[n] for n in nodes]), at)


def _outer(sums: Dense, weights: Real, own: Sequence[int]) -> Edge:
    """The part of an output that depends on one hidden sum."""
    nodes = [n for n in own if weights[n]]

    def at(s: Real) -> Real:
        total = np.zeros_like(s)
        for n in nodes:
            total += weights[n] * sums.functions[n].value(s)
        return total

    return Edge(_form([sums.functions[n] for n in nodes]), at)


def _form(functions: Sequence[object]) -> str:
    if not functions:
        return "flat"
    return "straight" if all(function == ITSELF for function in functions) else "curved"


def curve(at: Callable[[Real], Real], x: Real) -> list[Cell]:
    """The range of x, the values of a function over it, and the part of x in each step of it.

    The mean of the values at x is subtracted.
    """
    low, high = float(x.min()), float(x.max())
    values = at(np.linspace(low, high, POINTS)) - float(at(x).mean())
    counts = np.histogram(x, BINS, (low, high))[0] / len(x)
    return [low, high, *map(float, values), *map(float, counts)]


def scene_edges(scene: Scene) -> Table | None:
    """The edges of a scene's networks over its recorded rows; None for other networks."""
    networks = scene.networks()
    if not all(map(is_sum_of_functions, networks)):
        return None
    found: list[tuple[Sequence[str], Sequence[str], DenseNetwork, Real]] = []
    inputs = SIGNAL.to_real(scene.vectors().codes)
    names = [
        scene.sensors[tap.sensor] + (f", {tap.delay} ago" if tap.delay else "")
        for tap in scene.window.taps
    ]
    cascade = scene.arrangement == "cascade"
    single = scene.arrangement == "single"
    for n, network in enumerate(networks):
        assert isinstance(network, DenseNetwork)
        outputs = list(scene.outputs) if single else [scene.outputs[n]]
        found.append((outputs, names, network, inputs))
        if cascade:
            names = [*names, scene.outputs[n]]
            inputs = np.concatenate([inputs, network.process(inputs)], axis=1)
    return edges_table(f"edges-{scene.name}", found, "")
