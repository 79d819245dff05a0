"""What the codes of a column stand for in the column's own unit: ``data.scale`` of a scene.

Equation: ``reading = offset + factor * signal``, where a signal is code / 2**13, in [-1, 1). So
``offset`` is the reading of code 0 and ``factor`` what full scale adds to it, both in the unit of
the column: an ADC of 0 to 5 V has ``{ offset = 2.5, factor = 2.5 }``. A column that names no scale
holds signals.

Hardware knows signals alone, and nothing is added to it: the scale of a sensor says which reading
its converter has to give as which code. Where the scene names the converter, the scale is that of
its data sheet; see ``golden.scene.converter_scale``. A network file maps readings to outputs in
their units, whoever trained it; the scales are folded into its weights when it is read.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from golden.cli import naming
from golden.dense import Some, layers_of, rebuilt
from golden.input_error import InputError
from golden.mlp import shifted
from golden.real import Real
from golden.table import suggest

AUTO = "auto"

# Of the range of the readings that "auto" is worked out from, what the codes reach beyond either
# end: readings that are still to come go further, and half a bit of fourteen is what it costs.
BEYOND = 0.25

# Far beyond any unit: it only keeps sums finite.
LARGEST = 1e150


@dataclass(frozen=True)
class Scale:
    """The scale of one column.

    Attributes
    ----------
    offset, factor : float
        In the unit of the column; the factor is above 0.
    """

    offset: float = 0.0
    factor: float = 1.0


def signals(readings: Real, scales: Sequence[Scale]) -> Real:
    """Signals of readings, shape (..., columns)."""
    offsets, factors = _arrays(scales)
    # What overflows is outside every range, and refused there.
    with np.errstate(over="ignore"):
        result: Real = (readings - offsets) / factors
    return result


def readings(signals: Real, scales: Sequence[Scale]) -> Real:
    """Readings of signals, shape (..., columns)."""
    offsets, factors = _arrays(scales)
    result: Real = offsets + factors * signals
    return result


def _arrays(scales: Sequence[Scale]) -> tuple[Real, Real]:
    return np.array([s.offset for s in scales]), np.array([s.factor for s in scales])


def on_signals(network: Some, inputs: Sequence[Scale], outputs: Sequence[Scale]) -> Some:
    """A network on readings as the same network on signals, which is what hardware holds.

    Raises
    ------
    InputError
        When a weight is too large for a float.
    """
    into, out = _arrays(inputs), _arrays(outputs)
    first, *between, last = layers_of(network)
    with np.errstate(over="ignore", invalid="ignore"):
        w1, b1 = first.weights * into[1], shifted(first.biases, first.weights, into[0])
        w2, b2 = last.weights / out[1][:, np.newaxis], (last.biases - out[0]) / out[1]
    with naming("layer 1"):
        first = replace(first, weights=w1, biases=b1)
    with naming(f"layer {len(between) + 2}"):
        last = replace(last, weights=w2, biases=b2)
    return rebuilt(network, [first, *between, last])


def on_readings(network: Some, inputs: Sequence[Scale], outputs: Sequence[Scale]) -> Some:
    """A network on signals as the same network on readings, which is what a file holds."""
    into, out = _arrays(inputs), _arrays(outputs)
    first, *between, last = layers_of(network)
    w1 = first.weights / into[1]
    w2, b2 = last.weights * out[1][:, np.newaxis], last.biases * out[1] + out[0]
    start = replace(first, weights=w1, biases=shifted(first.biases, w1, -into[0]))
    return rebuilt(network, [start, *between, replace(last, weights=w2, biases=b2)])


def range_scale(column: Real) -> Scale:
    """The scale that "auto" stands for: the range of these readings, and a quarter of it beyond
    either end.

    In three digits of the factor, so that it can be read and copied.

    Raises
    ------
    InputError
        When the readings do not differ, or are too large to subtract.
    """
    low, high = float(column.min()), float(column.max())
    half = high / 2 - low / 2
    if not half > 0:
        raise InputError(f"got {low:g} in every row, expected readings that differ")
    if not half < LARGEST:
        raise InputError(f"got {low:g} to {high:g}, expected a range below {2 * LARGEST:g}")
    text = f"{half * (1 + 2 * BEYOND):.2e}"
    return Scale(round(low + half, 2 - int(text.split("e")[1])), float(text))


def read_scale(data: dict[str, Any], path: Path) -> dict[str, Scale | str]:
    """``data.scale``: column to its scale, or to "auto".

    Raises
    ------
    InputError
        For another column than a sensor or an output.
    """
    given, columns = data["scale"], [*data["sensors"], *data["outputs"]]
    if given == AUTO:
        return dict.fromkeys(columns, AUTO)
    found: dict[str, Scale | str] = {}
    for name, value in given.items():
        refuse_other_column("scale", name, columns, path)
        auto = value == AUTO
        found[name] = AUTO if auto else Scale(**{key: float(value[key]) for key in value})
    return found


def refuse_other_column(key: str, name: str, columns: Sequence[str], path: Path) -> None:
    """Refuse a name in ``data.<key>`` that is no sensor and no output.

    Raises
    ------
    InputError
    """
    if name not in columns:
        raise InputError(
            f"{path}: data.{key}: {name!r} is no sensor and no output, expected one of "
            f"{', '.join(columns)}{suggest(name, columns)}"
        )
