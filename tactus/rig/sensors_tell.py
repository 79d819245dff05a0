"""Estimates in a fraction of a second how much each sensor tells about each output.

A smooth map (``tactus.rig.smooth_map``) from the sensors to the outputs is fitted to rows that
train, once with all sensors and once without each of them. Its errors are those on rows that take
no part. Sensors that are not missed one by one may be missed together, so these are left out at
once, too. What is said of a sensor has to hold for several splits of the rows and, where the
scene's networks are there, for these. Similar maps to the sensor itself, from the outputs, and from
these together with the other sensors, show how much of it follows from anything. Networks have
smaller errors.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from golden.input_error import InputError
from golden.numbers.real import Real
from tactus.core.finding import OK, WARNING, Finding, several
from tactus.rig.smooth_map import SmoothMap, spread, thinned
from tactus.scene import Scene
from tactus.scene.scale import readings
from tactus.train.split import Split, split_of

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
# the error of no explained output grows by this factor, or by this part of what the sensors
# explain. Noise is like that. A sensor that corrects others, such as one for temperature, follows
# from no output, but it does follow from outputs and sensors together.
FOLLOWS, WORSE, LOST = 0.1, 2.0, 0.05
# A sensor that tells nothing tells nothing with so many splits, of other seeds.
SPLITS = 3
# A network misses a sensor if without it the error of an output grows by more than this factor.
MISSED = 1.05


@dataclass(frozen=True)
class Recording:
    """The readings of the sensors and the outputs that belong to them.

    readings, shape (rows, columns): The readings in the unit of the sensors.
    targets, scale, shape (rows, outputs): The outputs, and the divisors of their errors.
    sensors: The sensor of each column; a sensor whose past is used has several columns.
    """

    readings: Real
    targets: Real
    scale: Real
    sensors: tuple[str, ...]
    outputs: tuple[str, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """All sensors, each of them once, in the order of the columns."""
        return tuple(dict.fromkeys(self.sensors))


@dataclass(frozen=True)
class Telling:
    """Mean errors on held-out rows, in percent as a scene counts them, shape (outputs,).

    constant: Errors of a constant, the mean of the rows that train, which needs no sensor.
    whole: Errors with all sensors.
    without: Errors without each sensor, by its name.
    follows: Part of the variance of each sensor, on held-out rows, that follows from the outputs,
        or from the outputs and the other sensors if that is more. It is below 0 where a constant
        fits better.
    missed: Sensors that tell something in another way, and are not in ``nothing``.
    together: The sensors of ``nothing`` that can be left out at once.
    without_together: Errors without all of these.
    """

    outputs: tuple[str, ...]
    constant: Real
    whole: Real
    without: dict[str, Real]
    follows: dict[str, float]
    together: tuple[str, ...]
    without_together: Real
    missed: Collection[str] = ()

    @property
    def nothing(self) -> list[str]:
        """Sensors that tell nothing, as far as each of them shows alone; see FOLLOWS."""
        return [
            name
            for name, errors in self.without.items()
            if name not in self.missed and self.follows[name] < FOLLOWS and self.harmless(errors)
        ]

    @property
    def explained(self) -> NDArray[np.bool_]:
        return self.whole < TOLD * self.constant

    def harmless(self, errors: Real) -> bool:
        """Whether errors without some sensors are no worse than with them; see WORSE and LOST."""
        most = np.minimum(WORSE * self.whole, self.whole + LOST * (self.constant - self.whole))
        return bool(self.explained.any() and (errors < most)[self.explained].all())


def recording_of(scene: Scene) -> Recording:
    """The recording of a scene, as the scene's own training reads it."""
    vectors = scene.vectors()
    return Recording(
        readings(vectors.inputs, scene.scales(scene.inputs)),
        vectors.targets,
        vectors.scale,
        tuple(scene.sensors[tap.sensor] for tap in scene.window.taps),
        scene.outputs,
    )


def measured(recording: Recording, split: Split, missed: Collection[str] = ()) -> Telling:
    """Measure how much the sensors of a recording tell; ``missed`` is as in ``Telling``."""
    train = thinned(split.training, MOST_ROWS)
    others = [thinned(part, MOST_OTHERS) for part in (split.validation, split.test)]
    rows = np.concatenate(others)
    targets = recording.targets

    def mean(residuals: Real) -> Real:
        return 100 * np.abs(residuals / recording.scale[rows]).mean(axis=0)

    constant = mean(targets[rows] - targets[train].mean(axis=0))

    def errors(left_out: Sequence[str]) -> Real:
        kept = _of(recording, left_out)[1]
        return mean(_residuals(kept, targets, train, others)) if kept.shape[1] else constant

    without, follows = {}, {}
    for name in recording.names:
        own, others_kept = _of(recording, [name])
        without[name] = errors([name])
        follows[name] = max(
            _explained(known, own, train, others)
            for known in (targets, np.column_stack([targets, others_kept]))
        )
    whole = errors([])
    found = Telling(recording.outputs, constant, whole, without, follows, (), whole, missed)
    # Those that are missed least come first.
    for name in sorted(found.nothing, key=lambda name: float((without[name] / whole).max())):
        more = (*found.together, name)
        left = errors(more)
        if found.harmless(left):
            found = replace(found, together=more, without_together=left)
    return found


def _of(recording: Recording, names: Sequence[str]) -> tuple[Real, Real]:
    """The columns of some sensors, and all other columns."""
    own = np.isin(recording.sensors, names)
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
    """
    split = split_of(scene)
    few = min(len(split.validation), len(split.test)) < LEAST_OTHERS
    if few or len(scene.sensors) > MOST_SENSORS:
        return None
    recording = recording_of(scene)
    found = measured(recording, split)
    if not found.nothing:
        return found
    nothing = set(found.nothing)
    for n in range(1, SPLITS):
        training = replace(scene.training, seed=scene.training.seed + n)
        other = split_of(replace(scene, training=training))
        nothing &= set(measured(recording, other).nothing)
    nothing -= missed_by_networks(scene, nothing)
    return measured(recording, split, set(recording.names) - nothing)


def missed_by_networks(scene: Scene, names: Collection[str]) -> set[str]:
    """Those of some sensors that the scene's networks miss if each reading is the mean of all."""
    try:
        scene.networks()
    except InputError:
        # They are not there yet, or do not fit.
        return set()
    vectors = scene.vectors()
    sensors = np.array([scene.sensors[tap.sensor] for tap in scene.window.taps])

    def errors(name: str) -> Real:
        inputs = np.where(sensors == name, vectors.inputs.mean(axis=0), vectors.inputs)
        return np.asarray(vectors.percent_errors(scene.process_real(inputs)).mean(axis=0))

    whole = errors("")
    return {name for name in names if (errors(name) > MISSED * whole).any()}


def findings(scene: Scene) -> list[Finding]:
    """How much each sensor of a scene tells, in words; see ``telling_of``."""
    telling = telling_of(scene)
    if telling is None:
        return []
    subject, names = "what sensors tell", telling.outputs
    shown = ", ".join(f"{n} {c:.2g} %" for n, c in zip(names, telling.constant, strict=True))
    fit = "mean errors on rows that are held out from a fit, Gaussian kernel ridge regression"
    found = [Finding(OK, subject, f"{fit}; without any sensor {shown}")]
    if not telling.explained.any():
        text = "nothing: with all of them no output errs less than without any"
        return [*found, Finding(WARNING, subject, text)]
    together = [name for name in telling.without if name in telling.together]
    for name, errors in telling.without.items():
        text = f"without it {_compared(telling, errors)}"
        if name in together:
            advice = "tells nothing: it follows from nothing else; take it out of data.sensors in"
            found.append(Finding(WARNING, name, f"{advice} {scene.path} ({text})"))
            continue
        found.append(Finding(OK, name, text))
    if len(together) > 1:
        compared = _compared(telling, telling.without_together)
        text = f"can be taken out together: without them {compared}"
        found.append(Finding(WARNING, several(together), text))
    return found


def _compared(telling: Telling, errors: Real) -> str:
    """The error of each output without some sensors, beside that with all of them."""
    return ", ".join(
        f"{output} {without:.2g} % instead of {whole:.2g} %"
        for output, without, whole in zip(telling.outputs, errors, telling.whole, strict=True)
    )
