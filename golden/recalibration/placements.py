"""Known placements, each once, and the noise of their readings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from golden.input_error import InputError
from golden.real import Real
from golden.scene import Vectors
from golden.table import read_csv_file, read_table

# Column of a CSV whose rows with the same number are one placement.
COLUMN = "placement"

# How many readings must be free to differ before they tell their noise: of four the standard
# deviation is known to a third.
LEAST_FREE = 4


@dataclass(frozen=True)
class Placements:
    """Known placements, each once, with the mean of its readings.

    Attributes
    ----------
    inputs : float array, shape (placements, sensors)
        Means of the readings, as signals.
    targets, scale : float array, shape (placements, outputs)
        As in ``Vectors``.
    times : float array, shape (placements,)
        How often each was read.
    """

    inputs: Real
    targets: Real
    scale: Real
    times: Real

    def __len__(self) -> int:
        return len(self.times)

    def without(self, number: int) -> Placements:
        """All but one."""
        return self.at(np.delete(np.arange(len(self)), number))

    def at(self, numbers: NDArray[np.intp]) -> Placements:
        """Some of them."""
        return Placements(
            self.inputs[numbers], self.targets[numbers], self.scale[numbers], self.times[numbers]
        )


def numbers_of(path: Path, taken: Sequence[str]) -> Real | None:
    """The column ``placement`` of a CSV; None where it has none, or where a scene calls a sensor or
    an output so.

    Parameters
    ----------
    path : Path
        Of a file that was read before; see ``read_table``.
    taken : sequence of str
        Columns of the scene.
    """
    if COLUMN in taken or COLUMN not in read_csv_file(path).names:
        return None
    result: Real = read_table(path, [COLUMN])[:, 0]
    return result


def grouped(vectors: Vectors, numbers: Real | None) -> tuple[Placements, NDArray[np.intp]]:
    """Rows with the same number are one placement that was read several times.

    Equal outputs alone do not make a placement: what a scene does not tell may differ.

    Parameters
    ----------
    vectors : Vectors
    numbers : float array, shape (rows,), or None
        None if each row is a placement of its own.

    Returns
    -------
    Placements
        In the order in which they come first.
    int array, shape (rows,)
        Which of them each row is.

    Raises
    ------
    InputError
        For outputs that differ at one placement.
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
    """Standard deviation of one reading of each sensor, from placements that were read repeatedly.

    Equation: the squares by which readings differ from the mean of their placement, summed over all
    readings and divided by readings less placements.

    Parameters
    ----------
    vectors : Vectors
    found : Placements
    place : int array, shape (rows,)
        See ``grouped``.

    Returns
    -------
    float array, shape (sensors,), or None
        As signals; None where readings less placements are below ``LEAST_FREE``.
    """
    free = len(place) - len(found)
    if free < LEAST_FREE:
        return None
    result: Real = np.sqrt(((vectors.inputs - found.inputs[place]) ** 2).sum(axis=0) / free)
    return result
