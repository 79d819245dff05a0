"""An engine's results, neuron by neuron in Python's integers, and bounds on their error."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from golden.dense import Trained
from golden.engine.formats import (
    DROPPED,
    HIDDEN,
    ONE,
    OUTPUT_SHIFT,
    RESULT,
    SAMPLE_SHIFT,
    coeff_frac,
)
from golden.engine.function_table import table_of
from golden.engine.graph import Graph, Kind, Neuron
from golden.engine.layers import exact_layers, first_values, planned
from golden.engine.line_table import LineTable
from golden.engine.operand_select import OperandSelect
from golden.engine.table_address import TableAddress
from golden.fixed import Codes, Overflow, Rounding, requantise
from golden.function import Function
from golden.precision import SIGNAL
from golden.real import Real


def exact(graph: Graph, segment_width: int, frames: Codes) -> Codes:
    """Output codes of a graph, computed in unlimited integers and without a program.

    Parameters
    ----------
    graph : Graph
    segment_width : int
    frames : int64 array, shape (frames, inputs)
    """
    found = [exact_sums(graph, segment_width, frame) for frame in frames.tolist()]
    outputs = [place for place, neuron in enumerate(graph.neurons) if neuron.output]
    return np.array([[frame[place][1] >> OUTPUT_SHIFT for place in outputs] for frame in found])


def exact_sums(graph: Graph, segment_width: int, frame: list[int]) -> list[tuple[int, int]]:
    """The sum of each neuron and the word that it becomes, for the sample codes of one frame."""
    values = [sample << SAMPLE_SHIFT for sample in frame]
    found = []
    for neuron in graph.neurons:
        total = neuron.start + _sum(neuron, values, segment_width)
        word = max(0 if neuron.relu else RESULT.low, min(RESULT.high, total >> DROPPED))
        if neuron.cut:
            unit = 1 << neuron.cut
            halfway = neuron.even and total % (unit << DROPPED) == 0 and word == total >> DROPPED
            word -= word % (2 * unit if halfway else unit)
        values.append(word)
        found.append((total, word))
    return found


def _sum(neuron: Neuron, values: list[int], segment_width: int) -> int:
    if neuron.looks_up:
        return looked_up_sum(neuron.function, segment_width, values[neuron.terms[0].source])
    return sum(
        term.weight * (1 << DROPPED if term.kind is Kind.ONE else values[term.source])
        for term in neuron.terms
    )


def looked_up_sum(function: Function, segment_width: int, q: int) -> int:
    """The exact sum of the neuron that computes a function of q."""
    table = table_of(function, segment_width)
    span, segments = 1 << segment_width, len(table.slopes) // (1 + table.both)
    segment = min((q if q >= 0 else -q - 1) // span, segments - 1)
    if table.both and q < 0:
        segment += segments
    one = 1 << DROPPED if q >= 0 else -(1 << DROPPED)
    return table.intercepts[segment] * one + table.slopes[segment] * (q % span - span // 2)


def error_bounds(
    network: Trained, segment_width: int, sensors: int, met: Sequence[float] = ()
) -> Real:
    """How far each output of a network can be from real arithmetic that saturates.

    Real arithmetic saturates the sum in front of each table, and the output, where the engine does.
    Layer by layer the error of a sum is that of its operands, times their weights, plus the error
    of the rounded weights, bias and result. Behind a table it is multiplied by the steepest slope
    of the function, and the error of the table is added. No other activation has a slope above 1,
    so it increases no error.

    Where the range of a layer is from the data (``met``), the bounds hold only for frames in which
    none of its sums saturates, which ``Engine.saturations`` tells. For any other frame there is no
    bound. Where all ranges are from bounds, they hold for every frame.

    Parameters
    ----------
    network : Mlp or DenseNetwork
    segment_width : int
    sensors : int
        How many inputs are samples; the others are outputs of earlier networks.
    met : sequence of float
        See ``planned``.

    Notes
    -----
    The operand memory keeps an earlier output, which a later network reads, with four bits more
    than leave the engine. So this word lies up to half a unit of 2**-13 and one of 2**-17 from the
    output's code.

    A quantiser is exact where its operands are; where they are not, it can be a whole step off.
    """
    seen = 2.0 ** -(SIGNAL.frac + 1) + 2.0**-RESULT.frac
    values = first_values(sensors, network.shape[0] - sensors)
    errors = np.array([seen * value.earlier for value in values])
    plan = planned(network, values, met)
    for number, (layer, sums) in enumerate(zip(exact_layers(network), plan, strict=True), start=1):
        weights = np.array(
            [[abs(float(row[v.node] * v.factor)) for v in values] for row in layer.weights]
        )
        off = weights @ errors
        if sums.grid:
            off = np.where(off > 0, off + 2.0 ** (sums.grid.cut - sums.result.frac), 0.0)
        else:
            reached = [max(-v.low, v.high) * 2.0**-v.fmt.frac for v in values]
            halves = [2.0 ** -(coeff_frac(sums.result, v.fmt) + 1) for v in values]
            off += np.dot(halves, reached) + 2.0 ** -(coeff_frac(sums.result, ONE) + 1)
            frac = SIGNAL.frac if number == len(plan) else sums.result.frac
            off += 2.0 ** -(frac + 1)
            if sums.functions:
                tables = [table_of(function, segment_width).error for function in sums.functions]
                off = off * [_steepest(function) for function in sums.functions] + tables
            # The largest word is one unit below 1.
            off += 2.0**-frac * (sums.activation == "hard_tanh")
        values = sums.values
        errors = off[[value.node for value in values]] if values else off
    bounds: Real = off
    return bounds


@lru_cache
def _steepest(function: Function) -> float:
    """The largest slope of a function over the codes of q."""
    q = HIDDEN.to_real(np.arange(HIDDEN.low, HIDDEN.high + 1))
    return float(np.abs(np.diff(function.value(q))).max() * 2.0**HIDDEN.frac)


def tanh_codes(table: LineTable, q: Codes) -> Codes:
    """The codes of tanh that an engine with this table computes for codes of q, Fix(18,17)."""
    segment = TableAddress(table.width, len(table.slopes)).process(q)
    select = OperandSelect(table.width)
    sums = np.array(table.intercepts)[segment] * select.process(q, np.full(len(q), Kind.INTERCEPT))
    sums += np.array(table.slopes)[segment] * select.process(q, np.full(len(q), Kind.DISTANCE))
    return requantise(sums, DROPPED, RESULT, Rounding.ROUND, Overflow.SATURATE)
