"""What tables of straight lines cost a network of learned functions in error, and in words."""

from collections.abc import Sequence

import numpy as np

from golden.dense import DenseNetwork
from golden.networks.arrangement import arrange
from golden.networks.engine import Engine
from golden.networks.settings import Settings
from golden.precision import SIGNAL
from golden.real import Real
from golden.scene import load_scene
from golden.spline_layers import function_network
from golden.splines.training import Learned
from golden.training.objective import Rows
from tb.report.measure.learned_edges import BINS, POINTS, edges_table
from tb.report.measure.learned_functions import (
    CANDIDATES,
    SCENE,
    Kind,
    Model,
    Networks,
    learned,
    lesson,
    trained,
)
from tb.report.measure.table import Cell, Table

ARRANGEMENT, NODES = "cascade", 3
# The networks that are put into tables; the curves are those of the first one.
KINDS = (
    learned(NODES, pruned=True),
    learned(NODES, straight=True),
    learned(NODES, pruned=True, straight=True),
)
# Bits of a word within a segment of a table.
WIDTHS = (13, 12, 11, 10)

NOTES = {
    "function_tables": f"The figures are mean errors in percent of three networks in {ARRANGEMENT} "
    f"with {NODES} nodes on the split of scene {SCENE}: on the held-out rows, and on all rows of "
    "the networks that were trained on with all. Each curved function is a table of straight lines "
    "in an engine, whose results these are, bit-true. The segment width is the number of bits of a "
    "word within a segment, words are those of all tables, and clocks are those from the last "
    "sample to the last output. 'Float' is the same network with its splines.",
    "learned_curves": "The functions of the pruned cascade of function_tables, trained on with all "
    f"rows, each at {POINTS} equal steps over the range that it has on these rows, from which its "
    f"mean is subtracted; and the part of the rows in each of {BINS} equal steps. A straight "
    "function is a product on an engine, and a flat one is nothing.",
}


def function_tables(seed: int) -> Table:
    """The errors of networks with narrower and narrower segments."""
    given = lesson(seed)
    held_out, outputs, every = given.measured["held out"], load_scene(SCENE).outputs, _every()
    rows: list[list[Cell]] = []
    for kind in KINDS:
        networks = _trained(kind, seed)
        found = [networks.means(networks.tested, held_out), networks.means(networks.written, every)]
        rows += _rows([kind.name, "float", None, None], outputs, found)
        tested = _layers(networks, networks.tested, given.parts["known"])
        written = _layers(networks, networks.written, given.parts["every"])
        for width in WIDTHS:
            found = [_means(_engine(tested, width), held_out)]
            engine = _engine(written, width)
            found.append(_means(engine, every))
            size = len(engine.program.slopes), engine.output_clocks[-1]
            rows += _rows([kind.name, str(width), *size], outputs, found)
    return Table(
        "function_tables",
        ["network", "segment width", "words", "clocks", "output", "held out %", "all rows %"],
        rows,
        NOTES["function_tables"],
    )


def learned_curves(seed: int) -> Table:
    """Every function of the pruned cascade, and where the rows lie."""
    networks, scene = _trained(KINDS[0], seed), load_scene(SCENE)
    layers = _layers(networks, networks.written, lesson(seed).parts["every"])
    found: list[tuple[Sequence[str], Sequence[str], DenseNetwork, Real]] = []
    for number, (output, network) in enumerate(zip(scene.outputs, layers, strict=True)):
        inputs = networks.rows(networks.written[:number], _every(), ()).inputs
        names = [*scene.sensors, *scene.outputs[:number]]
        found.append(([output], names, network, inputs))
    return edges_table("learned_curves", found, NOTES["learned_curves"])


def _trained(kind: Kind, seed: int) -> Networks:
    return trained(ARRANGEMENT, kind, seed, CANDIDATES[ARRANGEMENT], lesson(seed))


def _every() -> Rows:
    """All rows of the scene as recorded."""
    vectors = load_scene(SCENE).vectors()
    return Rows(SIGNAL.to_real(vectors.codes), vectors.targets, vectors.scale)


def _layers(networks: Networks, models: Sequence[Model], known: Rows) -> list[DenseNetwork]:
    """The networks of a cascade as layers, for the rows that they were trained on with."""
    found = []
    for number, model in enumerate(models):
        assert isinstance(model, Learned)
        inputs = networks.rows(models[:number], known, ()).inputs
        found.append(function_network(model, inputs, number).layers())
    return found


def _engine(layers: Sequence[DenseNetwork], width: int) -> Engine:
    network = arrange(ARRANGEMENT, layers, Engine, Settings(options={"segment_width": width}))
    assert isinstance(network, Engine)
    return network


def _means(engine: Engine, rows: Rows) -> Real:
    """The mean bit-true error of each output in percent."""
    results = SIGNAL.to_real(engine.process(SIGNAL.quantise(rows.inputs)[0]))
    return np.asarray(np.abs(100 * (results - rows.targets) / rows.scale).mean(axis=0))


def _rows(first: Sequence[Cell], outputs: Sequence[str], found: Sequence[Real]) -> list[list[Cell]]:
    return [
        [*first, output, *(float(means[c]) for means in found)] for c, output in enumerate(outputs)
    ]
