"""The rows of a scene's recording, which are what a simulated board reads."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from golden.input_error import InputError
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from tactus.scene import Scene
from tactus.scene.disturbance import Disturbance
from tactus.scene.labels import one_hot
from tactus.scene.scale import signals
from tactus.scene.vectors import read_recorded


@dataclass(frozen=True)
class Drift:
    """How far the sensors of a simulated board have drifted since the recording.

    expected: Standard deviations of the gains, and of the offsets as signals.
    seed: Gains and offsets are drawn from it.
    """

    expected: Disturbance
    seed: int


def samples_of(scene: Scene, drift: Drift | None = None) -> Codes:
    """The codes of the sensors in every recorded row, shape (rows, sensors).

    drift: Without it the sensors are as they were in the recording.
    """
    found = signals(read_recorded(scene).sensors, scene.scales(scene.sensors))
    if drift:
        found = drift.expected.of(found, np.random.default_rng(drift.seed))
    return SIGNAL.quantise(found, "readings")[0]


def nearest_row(scene: Scene, targets: Mapping[str, str | float]) -> int:
    """The recorded row whose outputs are nearest to these; each counts in parts of its range.

    With classes it is the first row of the label that is given for their column.
    """
    if scene.labels and scene.classes in targets:
        label = str(targets[scene.classes])
        if label not in scene.labels:
            raise InputError(
                f"{scene.path}: data.classes: got no row of {label!r}, expected one of "
                f"{', '.join(scene.labels)}: a simulated board can only be touched as in its "
                "recording"
            )
        targets = dict(zip(scene.outputs, one_hot([label], scene.labels)[0].tolist(), strict=True))
    for name in targets:
        if name not in scene.outputs:
            raise InputError(
                f"{scene.path}: data.outputs: got no {name!r}, expected that of a placement: a "
                "simulated board can only be touched at placements of its recording"
            )
    recorded = read_recorded(scene).targets[:, [scene.outputs.index(name) for name in targets]]
    ranges = np.ptp(recorded, axis=0)
    asked = np.array([float(value) for value in targets.values()])
    far = (recorded - asked) / np.where(ranges > 0, ranges, 1.0)
    return int(np.argmin((far**2).sum(axis=1)))
