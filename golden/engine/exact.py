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
    SAMPLE,
    SAMPLE_SHIFT,
    coeff_frac,
)
from golden.engine.function_table import table_of
from golden.engine.graph import Graph, Kind, Neuron
from golden.engine.layers import exact_layers, first_values, planned
from golden.engine.line_table import LineTable
from golden.engine.operand_select import OperandSelect
from golden.engine.table_address import TableAddress
from golden.engine.tanh_table import tanh_table
from golden.fixed import Codes, Fix, Overflow, Rounding, requantise
from golden.function import Function
from golden.mlp import Mlp
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


def error_bounds(mlp: Mlp, segment_width: int, sensors: int) -> Real:
    """How far each output of a network can be from real arithmetic that saturates.

    The bounds are those of a network of two layers (``golden.networks.bounds``) with one addition:
    the operand memory keeps an earlier output, which a later network reads, with four bits more
    than leave the engine. So this word lies up to half a unit of 2**-13 and one of 2**-17 from the
    output's code.
    """
    seen = 2.0 ** -(SIGNAL.frac + 1) + 2.0**-RESULT.frac
    q_off = _weight_rounding(mlp.w1[:, :sensors], HIDDEN, SAMPLE) + _weight_rounding(
        mlp.w1[:, sensors:], HIDDEN, RESULT
    )
    q_off += _weight_rounding(mlp.b1[:, np.newaxis], HIDDEN, ONE) + 2.0 ** -(HIDDEN.frac + 1)
    q_off += seen * np.abs(mlp.w1[:, sensors:]).sum(axis=1)
    r_off = q_off + tanh_error(segment_width)
    bounds: Real = np.abs(mlp.w2) @ r_off + 2.0 ** -(SIGNAL.frac + 1)
    bounds += _weight_rounding(mlp.w2, RESULT, RESULT) + _weight_rounding(
        mlp.b2[:, np.newaxis], RESULT, ONE
    )
    return bounds


def layered_bounds(network: Trained, segment_width: int, met: Sequence[float] = ()) -> Real:
    """How far each output can be from real arithmetic, for layers without a quantiser.

    The bounds add up what rounding takes, layer by layer, since no activation is steeper than 1. In
    real arithmetic the outputs saturate, as those of any network.

    Where the range of a layer is from the data (``met``), the bounds hold only for frames in which
    none of its sums saturates, which ``Engine.saturations`` tells. For any other frame there is no
    bound. Where all ranges are from bounds, they hold for every frame.
    """
    plan = planned(network, first_values(network.shape[0], 0), met)
    off, operands = np.zeros(network.shape[0]), [SAMPLE] * network.shape[0]
    for layer, sums in zip(exact_layers(network), plan, strict=True):
        result = SIGNAL if sums is plan[-1] else sums.result
        # A word reaches 2**17 of its units, and half a unit of the weight is lost.
        halves = [2.0 ** (RESULT.frac - f.frac - coeff_frac(sums.result, f) - 1) for f in operands]
        off = np.abs(np.array(layer.weights, dtype=np.float64)) @ off + sum(halves)
        off += 2.0 ** -(coeff_frac(sums.result, ONE) + 1) + 2.0 ** -(result.frac + 1)
        if sums.activation == "tanh":
            off += tanh_error(segment_width)
        # The ends of a word are not quite those of a hard tanh.
        off += 2.0**-RESULT.frac * (sums.activation == "hard_tanh")
        operands = [value.fmt for value in sums.values]
    return off


def _weight_rounding(weights: Real, result: Fix, operand: Fix) -> Real:
    """The error that rounded weights cause in each neuron: at most half a unit per weight."""
    half = 2.0 ** -(coeff_frac(result, operand) + 1)
    return np.full(len(weights), half * weights.shape[1])


@lru_cache
def tanh_error(segment_width: int) -> float:
    """Largest error of tanh over every code of q, its rounding to 17 fraction bits included."""
    q = np.arange(HIDDEN.low, HIDDEN.high + 1)
    r = tanh_codes(tanh_table(segment_width), q)
    return float(np.abs(RESULT.to_real(r) - np.tanh(HIDDEN.to_real(q))).max())


def tanh_codes(table: LineTable, q: Codes) -> Codes:
    """The codes of tanh that an engine with this table computes for codes of q, Fix(18,17)."""
    segment = TableAddress(table.width, len(table.slopes)).process(q)
    select = OperandSelect(table.width)
    sums = np.array(table.intercepts)[segment] * select.process(q, np.full(len(q), Kind.INTERCEPT))
    sums += np.array(table.slopes)[segment] * select.process(q, np.full(len(q), Kind.DISTANCE))
    return requantise(sums, DROPPED, RESULT, Rounding.ROUND, Overflow.SATURATE)
