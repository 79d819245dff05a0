"""Known placements, each of them once, and the noise of their readings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from golden.input_error import InputError
from golden.numbers.real import Real
from tactus.core.table import read_csv_file, read_table
from tactus.scene import Vectors

# Column of a CSV file. Rows with the same number in it are readings of one placement.
COLUMN = "placement"

# The least number of degrees of freedom from which noise is estimated. With four the standard
# deviation is known to a third.
LEAST_FREE = 4


@dataclass(frozen=True)
class Placements:
    """Known placements, each of them once, with the mean of its readings.

    inputs, shape (placements, sensors): Means of the readings as signals.
    targets, scale, shape (placements, outputs): As in ``Vectors``.
    times, shape (placements,): How often each placement was read.
    """

    inputs: Real
    targets: Real
    scale: Real
    times: Real

    def __len__(self) -> int:
        return len(self.times)

    def without(self, number: int) -> Placements:
        """All placements but one."""
        return self.at(np.delete(np.arange(len(self)), number))

    def at(self, numbers: NDArray[np.intp]) -> Placements:
        """Some of the placements."""
        return Placements(
            self.inputs[numbers], self.targets[numbers], self.scale[numbers], self.times[numbers]
        )


def numbers_of(path: Path, columns: Sequence[str]) -> Real | None:
    """The column ``placement`` of a CSV file.

    It is None if there is no such column, or if a sensor or an output of the scene has this name.

    path: Path of a file that has been read before; see ``read_table``.
    columns: Columns of the scene.
    """
    if COLUMN in columns or COLUMN not in read_csv_file(path).names:
        return None
    return read_table(path, [COLUMN])[:, 0]


def grouped(vectors: Vectors, numbers: Real | None) -> tuple[Placements, NDArray[np.intp]]:
    """Combine rows with the same number, which are readings of one placement.

    Rows with equal outputs are not combined, because something that is not an output may differ.

    numbers, shape (rows,): The number of each row; None if each row is a placement of its own.

    Returns: The placements, in the order in which they first occur.
    Returns, shape (rows,): The index of the placement of each row.
    """
    if numbers is None:
        numbers = np.arange(len(vectors.inputs), dtype=np.float64)
    _, first, which = np.unique(numbers, return_index=True, return_inverse=True)
    order = np.argsort(first)
    place = np.argsort(order)[which.ravel()]
    rows = first[order]
    other = np.flatnonzero((vectors.targets != vectors.targets[rows[place]]).any(axis=1))
    if len(other):
        row = int(other[0])
        raise InputError(
            f"column {COLUMN!r}: got {numbers[row]:g} in row {row + 1} with other outputs than in "
            f"row {rows[place[row]] + 1}, expected the same"
        )
    times = np.bincount(place).astype(np.float64)
    sums = np.zeros((len(first), vectors.inputs.shape[1]))
    np.add.at(sums, place, vectors.inputs)
    means = sums / times[:, np.newaxis]
    return Placements(means, vectors.targets[rows], vectors.scale[rows], times), place


def noise_of_repeats(vectors: Vectors, found: Placements, place: NDArray[np.intp]) -> Real | None:
    """The standard deviation of one reading of each sensor, from placements read repeatedly.

    Equation: it is the root of the sum over all readings of the squared differences from the mean
    of the placement, divided by the number of readings minus the number of placements.

    place, shape (rows,): See ``grouped``.

    Returns, shape (sensors,): As signals; None if the number of readings minus that of placements
        is below ``LEAST_FREE``.
    """
    free = len(place) - len(found)
    if free < LEAST_FREE:
        return None
    return np.sqrt(((vectors.inputs - found.inputs[place]) ** 2).sum(axis=0) / free)
