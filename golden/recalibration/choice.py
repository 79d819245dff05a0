"""Which placements determine a recalibration, and whether some do."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from golden.networks.mlp import Real
from golden.recalibration.fit import Sensitivity
from golden.scene import Scene, Vectors

# What an unsure correction may add to the error of an output, as a part of its own. With more the
# correction would be the worse part of the instrument.
MOST_ADDED = 1.0

# How many placements are proposed at most.
MOST_PROPOSED = 12


def proposed(recorded: Sensitivity, information: Real) -> Iterator[tuple[int, Real]]:
    """Rows of the recording in the order in which they tell most, and what is known with them.

    Each is the one for which the volume of what the corrections can still be is least: the largest
    determinant of the information (D-optimal), one after the other. No row comes again: what its
    network errs there would count twice.

    Parameters
    ----------
    recorded : Sensitivity
    information : float array, shape (2 sensors, 2 sensors)
        Of the placements that there are.

    Yields
    ------
    int, float array
        From 0, and the information with it.
    """
    left = np.zeros(len(recorded.tells))
    while np.isfinite(left).any():
        covariance = recorded.unsure(information)
        more = np.einsum(
            "roi,ij,rpj->rop", recorded.tells, covariance, recorded.tells, optimize=True
        )
        _, gained = np.linalg.slogdet(np.eye(more.shape[1]) + more)
        # Rounded, so that of two that tell as much the first is taken on every machine.
        row = int((gained.round(6) + left).argmax())
        left[row] = -np.inf
        information = information + recorded.tells[row].T @ recorded.tells[row]
        yield row, information


def proposal(recorded: Sensitivity, information: Real, least: int = 1) -> list[tuple[int, float]]:
    """Rows until every output is determined, but at least so many, and what is then added."""
    found: list[tuple[int, float]] = []
    for row, known in proposed(recorded, information):
        found.append((row, float(recorded.added(recorded.unsure(known)).max())))
        if len(found) == MOST_PROPOSED or (len(found) >= least and found[-1][1] <= MOST_ADDED):
            break
    return found


def information_of(scene: Scene, recorded: Sensitivity, placements: Vectors) -> Real:
    """What known placements tell of the corrections."""
    tells = recorded.telling(scene, placements.inputs, placements.scale)
    flat = tells.reshape(-1, tells.shape[2])
    result: Real = flat.T @ flat
    return result


def placement(scene: Scene, row: int) -> str:
    """A row of the recording in words."""
    values = scene.in_units(scene.vectors().targets)[row]
    return ", ".join(f"{n} {v:g}" for n, v in zip(scene.outputs, values, strict=True))


def refuse_unsure(scene: Scene, recorded: Sensitivity, information: Real, count: int) -> None:
    """Refuse placements that leave the correction of a sensor open.

    Raises
    ------
    ValueError
        The message names the sensors and the placements to add.
    """
    covariance = recorded.unsure(information)
    added = recorded.added(covariance)
    if added.max() <= MOST_ADDED:
        return
    alone = recorded.added_by(covariance)
    blamed = [n for n, part in zip(scene.sensors, alone, strict=True) if part > MOST_ADDED]
    blamed = blamed or [scene.sensors[int(alone.argmax())]]
    output = scene.outputs[int(added.argmax())]
    raise ValueError(
        f"got {count} placements, which leave gain and offset of {_listed(blamed)} open: they would"
        f" add {added.max():.1f} times the scene's own error of {output}, expected at most "
        f"{MOST_ADDED:g}; add such as {_rows(scene, recorded, information)}"
    )


def _rows(scene: Scene, recorded: Sensitivity, information: Real) -> str:
    return "; ".join(placement(scene, row) for row, _ in proposal(recorded, information))


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names)
