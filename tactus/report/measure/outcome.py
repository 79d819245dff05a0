"""The results of a scene's networks on its recorded rows, and how sure the errors are."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from tactus.core.table import read_groups
from tactus.errors import (
    FRAMES,
    Decisions,
    decisions_of,
    disturbed_errors,
    disturbed_rows,
    full_scale_of,
    held_out_before,
    held_out_or_all,
    held_out_rows,
    noises_of,
)
from tactus.report.measure.table import Cell, Row, Table
from tactus.rig.sensors_tell import telling_of
from tactus.scene import Scene
from tactus.scene.disturbance import Disturbance
from tactus.scene.scale import signals
from tactus.scene.vectors import place_names, read_recorded

# For each field of ``Disturbance``: its name for a reader, and its sizes. Those of noise and offset
# are parts of the full scale of a reading.
KINDS: dict[str, tuple[str, tuple[float, ...]]] = {
    "noise": ("noise", (0.0005, 0.001, 0.002, 0.004, 0.008)),
    "gain": ("gain drift", (0.002, 0.005, 0.01, 0.02, 0.03)),
    "offset": ("offset drift", (0.001, 0.002, 0.005, 0.01, 0.02)),
}
NONE = "as recorded"
MEANING = (
    "The figures are bit-true mean errors in percent on all recorded rows, with disturbed "
    "readings. Sizes are standard deviations. Those of noise and offsets are in the unit of the "
    "readings, so that 0.001 is 1 mV of a volt; those of gains are a part of the reading. Noise "
    "differs from reading to reading, and the drift of gain or offset from sensor to sensor. All "
    f"rows are drawn repeatedly, until there are {FRAMES:,} frames or more, each with a drift of "
    "its own."
)


def disturbances(full_scale: float) -> Iterator[tuple[str, float, Disturbance]]:
    """Every kind and size of disturbance for a full scale, beginning with none."""
    yield NONE, 0.0, Disturbance()
    for key, (kind, parts) in KINDS.items():
        for part in parts:
            size = part if key == "gain" else float(f"{part * full_scale:.6g}")
            yield kind, size, Disturbance(**{key: size})


def noise_and_drift(scene: Scene, seed: int) -> Table:
    """The table of one scene, with a row for each disturbance and a column for each output."""
    columns = ["disturbance", "size", *(f"{name} %" for name in scene.outputs)]
    rows: list[list[Cell]] = [
        [kind, size, *disturbed_errors(scene, disturbance, seed)]
        for kind, size, disturbance in disturbances(full_scale_of(scene))
    ]
    return Table("noise_and_drift", columns, rows, MEANING)


Rows = NDArray[np.int64]

WORST = 5  # rows shown of every output
RESAMPLES, SEED = 2000, 1
SURE = 95  # per cent of the resamples that an interval holds
RANGE = SIGNAL.to_real([SIGNAL.low, SIGNAL.high])
# Neighbours in the file are alike if their squared difference is less than this part of that of
# rows in random order. Then at most so many stretches of rows are drawn instead of single rows.
ALIKE, STRETCHES = 0.5, 20


@dataclass(frozen=True)
class Outcome:
    """The recorded rows of a scene and their results.

    numbers, shape (rows,): The numbers of the rows in the CSV. The first row below the header is 1.
    readings, shape (rows, sensors): The readings in the units of the columns. With past samples,
        those of the newest frame.
    targets, results, shape (rows, outputs): The recorded and the computed values, in the units of
        the columns.
    errors, real, shape (rows, outputs): The errors in percent, of the hardware and of the networks
        in floating point.
    noisy, shape (rows, outputs): For each noise, the errors of the hardware, as means over many
        draws.
    groups, shape (rows,): The positions, or zeros if the scene names none.
    held_out: The rows that neither trained nor chose a network, or None if that is unknown.
    names: The texts of positions, if they are texts.
    """

    scene: Scene
    numbers: Rows
    readings: Real
    targets: Real
    results: Real
    errors: Real
    real: Real
    noisy: dict[float, Real]
    groups: Real
    held_out: Rows | None
    names: Mapping[float, str] = field(default_factory=dict)

    @cached_property
    def decisions(self) -> Decisions:
        return decisions_of(self.scene)

    @property
    def alike(self) -> bool:
        """Whether neighbours in the file are more alike than rows in random order."""
        moving = self.readings[:, np.ptp(self.readings, axis=0) > 0]
        if not moving.size:
            return False
        steps = (np.diff(moving, axis=0) ** 2).mean(axis=0)
        return bool((steps / (2 * moving.var(axis=0))).mean() < ALIKE)

    @property
    def stretches(self) -> Rows:
        """For each row the number under which it is drawn: its own, or that of its stretch."""
        rows = np.arange(len(self.errors))
        return rows * min(STRETCHES, len(rows)) // len(rows) if self.alike else rows

    @property
    def held_together(self) -> Rows:
        """For each held-out row the number of what was held out as a whole, and is drawn so."""
        assert self.held_out is not None
        scene, held = self.scene, self.held_out
        if scene.training.split == "random":
            return self.stretches[held]
        if scene.training.split == "blocks":
            return np.cumsum(np.append(False, np.diff(held) != 1))
        past = scene.window.past
        columns = [
            read_groups(one.path, scene.training.split_by)[one.numbers[past:]]
            for one in read_recorded(scene).recordings
        ]
        _, member = np.unique(np.concatenate(columns)[held], axis=0, return_inverse=True)
        return member.ravel()

    def place(self, group: float) -> float | str:
        """A position as the column of the scene has it, a number or a text."""
        return self.names.get(float(group), float(group))

    def interval(self, errors: Real, drawn: Rows) -> tuple[float, float]:
        """The interval that holds the mean error in ``SURE`` per cent of the resamples.

        errors: shape (n,).
        drawn, shape (n,): Errors with the same number are drawn together.
        """
        _, member = np.unique(drawn, return_inverse=True)
        counts = np.bincount(member)
        sums = np.bincount(member, errors)
        chosen = np.random.default_rng(SEED).integers(0, len(counts), (RESAMPLES, len(counts)))
        means = sums[chosen].sum(axis=1) / counts[chosen].sum(axis=1)
        low, high = np.percentile(means, [(100 - SURE) / 2, (100 + SURE) / 2])
        return float(low), float(high)


def outcome(scene: Scene) -> Outcome:
    recorded, vectors = read_recorded(scene), scene.vectors()
    codes = scene.twin().core.process(vectors.codes)
    return Outcome(
        scene,
        recorded.numbers + 1,
        recorded.sensors,
        recorded.targets,
        scene.outputs_in_units(codes),
        vectors.percent_errors(SIGNAL.to_real(codes)),
        vectors.percent_errors(scene.process_real(vectors.inputs)),
        {noise: disturbed_rows(scene, Disturbance(noise)) for noise in noises_of(scene)},
        recorded.groups,
        held_out_rows(scene),
        place_names(scene),
    )


def worst_rows(found: Outcome) -> Table:
    """The rows with the largest errors of each output, with their readings and results."""
    scene = found.scene
    beside = [scene.group_by] if scene.group_by not in ("", *scene.outputs) else []
    rows: list[list[Cell]] = []
    for c, output in enumerate(scene.outputs):
        # Of rows with equal errors, the first one counts.
        for row in np.argsort(-found.errors[:, c], kind="stable")[:WORST]:
            place = [found.place(found.groups[row])] * len(beside)
            pair = (found.targets[row, c], found.results[row, c], found.errors[row, c])
            readings = map(float, found.readings[row])
            rows.append([output, int(found.numbers[row]), *readings, *place, *map(float, pair)])
    files = [path.name for path in scene.data_paths]
    return Table(
        "worst_rows",
        ["output", "row", *scene.sensors, *beside, "recorded", "computed", "error %"],
        rows,
        f"These are the {WORST} rows with the largest bit-true errors of each output, with their "
        f"readings. Row 1 of {' and of '.join(files)} is the first row below the header.",
    )


def along(found: Outcome) -> Table:
    scene = found.scene
    rows: list[list[Cell]] = []
    for place in np.unique(found.groups):
        here = found.errors[found.groups == place]
        rows.append([found.place(place), len(here), *map(float, here.mean(axis=0))])
    return Table(
        "along",
        [scene.group_by, "rows", *(f"{name} %" for name in scene.outputs)],
        rows,
        f"The figures are bit-true mean errors of the rows at each {scene.group_by}.",
    )


def confidence(found: Outcome) -> Table:
    """The errors of each output, with the confidence intervals of a bootstrap."""
    scene, stretches = found.scene, found.stretches
    rows: list[list[Cell]] = []

    def add(output: str, figure: str, errors: Real, drawn: Rows) -> None:
        # Of a single group or stretch nothing can be drawn.
        interval = found.interval(errors, drawn) if np.ptp(drawn) else (None, None)
        rows.append([output, figure, len(errors), float(errors.mean()), *interval])

    for c, output in enumerate(scene.outputs):
        errors = found.errors[:, c]
        add(output, "mean", errors, stretches)
        for noise, noisy in found.noisy.items():
            add(output, f"mean, noise {noise:g}", noisy[:, c], stretches)
        add(output, "mean, floating point", found.real[:, c], stretches)
        if found.held_out is not None:
            held = found.held_out
            add(output, "mean, held out", errors[held], found.held_together)
        if scene.group_by:
            places = np.unique(found.groups)
            means = [errors[found.groups == place].mean() for place in places]
            place = places[int(np.argmax(means))]
            there = np.flatnonzero(found.groups == place)
            name = found.place(place)
            name = name if isinstance(name, str) else f"{name:g}"
            add(output, f"largest mean, {scene.group_by} {name}", errors[there], there)
    unit = (
        f"stretches of rows, {stretches.max() + 1} in all, as neighbours in the file are alike"
        if found.alike
        else "rows"
    )
    split = scene.training.split
    if found.held_out is not None and split != "random":
        whole = f"groups of equal {', '.join(scene.training.split_by)}"
        whole = whole if split == "groups" else "stretches"
        unit += f", of held-out rows whole {whole}, {len(np.unique(found.held_together))} in all"
    return Table(
        "confidence",
        ["output", "figure", "rows", "%", "from", "to"],
        rows,
        "The errors are in percent, and bit-true unless stated otherwise. Each has the interval "
        f"that holds it in {SURE} % of {RESAMPLES} resamples (bootstrap, seed {SEED}). The "
        f"resamples draw {unit}, and at one position single rows. The interval shows the effect of "
        "chance in these rows, but not that of other loads or other sensors. For a worst row it "
        f"shows nothing, because no draw exceeds it.",
    )


def sensors(found: Outcome) -> Table:
    """The range of the readings of every sensor, and how many lie outside that of the codes."""
    rows: list[Row] = []
    scales = found.scene.scales(found.scene.sensors)
    for name, scale, column in zip(found.scene.sensors, scales, found.readings.T, strict=True):
        low, high = float(column.min()), float(column.max())
        _, outside = SIGNAL.quantise(signals(column[:, np.newaxis], [scale]))
        first, last = (float(scale.offset + scale.factor * end) for end in RANGE)
        ends = int(((column == low) | (column == high)).sum())
        rows.append(
            {
                "sensor": name,
                "least": low,
                "largest": high,
                "first code": first,
                "last code": last,
                "readings outside": outside,
                "% outside": 100 * outside / len(column),
                "at either end": ends,
            }
        )
    return Table.of(
        "sensors",
        rows,
        "Readings beyond the first or the last code are replaced by the nearest code. If many "
        "readings are the least or the largest one, the sensor was probably saturated before it "
        "was recorded.",
    )


def telling(scene: Scene) -> Table | None:
    """The errors with all sensors, without each and without any, or None for too few rows."""
    found = telling_of(scene)
    if found is None:
        return None
    rows: list[list[Cell]] = [["none", None, *map(float, found.whole)]]
    for name, errors in found.without.items():
        rows.append([name, 100 * found.follows[name], *map(float, errors)])
    rows.append(["all", None, *map(float, found.constant)])
    nothing = ", ".join(found.together)
    drop = f" {nothing}: tells nothing, take it out of data.sensors." if nothing else ""
    return Table(
        "sensors_tell",
        ["left out", "follows %", *(f"{name} %" for name in found.outputs)],
        rows,
        "The figures are mean errors, by the measure of the scene, of a smooth map from the "
        "sensors to the outputs (Gaussian kernel ridge regression). The map is fitted again "
        "without each sensor, and measured on rows held out from the fit. Without all sensors it "
        "is a constant. Networks have smaller errors; only training shows what a network loses "
        "without a sensor. 'follows' is the part of a sensor's variance that is explained by the "
        f"outputs, or by the outputs and the other sensors. For noise it is about 0 or less.{drop}",
    )


# So many rows are shown that are decided wrongly, those with the largest margins.
WRONG = 20


def accuracy(found: Outcome) -> Table:
    """The part of the rows that is decided rightly, on all rows and on those held out."""
    every = found.decisions
    kinds = {"all rows": every}
    if found.held_out is not None:
        kinds["held-out rows"] = every.take(found.held_out)
    before = "" if found.held_out is not None else f" Held out: {held_out_before(found.scene)}."
    rows: list[list[Cell]] = []
    for name, some in kinds.items():
        count = len(some.actual)
        parts = [100 * n / count for n in (some.right, some.right_real)]
        rows.append([name, count, *parts, some.differ])
    return Table(
        "accuracy",
        ["rows", "number", "right %", "right in floating point %", "decided differently"],
        rows,
        "The decision is the class of the largest output, the first one of equal outputs. 'Right' "
        "is bit-true, as the hardware decides. The last column has the number of rows that "
        f"hardware and floating point decide differently.{before}",
    )


def per_class(found: Outcome) -> Table:
    """How many rows of each class are decided rightly, and how often each decision is right."""
    some, which = held_out_or_all(found.scene, found.decisions)
    counts = some.confusion
    rows: list[list[Cell]] = []
    for n, label in enumerate(some.labels):
        right, there, said = int(counts[n, n]), int(counts[n].sum()), int(counts[:, n].sum())
        parts: list[Cell] = [100 * right / of if of else None for of in (there, said)]
        others = counts[n].copy()
        others[n] = 0
        taken = some.labels[int(others.argmax())] if others.any() else ""
        rows.append([label, there, right, parts[0], said, parts[1], taken])
    return Table(
        "per_class",
        ["class", "rows", "right", "right %", "decided", "of these right %", "else mostly"],
        rows,
        f"Bit-true decisions on {which}. 'Decided' is the number of rows of which the hardware "
        "says that they are of the class.",
    )


def wrong_rows(found: Outcome) -> Table:
    """The rows that are decided wrongly, those of the largest margin first."""
    some = found.decisions
    wrong = np.flatnonzero(some.bit_true != some.actual)
    held = set() if found.held_out is None else set(found.held_out.tolist())
    rows: list[list[Cell]] = []
    for row in wrong[np.argsort(-some.margins[wrong], kind="stable")][:WRONG]:
        labels = (some.labels[some.actual[row]], some.labels[some.bit_true[row]])
        real = some.labels[some.real[row]]
        seen = "held out" if int(row) in held else ""
        rows.append([int(found.numbers[row]), *labels, real, int(some.margins[row]), seen])
    files = " and of ".join(path.name for path in found.scene.data_paths)
    return Table(
        "wrong_rows",
        ["row", "recorded", "decided", "in floating point", "margin", ""],
        rows,
        f"{len(wrong)} of {len(some.actual)} rows are decided wrongly; those with the largest "
        f"margins, {WRONG} at most. The margin is the difference of the two largest outputs in "
        f"codes. Row 1 of {files} is the first below its header.",
    )
