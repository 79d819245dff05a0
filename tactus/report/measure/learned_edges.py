"""The functions that a network of learned functions adds up, and where the rows of data lie.

An edge is a function of one variable; see ``golden.networks.function_sums``.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from golden.networks.function_sums import Curve, function_sums, learned
from golden.numbers.real import Real
from golden.trained.dense import Trained
from golden.trained.function import ITSELF
from tactus.report.measure.table import Cell, Table
from tactus.scene import Scene

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

Edge = Curve | None


def edges_table(
    name: str,
    networks: Sequence[tuple[Sequence[str], Sequence[str], Trained, Real]],
    note: str,
) -> Table:
    """A row for each edge of each network.

    name: Of the table.
    networks: For each network the names of its outputs, the names of its inputs, the network, and
        the rows of its inputs, shape (rows, inputs).
    note: Of the table.
    """
    rows: list[list[Cell]] = []
    for outputs, names, network, inputs in networks:
        for node, found in enumerate(nodes_of(network, inputs), 1):
            for side, place, edge, x in found:
                of = names[place] if side == INPUT else outputs[place]
                cells: list[Cell] = [", ".join(outputs), node, side, of, form_of(edge)]
                rows.append([*cells, *curve(edge, x)])
    return Table(name, COLUMNS, rows, note)


def nodes_of(network: Trained, inputs: Real) -> Iterator[list[tuple[str, int, Edge, Real]]]:
    """For each hidden sum its edges: the side, the number of the input or output, and the rows.

    An edge that is left out has no curve.
    """
    found = function_sums(network, (), "")
    for h, node in enumerate(found.hidden):
        curves = [node.curves.get(i) for i in range(inputs.shape[1])]
        s = np.full(len(inputs), node.constant)
        for x, one in zip(inputs.T, curves, strict=True):
            s += one.at(x) if one else 0.0
        inner = [
            (INPUT, i, one, x) for i, (one, x) in enumerate(zip(curves, inputs.T, strict=True))
        ]
        outer = [(SUM, o, output.curves.get(h), s) for o, output in enumerate(found.outputs)]
        yield inner + outer


def form_of(edge: Edge) -> str:
    """Whether it is "curved", "straight" or "flat"."""
    if edge is None:
        return "flat"
    return "straight" if all(function == ITSELF for function in edge.functions) else "curved"


def curve(edge: Edge, x: Real) -> list[Cell]:
    """The range of x, the values of a function over it, and the part of x in each step of it.

    The mean of the values at x is subtracted.
    """
    low, high = float(x.min()), float(x.max())
    places = np.linspace(low, high, POINTS)
    values = edge.at(places) - float(edge.at(x).mean()) if edge else np.zeros(POINTS)
    counts = np.histogram(x, BINS, (low, high))[0] / len(x)
    return [low, high, *map(float, values), *map(float, counts)]


def scene_edges(scene: Scene) -> Table | None:
    """The edges of a scene's networks over its recorded rows; None for other networks."""
    networks = scene.networks()
    if not all(map(learned, networks)):
        return None
    single = scene.arrangement == "single"
    found = []
    for n, network in enumerate(networks):
        outputs = list(scene.outputs) if single else [scene.outputs[n]]
        inputs = scene.inputs_of(network)
        names = [*scene.inputs, *scene.outputs][: inputs.shape[1]]
        found.append((outputs, names, network, inputs))
    return edges_table(f"edges-{scene.name}", found, "")
