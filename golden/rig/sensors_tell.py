"""Estimates in a fraction of a second how much each sensor tells about each output.

A smooth map (``golden.rig.smooth_map``) from the sensors to the outputs is fitted to rows that
train, once with all sensors and once without each of them. Its errors are those on rows that take
no part. Similar maps to the sensor itself, from the outputs, and from these together with the other
sensors, show how much of it follows from anything. Networks have smaller errors;
``golden.rig.sensors_needed`` trains them, which takes minutes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from golden.finding import OK, WARNING, Finding
from golden.real import Real
from golden.rig.sensors_needed import Recording, recording_of
from golden.rig.smooth_map import SmoothMap, spread, thinned
from golden.scene import Scene
from golden.training.split import Split, split_of

Rows = NDArray[np.int64]

LENGTHS = (0.35, 0.7, 1.4, 2.8)
RIDGES = (1e-6, 1e-4, 1e-2)
# The most rows that train, and of each other part. More rows take longer and change little.
MOST_ROWS, MOST_OTHERS = 150, 75
# With fewer rows an error would mean nothing.
LEAST_OTHERS = 4
# With more sensors, such as the pixels of an image, the fits without each of them take minutes, and
# a single one tells little.
MOST_SENSORS = 32
# The sensors explain an output if its error is below this part of the error of a constant.
TOLD = 0.8
# A sensor counts as useless if a smaller part of it follows from everything else, and if without it
# the error of no explained output grows by this factor. Noise is like that. A sensor that corrects
# others, such as one for temperature, follows from no output, but it does follow from outputs and
# sensors together.
FOLLOWS, WORSE = 0.25, 2.0


@dataclass(frozen=True)
class Telling:
    """Mean errors on held-out rows, in percent as a scene counts them, shape (outputs,).

    Attributes
    ----------
    outputs : tuple of str
    constant : float array
        Errors of a constant, the mean of the rows that train, which needs no sensor.
    whole : float array
        Errors with all sensors.
    without : dict
        Errors without each sensor, by its name.
    follows : dict
        Part of the variance of each sensor, on held-out rows, that follows from the outputs, or
        from the outputs and the other sensors if that is more. It is below 0 where a constant fits
        better.
    """

    outputs: tuple[str, ...]
    constant: Real
    whole: Real
    without: dict[str, Real]
    follows: dict[str, float]

    @property
    def nothing(self) -> list[str]:
        """Sensors that tell nothing; see FOLLOWS."""
        explained = self.whole < TOLD * self.constant
        if not explained.any():
            return []
        return [
            name
            for name, errors in self.without.items()
            if self.follows[name] < FOLLOWS and (errors < WORSE * self.whole)[explained].all()
        ]


def measured(recording: Recording, split: Split) -> Telling:
    """Measure how much the sensors of a recording tell, with a split of its rows."""
    train = thinned(split.training, MOST_ROWS)
    others = [thinned(part, MOST_OTHERS) for part in (split.validation, split.test)]
    rows = np.concatenate(others)
    readings, targets = recording.readings, recording.targets

    def mean(residuals: Real) -> Real:
        percent: Real = 100 * np.abs(residuals / recording.scale[rows]).mean(axis=0)
        return percent

    constant = mean(targets[rows] - targets[train].mean(axis=0))
    without, follows = {}, {}
    for name in recording.names:
        own, others_kept = _of(recording, name)
        without[name] = (
            mean(_residuals(others_kept, targets, train, others))
            if others_kept.shape[1]
            else constant
        )
        follows[name] = max(
            _explained(known, own, train, others)
            for known in (targets, np.column_stack([targets, others_kept]))
        )
    whole = mean(_residuals(readings, targets, train, others))
    return Telling(recording.outputs, constant, whole, without, follows)


def _of(recording: Recording, name: str) -> tuple[Real, Real]:
    """The columns of a sensor, and all other columns."""
    own = np.isin(recording.sensors, [name])
    return recording.readings[:, own], recording.readings[:, ~own]


def _explained(known: Real, values: Real, train: Rows, others: list[Rows]) -> float:
    """The part of the variance of held-out values that is explained, in the best column."""
    rows = np.concatenate(others)
    variance = ((values[rows] - values[train].mean(axis=0)) ** 2).mean(axis=0)
    left = (_residuals(known, values, train, others) ** 2).mean(axis=0)
    return float((1 - left / np.where(variance > 0, variance, np.inf)).max())


def _residuals(inputs: Real, values: Real, train: Rows, others: list[Rows]) -> Real:
    """Residuals of two parts that took no part in the fit; each part selects the other's fit."""
    unit = spread(values[train])
    found = []
    for length in LENGTHS:
        for ridge in RIDGES:
            smooth = SmoothMap(inputs[train], values[train], length, ridge)
            found.append([smooth(inputs[part]) - values[part] for part in others])
    chosen = [min(found, key=lambda both: ((both[k] / unit) ** 2).mean()) for k in (0, 1)]
    return np.concatenate([chosen[1][0], chosen[0][1]])


def telling_of(scene: Scene) -> Telling | None:
    """Measure how much the sensors of a scene tell.

    It is None if there are too few rows or too many sensors.

    Raises
    ------
    InputError
        See ``split_of`` and ``Scene.vectors``.
    """
    split = split_of(scene)
    few = min(len(split.validation), len(split.test)) < LEAST_OTHERS
    if few or len(scene.sensors) > MOST_SENSORS:
        return None
    return measured(recording_of(scene), split)


def findings(scene: Scene) -> list[Finding]:
    """How much each sensor of a scene tells, in words; see ``telling_of``."""
    telling = telling_of(scene)
    if telling is None:
        return []
    subject, names = "what sensors tell", telling.outputs
    shown = ", ".join(f"{n} {c:.2g} %" for n, c in zip(names, telling.constant, strict=True))
    found = [
        Finding(
            OK,
            subject,
            "mean errors on rows that are held out from a fit, Gaussian kernel ridge regression; "
            f"without any sensor {shown}",
        )
    ]
    explained = telling.whole < TOLD * telling.constant
    if not explained.any():
        text = "nothing: with all of them no output errs less than without any"
        return [*found, Finding(WARNING, subject, text)]
    nothing = telling.nothing
    for name, errors in telling.without.items():
        text = ", ".join(
            f"{output} {without:.2g} % instead of {whole:.2g} %"
            for output, without, whole in zip(names, errors, telling.whole, strict=True)
        )
        text = f"without it {text}"
        if name in nothing:
            advice = f"tells nothing: it follows from nothing else; take it out of {_place(scene)}"
            found.append(Finding(WARNING, name, f"{advice} ({text})"))
        else:
            found.append(Finding(OK, name, text))
    return found


def _place(scene: Scene) -> str:
    return f"data.sensors in {scene.path}"
