"""Bounds on the error of an engine's results, and the codes of its tanh."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from golden.engine.formats import (
    DROPPED,
    HIDDEN,
    ONE,
    RESULT,
    coeff_frac,
)
from golden.engine.function_table import table_of
from golden.engine.graph import Kind
from golden.engine.operand_select import OperandSelect
from golden.engine.quantise import first_values, planned
from golden.engine.table_address import TableAddress
from golden.engine.tanh_table import LineTable
from golden.numbers.fixed import Codes, Overflow, Rounding, requantise
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.trained.dense import Trained
from golden.trained.function import Function


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

    sensors: How many inputs are samples; the others are outputs of earlier networks.
    met: See ``planned``.

    The operand memory keeps an earlier output, which a later network reads, with four bits more
    than leave the engine. So this word lies up to half a unit of 2**-13 and one of 2**-17 from the
    output's code.

    A quantiser is exact where its operands are; where they are not, it can be a whole step off.
    """
    seen = 2.0 ** -(SIGNAL.frac + 1) + 2.0**-RESULT.frac
    values = first_values(sensors, network.shape[0] - sensors)
    errors = np.array([seen * value.earlier for value in values])
    for one in planned(network, values, met):
        exact, layer = one.exact, one.layer
        result, grid = layer.result, exact.grid
        weights = np.array(
            [[abs(float(row[v.node] * v.factor)) for v in values] for row in exact.weights]
        )
        off = weights @ errors
        if grid:
            off = np.where(off > 0, off + 2.0 ** (grid.cut - result.frac), 0.0)
        else:
            reached = [max(-v.low, v.high) * 2.0**-v.fmt.frac for v in values]
            halves = [2.0 ** -(coeff_frac(result, v.fmt) + 1) for v in values]
            off += np.dot(halves, reached) + 2.0 ** -(coeff_frac(result, ONE) + 1)
            frac = SIGNAL.frac if exact.output else result.frac
            off += 2.0 ** -(frac + 1)
            off += [
                sum(
                    _steepest(function) * errors[word] + table_of(function, segment_width).error
                    for word, function in layer.added_to(node)
                )
                for node in range(layer.nodes)
            ]
            if layer.functions:
                tables = [table_of(function, segment_width).error for function in layer.functions]
                off = off * [_steepest(function) for function in layer.functions] + tables
            # The largest word is one unit below 1.
            off += 2.0**-frac * (exact.activation == "hard_tanh")
        values = one.values
        errors = off[[value.node for value in values]]
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
