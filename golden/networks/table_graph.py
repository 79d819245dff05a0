"""Table graph: a network of learned functions as small tables and sums, a frame every clock."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import sqrt
from typing import Any, Self

import numpy as np

from golden.common.flow import Flow, Wire
from golden.input_error import InputError
from golden.layers.constant_matrix import ConstantMatrix
from golden.networks.design import AtOnce, Settings
from golden.networks.oracle import error_bounds, exact, hidden_weights
from golden.networks.small_tables import SmallTable, TablePart
from golden.networks.table_sums import (
    MARGIN,
    TOLERANCE,
    FunctionSum,
    FunctionSums,
    Grid,
    TableSum,
    beside,
    function_sums,
    table_sum,
)
from golden.numbers.fixed import Codes, Fix
from golden.numbers.precision import EXACT, SIGNAL
from golden.numbers.real import Real
from golden.trained.dense import DenseNetwork

# The options of a scene that does not set them: the bits of a sample and of a hidden sum that
# tables read, those of an output, and the adders, as in ``AdderGraph``.
OPTIONS = {
    "sample_bits": 10,
    "hidden_bits": 10,
    "output_bits": 10,
    "adders_per_clock": 5,
    "adder_operands": 2,
}
# What may be set of the first three.
LEAST_BITS, MOST_BITS = 4, SIGNAL.width
# Bits below the last place of a hidden sum that its tables have.
GUARD = 1
# What is read where no sum has a table.
EMPTY = SmallTable(0, TablePart(1), (0, 0))


@dataclass(frozen=True)
class TableGraph(AtOnce):
    """Two layers of sums of functions; each function is a sum of small tables.

    samples: How many samples a frame has.
    sample_bits: The upper bits of a sample that tables read.
    first: The tables of the functions of the samples.
    hidden: Adds them up; a row for each hidden sum.
    second: The tables of the functions of the hidden sums.
    output: Adds them up; a row for each output.
    bounds: How far each output can be from real arithmetic, while no hidden sum saturates.
    constant_nodes: Hidden sums that are not built, because they never change.

    A frame of samples enters in one clock, and all outputs leave in another.
    """

    block = "table_graph"
    known_activations = (EXACT.activation,)
    activation_choices = False
    learned_functions = True
    options = tuple(OPTIONS)
    samples: int
    sample_bits: int
    first: tuple[SmallTable, ...]
    hidden: ConstantMatrix
    second: tuple[SmallTable, ...]
    output: ConstantMatrix
    bounds: tuple[float, ...] = field(default=(), kw_only=True)
    constant_nodes: int = field(default=0, kw_only=True)

    @classmethod
    def build(
        cls, networks: Sequence[DenseNetwork], settings: Settings, arrangement: str, variant: str
    ) -> Self:
        options: dict[str, Any] = {**OPTIONS, **settings.options}
        for key in ("sample_bits", "hidden_bits", "output_bits"):
            if not LEAST_BITS <= options[key] <= MOST_BITS:
                raise InputError(
                    f"hardware.{key}: got {options[key]}, expected {LEAST_BITS} to {MOST_BITS}"
                )
        reached = settings.reached or [()] * len(networks)
        network = beside(
            [
                function_sums(one, ends, cls.block)
                for one, ends in zip(networks, reached, strict=True)
            ]
        )
        samples = networks[0].shape[0]
        hidden, outputs, constant = _tabled(network, samples, options)
        moved = SIGNAL.width - options["output_bits"]
        adders = {key: options[key] for key in ("adders_per_clock", "adder_operands")}
        hidden_fmt = Fix(options["hidden_bits"], 0)
        return cls(
            samples,
            options["sample_bits"],
            *_added(hidden, hidden_fmt, "hidden", adders, dropped=GUARD),
            *_added(outputs, SIGNAL, "outputs", adders, moved=moved),
            bounds=tuple(one.error for one in outputs),
            useless_nodes=len(network.hidden) - len(hidden) - constant,
            constant_nodes=constant,
            variant=variant,
        )

    @classmethod
    def word_error(cls, inputs: int, options: Mapping[str, Any]) -> float:
        # A word is rounded, and each function that is added up may be off by the tolerance of its
        # tables.
        steps = sqrt(1 / 12 + inputs * (TOLERANCE / (1 << GUARD)) ** 2)
        bits: int = {**OPTIONS, **options}["hidden_bits"]
        return steps * (1 + 2 * MARGIN) * 2.0**-bits

    @property
    def inputs(self) -> int:
        return self.samples

    @property
    def outputs(self) -> int:
        return len(self.output.weights)

    @property
    def sample_fmt(self) -> Fix:
        """The format of the bits of a sample that tables read."""
        return Fix(self.sample_bits, self.sample_bits - 1)

    @property
    def latency(self) -> int:
        # The words of a table stand in registers.
        return 1 + self.hidden.latency + 1 + self.output.latency

    def hidden_words(self, frames: Codes) -> Codes:
        """What the tables of samples give, shape (frames, tables)."""
        samples = frames >> SIGNAL.width - self.sample_bits
        return _looked_up(self.first, samples, self.sample_fmt)

    def output_words(self, codes: Codes) -> Codes:
        """What the tables of hidden sums give, shape (frames, tables)."""
        return _looked_up(self.second, codes, self.hidden.out_fmt)

    def left_out(self) -> list[str]:
        texts = self.left_out_of()
        if self.constant_nodes:
            texts.append(f"{self.constant_nodes} hidden sums that never change, now in tables")
        return [*texts, "every multiplier: a function is the sum of a few small tables"]

    def flow(self) -> Flow:
        hidden, output = self.hidden, self.output
        return Flow(
            (
                Wire(f"{self.inputs} x", self.sample_fmt),
                None,
                Wire(f"{len(self.first)} words of tables", hidden.in_fmt),
                hidden,
                Wire(f"{len(hidden.weights)} s", hidden.out_fmt),
                None,
                Wire(f"{len(self.second)} words of tables", output.in_fmt),
                output,
                Wire(f"{self.outputs} y", output.out_fmt),
            ),
            across=True,
        )

    def compute(self, frames: Codes) -> Codes:
        codes = self.hidden.process(self.hidden_words(frames))
        return self.output.process(self.output_words(codes))

    def saturations(self, frames: Codes) -> dict[str, Codes]:
        words = np.stack(self.hidden.words(self.hidden_words(frames).T), axis=-1)
        fmt = self.hidden.out_fmt
        return {"layer of hidden sums": ((words < fmt.low) | (words > fmt.high)).sum(axis=-1)}

    @property
    def extremes(self) -> Codes:
        """Frames that drive each hidden sum to both of its ends, shape (frames, samples)."""
        every = np.arange(SIGNAL.low, SIGNAL.high + 1, 1 << SIGNAL.width - self.sample_bits)
        words = self.hidden_words(np.repeat(every[:, np.newaxis], self.samples, axis=1))
        found = []
        for row in self.hidden.weights:
            frames = np.zeros((2, self.samples), dtype=np.int64)
            for k in range(self.samples):
                own = [n for n, t in enumerate(self.first) if t.source == k and row[n]]
                sums = words[:, own].sum(axis=1)
                frames[:, k] = every[[sums.argmin(), sums.argmax()]]
            found.append(frames)
        return np.concatenate(found)


def _tabled(
    network: FunctionSums, samples: int, options: dict[str, Any]
) -> tuple[list[TableSum], list[TableSum], int]:
    """The hidden sums and the outputs in tables, and how many hidden sums never change.

    Those are not built, and neither are those that no output uses.
    """
    grid, fmt = Grid.of_codes(SIGNAL, options["sample_bits"]), Fix(options["hidden_bits"], 0)
    used = sorted({h for output in network.outputs for h in output.curves}) or [0]
    made: dict[int, TableSum] = {}
    grids: dict[int, Grid] = {}
    for h in used:
        low, high = network.ranges[h]
        step, middle = (high - low) / (1 << fmt.width + GUARD), (low + high) / 2
        made[h] = table_sum(network.hidden[h], [grid] * samples, step, middle)
        grids[h] = Grid.of_sums(fmt, GUARD, step, middle, made[h].error)
    fixed = {
        h: float(grids[h].centres[np.clip(made[h].constant >> GUARD, fmt.low, fmt.high) - fmt.low])
        for h in used
        if not made[h].tables
    }
    if len(fixed) == len(used):
        # There is one hidden sum at least.
        del fixed[used[0]]
    live = [h for h in used if h not in fixed]
    outputs, step = [], 2.0 ** (1 - options["output_bits"])
    for output in network.outputs:
        known = output.with_fixed(fixed)
        curves = {place: known.curves[h] for place, h in enumerate(live) if h in known.curves}
        wanted = FunctionSum(curves, known.constant)
        outputs.append(table_sum(wanted, [grids[h] for h in live], step))
    return [made[h] for h in live], outputs, len(fixed)


def _added(
    sums: Sequence[TableSum],
    out_fmt: Fix,
    variant: str,
    adders: Mapping[str, Any],
    dropped: int = 0,
    moved: int = 0,
) -> tuple[tuple[SmallTable, ...], ConstantMatrix]:
    """All tables of some sums, and the matrix that adds them up.

    A result lacks the ``dropped`` last bits of a sum, or the sum is ``moved`` to the left.
    """
    # A matrix adds one word up at least.
    tables = tuple(table for one in sums for table in one.tables) or (EMPTY,)
    rows, start = [], 0
    for one in sums:
        end = start + len(one.tables)
        rows.append(tuple((start <= n < end) << moved for n in range(len(tables))))
        start = end
    matrix = ConstantMatrix(
        Fix(max(2, *(table.width for table in tables)), 0),
        out_fmt,
        tuple(rows),
        tuple(one.constant << moved for one in sums),
        dropped,
        dropped,
        in_ends=tuple(table.ends for table in tables),
        variant=variant,
        **adders,
    )
    return tables, matrix


def _looked_up(tables: Sequence[SmallTable], codes: Codes, fmt: Fix) -> Codes:
    """The word of each table, shape (frames, tables)."""
    return np.stack([table.process(codes[:, table.source], fmt) for table in tables], axis=-1)


@exact.register
def _(design: TableGraph, frames: Codes) -> Codes:
    codes = design.hidden.exact(design.hidden_words(frames))
    return design.output.exact(design.output_words(codes))


@hidden_weights.register
def _(design: TableGraph) -> list[Sequence[int]]:
    high = design.extremes.reshape(-1, 2, design.inputs)[:, 1]
    return [row.tolist() for row in high]


@error_bounds.register
def _(design: TableGraph, *_known: object) -> Real:
    return np.array(design.bounds)
