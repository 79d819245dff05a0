"""The recorded vectors of a scene."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from golden.fixed import Codes
from golden.precision import SIGNAL
from golden.table import read_table, rows_where

if TYPE_CHECKING:
    from golden.scene.scene import Scene


@dataclass(frozen=True)
class Vectors:
    """Recorded vectors: real inputs, targets, positions, and the inputs as codes.

    ``saturated`` counts inputs outside [-1, 1) that were replaced by the nearest code.
    """

    inputs: NDArray[np.float64]
    targets: NDArray[np.float64]
    groups: NDArray[np.float64]
    codes: Codes
    saturated: int


def read_vectors(scene: Scene) -> Vectors:
    """The recorded vectors of a scene, quantised.

    Raises
    ------
    FileNotFoundError, ValueError
        See ``read_table`` and ``rows_where``; also for a target outside -1 to 1, or a target of 0
        where the error is relative to the target.
    """
    columns = [*scene.sensors, *scene.outputs] + ([scene.group_by] if scene.group_by else [])
    kept = rows_where(scene.data_path, scene.where)
    table = read_table(scene.data_path, columns)[kept]
    inputs = table[:, : len(scene.sensors)]
    last = len(scene.sensors) + len(scene.outputs)
    targets = table[:, len(scene.sensors) : last]
    groups = table[:, -1] if scene.group_by else np.zeros(len(table))
    beyond = np.argwhere(np.abs(targets) > 1)
    if len(beyond):
        row, c = beyond[0]
        raise ValueError(
            f"{scene.data_path}: column {scene.outputs[c]!r}: got a target of {targets[row, c]:g}"
            f" in row {kept[row] + 1}, expected -1 to 1, the range of {SIGNAL}"
        )
    for c, name in enumerate(scene.outputs):
        if name not in scene.full_scale and (targets[:, c] == 0).any():
            raise ValueError(
                f"{scene.data_path}: column {name!r} holds a target of 0, whose relative error "
                f"is not defined; give {name} a full_scale in {scene.path}"
            )
    codes, saturated = SIGNAL.quantise(inputs, f"{scene.data_path} sensors")
    return Vectors(inputs, targets, groups, codes, saturated)
