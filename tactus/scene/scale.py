"""The scale of a column, between its own unit and the codes: ``data.scale`` of a scene.

The equation is ``reading = offset + factor * signal``, where a signal is code / 2**13, in [-1, 1).
So ``offset`` is the reading at code 0, and ``factor`` is what full scale adds to it, both in the
unit of the column. An ADC of 0 to 5 V has ``{ offset = 2.5, factor = 2.5 }``. A column without a
scale holds signals.

The hardware knows only signals, and a scale adds nothing to it. The scale of a sensor says which
code its converter must give for which reading. Where the scene names the converter, the scale comes
from its data sheet; see ``tactus.scene.known_scales``. A network file maps readings to outputs
in their units, whoever trained it; the scales are folded into its weights when it is read.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from golden.input_error import InputError, naming, suggest
from golden.numbers.real import Real
from golden.trained.dense import DenseNetwork, shifted

AUTO = "auto"

# With "auto" the codes reach beyond both ends of the range of the readings by this part of the
# range, because later readings may go further. This costs half a bit of fourteen.
BEYOND = 0.25

# This is far beyond any unit, and only keeps sums finite.
LARGEST = 1e150


@dataclass(frozen=True)
class Scale:
    """The scale of one column.

    offset, factor: Both are in the unit of the column; the factor is above 0.
    """

    offset: float = 0.0
    factor: float = 1.0


def signals(readings: Real, scales: Sequence[Scale]) -> Real:
    offsets, factors = _arrays(scales)
    # A signal that overflows is outside every range, and is refused where ranges are checked.
    with np.errstate(over="ignore"):
        result: Real = (readings - offsets) / factors
    return result


def readings(signals: Real, scales: Sequence[Scale]) -> Real:
    offsets, factors = _arrays(scales)
    return offsets + factors * signals


def _arrays(scales: Sequence[Scale]) -> tuple[Real, Real]:
    return np.array([s.offset for s in scales]), np.array([s.factor for s in scales])


def on_signals(
    network: DenseNetwork, inputs: Sequence[Scale], outputs: Sequence[Scale]
) -> DenseNetwork:
    """Turn a network on readings into the same network on signals, which the hardware holds."""
    into, out = _arrays(inputs), _arrays(outputs)
    layers = [*network.layers]
    first = layers[0]
    with np.errstate(over="ignore", invalid="ignore"):
        w1, b1 = first.weights * into[1], shifted(first.biases, first.weights, into[0])
    with naming("layer 1"):
        layers[0] = replace(first, weights=w1, biases=b1)
    # In a network of a single layer, this is the layer that has just been scaled.
    last = layers[-1]
    with np.errstate(over="ignore", invalid="ignore"):
        w2, b2 = last.weights / out[1][:, np.newaxis], (last.biases - out[0]) / out[1]
    with naming(f"layer {len(layers)}"):
        layers[-1] = replace(last, weights=w2, biases=b2)
    return DenseNetwork(tuple(layers))


def on_readings(
    network: DenseNetwork, inputs: Sequence[Scale], outputs: Sequence[Scale]
) -> DenseNetwork:
    """Turn a network on signals into the same network on readings, which a file holds."""
    into, out = _arrays(inputs), _arrays(outputs)
    layers = [*network.layers]
    first = layers[0]
    w1 = first.weights / into[1]
    layers[0] = replace(first, weights=w1, biases=shifted(first.biases, w1, -into[0]))
    last = layers[-1]
    w2, b2 = last.weights * out[1][:, np.newaxis], last.biases * out[1] + out[0]
    layers[-1] = replace(last, weights=w2, biases=b2)
    return DenseNetwork(tuple(layers))


def range_scale(column: Real) -> Scale:
    """The scale for "auto": the range of these readings, extended by a quarter at both ends.

    The factor is rounded to three digits, so that it can be read and copied.
    """
    low, high = float(column.min()), float(column.max())
    half = high / 2 - low / 2
    if not half > 0:
        raise InputError(f"got {low:g} in every row, expected readings that differ")
    if not half < LARGEST:
        raise InputError(f"got {low:g} to {high:g}, expected a range below {2 * LARGEST:g}")
    text = f"{half * (1 + 2 * BEYOND):.2e}"
    return Scale(round(low + half, 2 - int(text.split("e")[1])), float(text))


def with_units(data: dict[str, Any]) -> list[str]:
    """The columns that may have a scale and a unit. The outputs of classes have neither."""
    return [*data["sensors"], *([] if data.get("classes") else data["outputs"])]


def read_scale(data: dict[str, Any], path: Path) -> dict[str, Scale | str]:
    """Read ``data.scale``, which maps a column to its scale or to "auto"."""
    written, columns = data["scale"], with_units(data)
    if written == AUTO:
        return dict.fromkeys(columns, AUTO)
    found: dict[str, Scale | str] = {}
    for name, value in written.items():
        refuse_other_column("scale", name, columns, path)
        auto = value == AUTO
        found[name] = AUTO if auto else Scale(**{key: float(value[key]) for key in value})
    return found


def refuse_other_column(key: str, name: str, columns: Sequence[str], path: Path) -> None:
    """Refuse a name in ``data.<key>`` that is neither a sensor nor an output."""
    if name not in columns:
        raise InputError(
            f"{path}: data.{key}: {name!r} is no sensor and no output, expected one of "
            f"{', '.join(columns)}{suggest(name, columns)}"
        )
