"""What tables of straight lines cost a network of learned functions in error, and in words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from golden.precision import SIGNAL
from golden.real import Real
from golden.scene import load_scene
from golden.splines.basis import Basis
from golden.splines.edges import CURVED, FLAT, STRAIGHT
from golden.splines.tables import TableNetwork, tabulated
from golden.splines.training import Learned
from golden.training.objective import Rows
from tb.report.measure.learned_functions import (
    CANDIDATES,
    SCENE,
    Networks,
    learned,
    lesson,
    trained,
)
from tb.report.measure.table import Cell, Table

KIND_NAMES = {FLAT: "flat", STRAIGHT: "straight", CURVED: "curved"}
ARRANGEMENT, NODES = "cascade", 3
SEGMENTS = (4, 8, 16, 32, 64, 128)

NOTES = {
    "function_tables": f"The figures are mean errors in percent of the {ARRANGEMENT} of learned "
    f"functions with {NODES} nodes, pruned, on the split of scene {SCENE}: on the held-out rows, "
    "and on all rows of the networks that were trained on with all. Each curved function is a "
    "table of straight lines, segments by the upper bits of a word; an intercept and a slope of 18 "
    "bits are a word of 36. Inputs and outputs have 14 bits, hidden sums 18, sums are exact and "
    "are rounded once. 'Float' is the same network with its splines.",
    "learned_curves": "The functions of the same cascade, trained on with all rows, each at "
    "equal steps over the range that it has on these rows, from which its mean is subtracted; and "
    "the part of the rows in each of equal steps. A straight function is a product on an engine, "
    "and a flat one is nothing.",
}
# The points of a curve, and the steps over which rows are counted.
POINTS, BINS = 25, 24


def function_tables(seed: int) -> Table:
    """The errors of one network with more and more segments."""
    given = lesson(seed)
    kind = learned(NODES, pruned=True)
    networks = trained(ARRANGEMENT, kind, seed, CANDIDATES[ARRANGEMENT], given)
    held_out, outputs = given.measured["held out"], load_scene(SCENE).outputs
    vectors = load_scene(SCENE).vectors()
    every = Rows(SIGNAL.to_real(vectors.codes), vectors.targets, vectors.scale)
    rows: list[list[Cell]] = []
    found = [networks.means(networks.tested, held_out), networks.means(networks.written, every)]
    rows += _rows("float", 0, outputs, found)
    for segments in SEGMENTS:
        found, words = [], 0
        for models, part in ((networks.tested, held_out), (networks.written, every)):
            miss, words = _bit_true(networks, models, part, given.parts["every"], segments)
            found.append(miss)
        rows += _rows(str(segments), words, outputs, found)
    return Table(
        "function_tables",
        ["segments", "words", "output", "held out %", "all rows %"],
        rows,
        NOTES["function_tables"],
    )


def learned_curves(seed: int) -> Table:
    """Every function of the cascade, and where the rows lie."""
    given = lesson(seed)
    kind = learned(NODES, pruned=True)
    networks = trained(ARRANGEMENT, kind, seed, CANDIDATES[ARRANGEMENT], given)
    scene = load_scene(SCENE)
    vectors = scene.vectors()
    every = Rows(SIGNAL.to_real(vectors.codes), vectors.targets, vectors.scale)
    rows: list[list[Cell]] = []
    for number, (output, model) in enumerate(zip(scene.outputs, networks.written, strict=True)):
        assert isinstance(model, Learned)
        inputs = networks.rows(networks.written[:number], every, ()).inputs
        names = [*scene.sensors, *scene.outputs[:number]]
        network, edges = model.network, model.edges
        sums = network.sums(network.spread(inputs))
        for h in range(NODES):
            for i, name in enumerate(names):
                form = KIND_NAMES[int(edges.first[h, i])]
                curve = _curve(network.bases[i], network.first[h, i], inputs[:, i])
                rows.append([output, h + 1, name, form, *curve])
            form = KIND_NAMES[int(edges.second[0, h])]
            curve = _curve(network.hidden, network.second[0, h], sums[:, h])
            rows.append([output, h + 1, "sum", form, *curve])
    columns = [
        *("network", "node", "of", "form", "low", "high"),
        *(f"value {n + 1}" for n in range(POINTS)),
        *(f"rows {n + 1}" for n in range(BINS)),
    ]
    return Table("learned_curves", columns, rows, NOTES["learned_curves"])


def _curve(basis: Basis, coefficients: Real, x: Real) -> list[Cell]:
    """The range of x, the values of a function over it, and the part of x in each step of it."""
    low, high = float(x.min()), float(x.max())
    values = basis.at(np.linspace(low, high, POINTS))[0] @ coefficients
    mean = float((basis.at(x)[0] @ coefficients).mean())
    counts = np.histogram(x, BINS, (low, high))[0] / len(x)
    return [low, high, *map(float, values - mean), *map(float, counts)]


def _rows(name: str, words: int, outputs: Sequence[str], found: Sequence[Real]) -> list[list[Cell]]:
    return [
        [name, words, output, *(float(means[c]) for means in found)]
        for c, output in enumerate(outputs)
    ]


def _bit_true(
    networks: Networks, models: Sequence[object], part: Rows, known: Rows, segments: int
) -> tuple[Real, int]:
    """The mean errors of a cascade in integers, and the words of all its tables."""
    codes = SIGNAL.quantise(part.inputs)[0]
    samples = codes.shape[1]
    words = 0
    for number, model in enumerate(models):
        assert isinstance(model, Learned)
        seen = networks.rows(networks.written[:number], known, ()).inputs
        table: TableNetwork = tabulated(model, seen, segments)
        codes = np.concatenate([codes, table.process(codes)], axis=1)
        words += table.words
    results = SIGNAL.to_real(codes[:, samples:])
    return np.abs(100 * (results - part.targets) / part.scale).mean(axis=0), words
