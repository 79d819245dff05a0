"""How many invalid readings ``make predict`` calls outside, at how many false alarms.

There are three rigs: the recorded digit, the rail of the tutorial, and a bar whose sensors give the
counts of a converter of 12 bits. Their readings are spoilt in all the ways that occur on a rig. The
distance that ``tactus.rig.trained_on`` gives them is compared with two simpler distances.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from golden.numbers.real import Real
from tactus.core.fingerprint import ROOT
from tactus.core.table import read_csv_file, read_table, write_table
from tactus.network_files.network_file import write_network
from tactus.physics.beam import Beam
from tactus.physics.digit_data import RECORDED, SENSORS
from tactus.physics.strain_sensor import COLUMNS, fit_sensors, loads_from_codes, read_sensors
from tactus.report.measure.honest import trained
from tactus.report.measure.table import Cell, Table
from tactus.rig.survey import survey
from tactus.rig.trained_on import TrainedOn, code_steps, hardware_outputs, learnt
from tactus.rig.write_scene import write_scene
from tactus.scene import Scene, load_scene
from tactus.scene.vectors import read_recorded
from tactus.train.descent.scaling import scaled
from tactus.train.descent.split import split_of

Rows = NDArray[np.int64]
Read = Callable[[Real, np.random.Generator], Real]

FRAMES = 2000
# New touches of the digit do not exist, so several splits of its recording take their place.
SPLITS = 4
FALSE_ALARMS = (0.005, 0.01, 0.02, 0.05)
AT = 0.01
NEAREST, WHITENED, STATE = "nearest row", "nearest, whitened", "state"
METHODS = (NEAREST, WHITENED, STATE)
OUTSIDE = "half a range outside"
DIGIT_NOISE = 0.001  # V

RAIL, BAR = ROOT / "docs" / "tutorial" / "rig.toml", "bar"
FORCE, PLACE = (0.2, 0.8), (0.1, 0.9)
BAR_FORCE, BAR_PLACE = (5.0, 40.0), (11.0, 289.0)  # N, mm
BAR_ROWS = 300

NOTES = {
    "outside": "The figures are percentages of the frames of each kind that are marked as outside. "
    "The columns from 0.5 % to 5 % use the limit at which so many percent of the good frames are "
    "marked too. They use the distance of the readings from those that the outputs explain. Two "
    f"simpler distances are shown at {100 * AT:g} %: the distance from the nearest training row, "
    "with each sensor divided by its standard deviation, and the same whitened by the covariance "
    "of these rows. With every distance, an output that exceeds its range by more than a tenth of "
    "the range is outside. The last column is what make predict does; for good frames it is the "
    "rate of false alarms. The rows of digit are recorded rows that neither train nor set the "
    f"limit, with 1 mV of noise, over {SPLITS} splits. Those of tutorial and bar are new touches "
    "of the rail and of a bar on five pads, read by a 12-bit converter. In 'half a range outside' "
    "one output is beyond its range by half to three quarters of it; for digit this is the load. "
    "Every pair of columns is swapped, and every sensor is dead or drifts, one at a time.",
}


@dataclass(frozen=True)
class Spoilt:
    """Frames of one kind, and the distance that each method gives them.

    kind: What is wrong with the frames, or ``""`` for good frames.
    beyond, shape (frames,): Which frames have an output beyond its range and margin.
    distances, shape (frames,): The distances by method. For STATE, a distance above 1 is outside.
    """

    kind: str
    beyond: NDArray[np.bool_]
    distances: dict[str, Real]

    def seen(self, method: str, limit: float) -> float:
        """The part of the frames that a method calls outside at a limit."""
        return float(np.mean(self.beyond | (self.distances[method] > limit)))


def rail(touches: Real, rng: np.random.Generator) -> Real:
    """The readings of the five sensors of the tutorial's rail, for forces and places."""
    at = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
    plain = touches[:, :1] * np.exp(-(((touches[:, 1:] - at) / 0.3) ** 2))
    found: Real = (plain + rng.normal(0, 0.002, plain.shape)).round(4)
    return found


def bar(touches: Real, rng: np.random.Generator) -> Real:
    """The counts of five pads under a bar, one of which saturates, with noise of two counts."""
    at = np.array([45.0, 97.5, 150.0, 202.5, 255.0])
    force = touches[:, :1] * np.exp(-(((touches[:, 1:] - at) / 60) ** 2) / 2)
    counts = 150 + 3700 * (1 - np.exp(-force / 30)) + rng.normal(0, 2, force.shape)
    found: Real = counts.round().clip(0, 4095)
    return found


def touches_within(
    force: tuple[float, float], place: tuple[float, float], count: int, rng: np.random.Generator
) -> Real:
    """Forces and places drawn evenly from their ranges."""
    return np.column_stack([rng.uniform(*force, count), rng.uniform(*place, count)])


def touches_beyond(
    force: tuple[float, float], place: tuple[float, float], count: int, rng: np.random.Generator
) -> Real:
    """Touches in which the force or the place lies outside, by a half to three quarters of its
    range.

    The force lies above its range, and the place below or above.
    """
    touches = touches_within(force, place, count, rng)
    far = rng.uniform(0.5, 0.75, count)
    which = np.arange(count) % 3
    touches[:, 0] = np.where(which == 0, force[1] + far * np.ptp(force), touches[:, 0])
    touches[:, 1] = np.where(which == 1, place[0] - far * np.ptp(place), touches[:, 1])
    touches[:, 1] = np.where(which == 2, place[1] + far * np.ptp(place), touches[:, 1])
    return touches


def spoilings(plain: Real, least: Real, largest: Real, rng: np.random.Generator) -> dict[str, Real]:
    """Readings with one fault in each, by kind of fault, for all sensors and pairs in turn."""
    found: dict[str, list[Real]] = {}

    def add(kind: str, columns: dict[int, Real]) -> None:
        changed = plain.copy()
        for c, column in columns.items():
            changed[:, c] = column
        found.setdefault(kind, []).append(changed)

    for a, b in combinations(range(plain.shape[1]), 2):
        add("columns swapped", {a: plain[:, b], b: plain[:, a]})
    for c, (low, high) in enumerate(zip(least, largest, strict=True)):
        add("dead, at its least", {c: np.full(len(plain), low)})
        add("dead, in the middle", {c: np.full(len(plain), (low + high) / 2)})
        add("dead, noise", {c: rng.uniform(low, high, len(plain))})
        add("gain 5 % more", {c: low + 1.05 * (plain[:, c] - low)})
        add("offset 5 % of range", {c: plain[:, c] + 0.05 * (high - low)})
    return {kind: np.concatenate(parts) for kind, parts in found.items()}


def rig_frames(
    scene: Scene,
    known: TrainedOn,
    rows: Rows,
    plain: Real,
    beyond: Real,
    rng: np.random.Generator,
) -> Iterator[Spoilt]:
    """Good and spoilt frames, with their distances from the training ``rows``."""
    recorded = read_recorded(scene).inputs
    kinds = spoilings(plain, recorded.min(axis=0), recorded.max(axis=0), rng)
    nearest = _nearest(recorded[rows])
    for kind, frames in {"": plain, **kinds, OUTSIDE: beyond}.items():
        outputs = hardware_outputs(scene, frames)
        distances = known.distances(frames, outputs)
        # Whether outputs are beyond their range does not depend on the distance.
        said = known.reasons(outputs, np.zeros(len(frames)))
        found = {name: distance(frames) for name, distance in nearest.items()}
        yield Spoilt(kind, np.array([bool(text) for text in said]), {**found, STATE: distances})


def _nearest(trained_rows: Real) -> dict[str, Callable[[Real], Real]]:
    """The distances from the nearest row, with sensors independent or correlated."""
    unit = trained_rows.std(axis=0)
    cloud = np.cov(trained_rows.T) + 1e-6 * np.diag(unit**2)
    whitening = np.linalg.inv(np.linalg.cholesky(cloud)).T
    plain, whole = KDTree(trained_rows / unit), KDTree(trained_rows @ whitening)
    return {
        NEAREST: lambda frames: np.asarray(plain.query(frames / unit)[0]),
        WHITENED: lambda frames: np.asarray(whole.query(frames @ whitening)[0]),
    }


def touched(
    scene: Scene,
    read: Read,
    force: tuple[float, float],
    place: tuple[float, float],
    rng: np.random.Generator,
) -> list[Spoilt]:
    """A rig from which new touches are drawn, compared as ``make predict`` does."""
    split, recorded = split_of(scene), read_recorded(scene)
    held, rows = np.concatenate([split.validation, split.test]), split.training
    known = learnt(
        scene.outputs,
        recorded.inputs[rows],
        recorded.targets[rows],
        recorded.inputs[held],
        hardware_outputs(scene, recorded.inputs[held]),
        code_steps(scene),
    )
    plain = read(touches_within(force, place, FRAMES, rng), rng)
    beyond = read(touches_beyond(force, place, FRAMES, rng), rng)
    return list(rig_frames(scene, known, rows, plain, beyond, rng))


def digit(rng: np.random.Generator) -> list[Spoilt]:
    """The recorded digit. In each split the test rows are new, and the validation rows held out.

    For a heavier load, the recorded reading is moved away from that of no load in proportion to the
    load, as beam theory says.
    """
    scene = load_scene("digit")
    recorded = read_recorded(scene)
    beam = Beam()
    sensors = fit_sensors(read_table(RECORDED, [*SENSORS, *COLUMNS]), beam)
    nothing = read_sensors(sensors, loads_from_codes(np.array([[0.0, 0.45, 0.225, 0.45]]), beam))
    parts: list[list[Spoilt]] = []
    for seed in range(1, 1 + SPLITS):
        split = split_of(replace(scene, training=replace(scene.training, seed=seed)))
        known = learnt(
            scene.outputs,
            recorded.inputs[split.training],
            recorded.targets[split.training],
            recorded.inputs[split.validation],
            hardware_outputs(scene, recorded.inputs[split.validation]),
            code_steps(scene),
            (recorded.targets.min(axis=0), recorded.targets.max(axis=0)),
        )
        rows = np.tile(split.test, -(-FRAMES // SPLITS // len(split.test)))
        plain = recorded.inputs[rows]
        load = recorded.targets[:, 0]
        heavy = load.max() + rng.uniform(0.5, 0.75, len(rows)) * np.ptp(load)
        beyond = nothing + (plain - nothing) * (heavy / load[rows])[:, np.newaxis]
        noise = rng.normal(0, DIGIT_NOISE, (2, *plain.shape))
        frames = plain + noise[0], (beyond + noise[1]).clip(-1, 1)
        parts.append(list(rig_frames(scene, known, split.training, *frames, rng)))
    return [
        Spoilt(
            same[0].kind,
            np.concatenate([one.beyond for one in same]),
            {m: np.concatenate([one.distances[m] for one in same]) for m in METHODS},
        )
        for same in zip(*parts, strict=True)
    ]


def rail_scene(folder: Path) -> Scene:
    """The scene of the tutorial, with networks that are trained quickly."""
    scene = load_scene(str(RAIL))
    members = tuple(
        replace(member, weights_path=folder / member.weights_path.name) for member in scene.members
    )
    return _with_networks(replace(scene, members=members))


def bar_scene(folder: Path, rng: np.random.Generator) -> Scene:
    """The scene that ``make scene`` writes for recorded touches of the bar."""
    touches = touches_within(BAR_FORCE, BAR_PLACE, BAR_ROWS, rng)
    table = np.column_stack([bar(touches, rng), touches.round(2)])
    names = [f"p{c}" for c in range(1, 6)]
    write_table(folder / "bar.csv", [*names, "force", "place"], table, 2)
    found = survey(read_csv_file(folder / "bar.csv"), ["force", "place"])
    return _with_networks(scaled(write_scene(found, folder / "bar.toml")))


def _with_networks(scene: Scene) -> Scene:
    for member, mlp in zip(scene.members, trained(scene).files, strict=True):
        write_network(member.weights_path, mlp)
    return scene


def outside(seed: int) -> Table:
    """The part of spoilt frames that is called outside, for each rate of false alarms."""
    rng = np.random.default_rng(seed)
    rigs = {"digit": digit(rng)}
    with TemporaryDirectory() as folder:
        scene = rail_scene(Path(folder))
        rigs["tutorial"] = touched(scene, rail, FORCE, PLACE, rng)
    with TemporaryDirectory() as folder:
        scene = bar_scene(Path(folder), rng)
        rigs["bar"] = touched(scene, bar, BAR_FORCE, BAR_PLACE, rng)
    rows = [row for name, frames in rigs.items() for row in _rows(name, frames)]
    at = [f"{100 * part:g} %" for part in FALSE_ALARMS]
    return Table(
        "outside",
        ["rig", "frames", *(f"{m} at {100 * AT:g} %" for m in METHODS[:2]), *at, "at its limit"],
        rows,
        NOTES["outside"],
    )


def _rows(rig: str, frames: Sequence[Spoilt]) -> list[list[Cell]]:
    good, *wrong = frames

    def seen(one: Spoilt, method: str, part: float) -> float:
        return 100 * one.seen(method, float(np.quantile(good.distances[method], 1 - part)))

    rows: list[list[Cell]] = [[rig, "good", *[None] * (2 + len(FALSE_ALARMS)), _limited(good)]]
    for one in wrong:
        plain = [seen(one, method, AT) for method in METHODS[:2]]
        found = [seen(one, STATE, part) for part in FALSE_ALARMS]
        rows.append([rig, one.kind, *plain, *found, _limited(one)])
    return rows


def _limited(one: Spoilt) -> float:
    return 100 * one.seen(STATE, 1.0)
