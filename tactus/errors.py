"""Errors of a scene's networks on its recorded vectors, and their decisions between classes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from tactus.network_files.network_file import read_provenance
from tactus.scene import Scene
from tactus.scene.disturbance import Disturbance
from tactus.scene.labels import decided, margins
from tactus.scene.scale import readings
from tactus.train.split import split_of, split_story

HELD_OUT = "bit-true, held out"

# The text if nobody can know which rows a network has not seen.
UNKNOWN = "unknown: not trained here"

# The split of a provenance that does not mention any, since there was no other kind at the time.
BEFORE_SPLITS = {"split": "random", "split_by": "", "block_rows": 0, "window": ""}

# With 50,000 frames the mean error differs by one per cent from one seed to another.
FRAMES = 50_000
SEED = 1

# Errors are also stated with this noise, as a part of the full scale: 2 mV of a volt.
NOISE = 0.002


@dataclass(frozen=True)
class OutputError:
    """Error of one output over a set of frames, in percent or, see ``millimetres``, as lengths.

    mean: Mean error over all frames.
    largest_mean: Largest of the mean errors at each position (equation 3.15), which is the thesis'
        "better than" figure.
    worst: Largest error of a single frame.
    """

    mean: float
    largest_mean: float
    worst: float


def summarise(errors: Real, groups: ArrayLike) -> list[OutputError]:
    """A summary for each column of ``errors``, with means over each value of ``groups``."""
    places = np.asarray(groups)
    means = np.array([errors[places == place].mean(axis=0) for place in np.unique(places)])
    return [
        OutputError(float(errors[:, c].mean()), float(means[:, c].max()), float(errors[:, c].max()))
        for c in range(errors.shape[1])
    ]


def millimetres(error: OutputError, length: float) -> OutputError:
    """An error in percent of a full scale as a length; the full scale is ``length`` millimetres.

    ``golden/visualisation/load_profile.py`` holds the lengths of the flexible digit.
    """
    part = length / 100
    return OutputError(error.mean * part, error.largest_mean * part, error.worst * part)


def provenances(scene: Scene) -> list[dict[str, Any]] | None:
    """The provenance of each network of the scene.

    It is None if a network came from elsewhere, or was trained on other data or with another split.
    """
    expected = {"window": ""} | split_story(scene)
    stories = []
    for member, network in zip(scene.members, scene.networks(), strict=True):
        read = read_provenance(member.weights_path)
        if read is None:
            return None
        story = BEFORE_SPLITS | read
        shape = ":".join(str(n) for n in network.shape)
        story.setdefault("rows", expected["rows"])
        if any(story.get(key) != value for key, value in (expected | {"network": shape}).items()):
            return None
        stories.append(story)
    return stories


def held_out_rows(scene: Scene) -> NDArray[np.int64] | None:
    """Rows that neither trained nor chose any network of the scene.

    None if that is unknown, see ``provenances``, or if a network was trained further on all rows.
    """
    stories = provenances(scene)
    if stories is None or any(story.get("refit") for story in stories):
        return None
    return split_of(scene).test


def held_out_means(scene: Scene) -> list[float] | None:
    """Mean error of each output, in percent, on rows that the networks have not seen.

    For networks that were trained further on all rows, it comes from their provenance, and is the
    error of networks trained without these rows. None if it is unknown, see ``provenances``.
    """
    found = scene_errors(scene).get(HELD_OUT)
    if found is not None:
        return [error.mean for error in found]
    return trained_means(scene, "test_mean_percent")


def trained_means(scene: Scene, key: str) -> list[float] | None:
    """Mean error of each output, in percent, as training measured it under a key of the provenance.

    None if it is unknown, see ``provenances``.
    """
    means: dict[str, float] = {}
    for story in provenances(scene) or []:
        means |= story.get(key, {})
    return [means[name] for name in scene.outputs] if means.keys() >= set(scene.outputs) else None


def held_out_text(scene: Scene) -> str:
    means = held_out_means(scene)
    if means is None:
        return UNKNOWN
    settings = scene.training
    columns = " and ".join(settings.split_by)
    how = {
        "random": "drawn at random",
        "blocks": f"in stretches of about {settings.block_rows} rows"
        + (f" with the same {columns}" if columns else ""),
        "groups": f"all that have the same {columns} together",
    }[settings.split]
    rows = held_out_rows(scene)
    if rows is not None:
        return f"{len(rows)} that neither trained nor chose the network, {how}"
    shown = ", ".join(f"{name} {m:.2f}" for name, m in zip(scene.outputs, means, strict=True))
    return (
        "none any more, since the networks were trained further on all rows; before, the mean on "
        f"{len(split_of(scene).test)} that they had not seen, {how}, was {shown}"
    )


def scene_errors(scene: Scene) -> dict[str, list[OutputError]]:
    """Errors on the recorded vectors, by the kind of arithmetic and of rows.

    They are in real arithmetic, bit-true, and, if these rows are known, bit-true on rows that
    neither trained nor chose the network.
    """
    vectors = scene.vectors()
    real = scene.process_real(vectors.inputs)
    bit_true = SIGNAL.to_real(scene.twin().core.process(vectors.codes))
    everything = np.arange(len(vectors.codes))
    kinds = [("float", real, everything), ("bit-true", bit_true, everything)]
    held_out = held_out_rows(scene)
    if held_out is not None:
        kinds.append((HELD_OUT, bit_true, held_out))
    return {
        name: summarise(vectors.percent_errors(results)[rows], vectors.groups[rows])
        for name, results, rows in kinds
    }


def unit_errors(scene: Scene) -> dict[str, OutputError]:
    """Bit-true errors on the recorded vectors by output, in the output's unit.

    Only outputs that have a scale or a unit are included.
    """
    vectors = scene.vectors()
    results = scene.outputs_in_units(scene.twin().core.process(vectors.codes))
    found = summarise(np.abs(results - scene.in_units(vectors.targets)), vectors.groups)
    named = scene.scale.keys() | scene.units.keys()
    return {name: error for name, error in zip(scene.outputs, found, strict=True) if name in named}


def full_scale_of(scene: Scene) -> float:
    """The difference of readings for full scale, in two digits.

    It is the median over the sensors, in the unit of the readings, and 1 if they have no scale.
    """
    return float(f"{np.median([scale.factor for scale in scene.scales(scene.sensors)]):.1e}")


def noises_of(scene: Scene) -> list[float]:
    """The noises for which a scene's errors are stated, in the unit of the readings.

    They are the noise that the scene declares, if it does, and ``NOISE``.
    """
    usual = float(f"{NOISE * full_scale_of(scene):.6g}")
    return sorted({scene.training.disturbance.noise or usual, usual})


def disturbed_errors(scene: Scene, disturbance: Disturbance, seed: int = SEED) -> list[float]:
    """Bit-true mean error of each output, in percent, on disturbed readings of all rows."""
    errors = disturbed_rows(scene, disturbance, seed).mean(axis=0)
    return [float(error) for error in errors]


def disturbed_rows(scene: Scene, disturbance: Disturbance, seed: int = SEED) -> Real:
    """Bit-true errors in percent, shape (rows, outputs), each the mean over random draws.

    All rows are disturbed so many times that there are ``FRAMES`` or more. Each row counts as a
    recording of its own, with its own drift for each sensor. The mean is that of whole recordings,
    and becomes stable with far fewer of them.
    """
    vectors = scene.vectors()
    draws = 1 if disturbance.none else -(-FRAMES // len(vectors.inputs))
    # Noise and drift act on readings in their unit, before they become codes.
    many = np.tile(readings(vectors.inputs, scene.scales(scene.inputs)), (draws, 1))
    own = [tap.sensor for tap in scene.window.taps]
    sensors = np.add.outer(len(scene.sensors) * np.arange(len(many)), own).ravel()
    disturbed = disturbance.of(many.reshape(1, -1), np.random.default_rng(seed), sensors)
    codes = scene.codes_of(disturbed.reshape(many.shape))
    results = SIGNAL.to_real(scene.twin().core.process(codes)).reshape(
        draws, *vectors.targets.shape
    )
    rows: Real = vectors.percent_errors(results).mean(axis=0)
    return rows


Numbers = NDArray[np.int64]


@dataclass(frozen=True)
class Decisions:
    """The classes of recorded rows, as numbers of labels.

    actual, real, bit_true, shape (rows,): The recorded class, that of the network in floating
        point, and that of the hardware.
    margins, shape (rows,): By how many codes the largest output of the hardware exceeds the second
        largest.
    """

    labels: tuple[str, ...]
    actual: Numbers
    real: Numbers
    bit_true: Numbers
    margins: Codes

    def take(self, rows: Numbers) -> Decisions:
        parts = (self.actual, self.real, self.bit_true, self.margins)
        return Decisions(self.labels, *(part[rows] for part in parts))

    @property
    def right(self) -> int:
        return int((self.bit_true == self.actual).sum())

    @property
    def right_real(self) -> int:
        """The number of rows that the network in floating point decides rightly."""
        return int((self.real == self.actual).sum())

    @property
    def differ(self) -> int:
        """The number of rows that hardware and floating point decide differently."""
        return int((self.bit_true != self.real).sum())

    @property
    def confusion(self) -> Numbers:
        """The number of rows of each actual class (down) for each class decided (across)."""
        found = np.zeros((len(self.labels), len(self.labels)), dtype=np.int64)
        np.add.at(found, (self.actual, self.bit_true), 1)
        return found

    @property
    def text(self) -> str:
        rows = len(self.actual)
        return (
            f"{self.right} of {rows} right, {percent(self.right, rows)}; in floating point "
            f"{self.right_real}, {percent(self.right_real, rows)}; {self.differ} decided "
            "differently"
        )


def percent(part: int, of: int) -> str:
    return f"{100 * part / of:.1f} %" if of else "no rows"


def decisions_of(scene: Scene) -> Decisions:
    """The decisions on all recorded rows of a scene with classes."""
    vectors = scene.vectors()
    codes = scene.twin().core.process(vectors.codes)
    return Decisions(
        scene.labels,
        decided(vectors.targets),
        decided(scene.process_real(vectors.inputs)),
        decided(codes),
        margins(codes),
    )


def held_out_or_all(scene: Scene, every: Decisions) -> tuple[Decisions, str]:
    """The decisions on held-out rows, or on all rows if none are known to be held out.

    The text says which rows these are.
    """
    held = held_out_rows(scene)
    if held is not None:
        return every.take(held), f"{len(held)} held-out rows"
    return every, f"all {len(every.actual)} rows"


def held_out_before(scene: Scene) -> str:
    """What is known of the decisions of a scene without held-out rows on rows held out before."""
    stories = provenances(scene)
    if stories is None:
        return UNKNOWN
    wrong = stories[0].get("test_wrong_percent")
    if wrong is None:
        return "unknown"
    right = f"before, {100 - wrong:.1f} % were right"
    return f"none any more, the network was trained on with all; {right}"
