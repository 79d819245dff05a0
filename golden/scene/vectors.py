"""The recorded vectors of a scene."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from golden.fixed import Codes
from golden.metrics import error_scale
from golden.networks.mlp import Real
from golden.precision import SIGNAL
from golden.scene.scale import Scale, readings, signals
from golden.table import read_table, rows_where

if TYPE_CHECKING:
    from golden.scene.scene import Scene

# Of one sensor. More readings outside the codes' range are no outliers but in another unit.
MOST_OUTSIDE = 0.1


@dataclass(frozen=True)
class Recorded:
    """The rows that a scene uses as its file holds them, in the units of the columns.

    Attributes
    ----------
    inputs : float array, shape (rows, sensors)
    targets : float array, shape (rows, outputs)
    groups : float array, shape (rows,)
        Positions; zeros where the scene names none.
    numbers : int array, shape (rows,)
        Which rows of the file these are, from 0.
    """

    inputs: Real
    targets: Real
    groups: Real
    numbers: NDArray[np.intp]


def read_recorded(scene: Scene) -> Recorded:
    """The rows that a scene uses.

    Raises
    ------
    FileNotFoundError, ValueError
        See ``read_table`` and ``rows_where``.
    """
    columns = [*scene.sensors, *scene.outputs] + ([scene.group_by] if scene.group_by else [])
    kept = rows_where(scene.data_path, scene.where)
    table = read_table(scene.data_path, columns)[kept]
    sensors, last = len(scene.sensors), len(scene.sensors) + len(scene.outputs)
    groups = table[:, -1] if scene.group_by else np.zeros(len(table))
    return Recorded(table[:, :sensors], table[:, sensors:last], groups, kept)


@dataclass(frozen=True)
class Vectors:
    """Recorded vectors as hardware knows them: inputs and targets as signals, inputs as codes.

    Attributes
    ----------
    inputs : float array, shape (rows, sensors)
    targets : float array, shape (rows, outputs)
    scale : float array, shape (rows, outputs)
        What an error counts against, as a signal: the target or a full scale.
    groups : float array, shape (rows,)
        Positions, in the unit of their column.
    codes : int64 array, shape (rows, sensors)
    saturated : int
        Inputs outside [-1, 1) that were replaced by the nearest code.
    outside : tuple of str
        A sentence for each sensor with readings outside the range of the codes.
    """

    inputs: Real
    targets: Real
    scale: Real
    groups: Real
    codes: Codes
    saturated: int
    outside: tuple[str, ...]

    def percent_errors(self, results: Real) -> Real:
        """Equation 3.16 for results, shape (rows, outputs), as signals: errors in percent."""
        return 100 * np.abs(self.targets - results) / self.scale

    def with_inputs(self, inputs: Real) -> Vectors:
        """The same rows with other signals of the sensors, and the codes of these."""
        codes, saturated = SIGNAL.quantise(inputs, "inputs")
        return replace(self, inputs=inputs, codes=codes, saturated=saturated)


def read_vectors(scene: Scene) -> Vectors:
    """The recorded vectors of a scene, quantised.

    Raises
    ------
    FileNotFoundError, ValueError
        See ``read_recorded`` and ``trained_scales``; also for a target outside the range of the
        codes, a target of 0 where the error is relative to the target, or a sensor of which more
        than a tenth of the readings are outside.
    """
    rows = read_recorded(scene)
    scales = scene.scales(scene.outputs)
    targets = signals(rows.targets, scales)
    beyond = np.argwhere(np.abs(targets) > 1)
    if len(beyond):
        row, c = beyond[0]
        raise ValueError(
            f"{scene.data_path}: column {scene.outputs[c]!r}: got a target of "
            f"{rows.targets[row, c]:g} in row {rows.numbers[row] + 1}, expected "
            f"{_range(scales[c])}, the range of {SIGNAL}; {_remedy(scene, scene.outputs[c])}"
        )
    for c, name in enumerate(scene.outputs):
        if name not in scene.full_scale and (rows.targets[:, c] == 0).any():
            raise ValueError(
                f"{scene.data_path}: column {name!r} holds a target of 0, whose relative error "
                f"is not defined; give {name} a full_scale in {scene.path}"
            )
    inputs = signals(rows.inputs, scene.scales(scene.sensors))
    outside = tuple(_outside(scene, rows, inputs))
    codes, saturated = SIGNAL.quantise(inputs, f"{scene.data_path} sensors")
    counts = error_scale(rows.targets, scene.outputs, scene.full_scale)
    return Vectors(
        inputs,
        targets,
        counts / [s.factor for s in scales],
        rows.groups,
        codes,
        saturated,
        outside,
    )


def _outside(scene: Scene, rows: Recorded, inputs: Real) -> list[str]:
    """A sentence for each sensor with readings outside the range of the codes.

    Raises
    ------
    ValueError
        When these are more than a tenth of its readings.
    """
    sentences = []
    scales = scene.scales(scene.sensors)
    for c, name in enumerate(scene.sensors):
        # 1 itself has the code next to it.
        count = int((np.abs(inputs[:, c]) > 1).sum())
        if not count:
            continue
        row = int(np.abs(inputs[:, c]).argmax())
        sentence = (
            f"{scene.data_path}: column {name!r}: got {count} of {len(inputs)} readings outside "
            f"{_range(scales[c])}, the furthest {rows.inputs[row, c]:g} in row "
            f"{rows.numbers[row] + 1}"
        )
        if count > MOST_OUTSIDE * len(inputs):
            raise ValueError(f"{sentence}, expected at most a tenth; {_remedy(scene, name)}")
        sentences.append(f"{sentence}; the nearest code stands for them")
    return sentences


def _range(scale: Scale) -> str:
    low, high = readings(np.array([[-1.0], [1.0]]), [scale]).ravel()
    return f"{low:g} to {high:g}"


def _remedy(scene: Scene, name: str) -> str:
    return (
        f"give {name} a data.scale in {scene.path} that holds it, {{ offset = , factor = }}, or "
        "'auto', which make train works out"
    )


def warn_outside(scene: Scene) -> None:
    """Warn of readings outside the range of the codes, a line for each sensor that has any."""
    for sentence in scene.vectors().outside:
        warnings.warn(sentence, stacklevel=2)
