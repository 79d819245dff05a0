"""``make recalibrate``: finds gain and offset of each sensor from known placements.

Without placements it proposes some, namely those in the recording that lower the expected error
most.
"""

import hashlib
import warnings
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np

from golden.input_error import InputError, naming
from golden.numbers.real import Real
from tactus.core.cli import numbers, stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.recalibration.fit import Fit, LeftOut, fit, left_out
from tactus.recalibration.folder import check_copy, scene_file, write_copy
from tactus.recalibration.outlook import (
    ENOUGH,
    MOST_PLACEMENTS,
    REPEATS,
    Outlook,
    Plan,
    helps,
    outlook,
    placement,
    plan,
    planned,
    proposed,
)
from tactus.recalibration.sensitivity import (
    COLUMN,
    LEAST_FREE,
    Placements,
    Sensitivity,
    grouped,
    noise_of_repeats,
    numbers_of,
)
from tactus.scene import Scene, load_scene
from tactus.scene.disturbance import GAIN, MOST, OFFSET, Disturbance

# The least number of proposed placements. With fewer, the error of one would have too much weight.
PROPOSED = 8

# If the error of a placement that was left out exceeds the expectation by this factor, more than
# gain and offset has changed.
MOST_LEFT = 3.0
# The expected drift, and a text that says where it comes from.
Expected = tuple[Disturbance | None, str]


def main() -> None:
    arguments = arguments_of("recalibrate", __doc__)
    noise = numbers("NOISE", arguments.noise, 1, MOST)
    drift = numbers("DRIFT", arguments.drift, 2, MOST)
    scene = load_scene(arguments.scene)
    if scene.labels:
        raise InputError(
            f"{scene.path}: data.classes: got {scene.classes!r}, expected data.outputs: gain and "
            "offset are found from outputs that are numbers, and a label says only which class it "
            "is; record again with the sensors as they are, and run make train"
        )
    if not scene.window.plain:
        raise InputError(
            f"{scene.path}: data.window: got one that reaches {scene.window.past} frames back, "
            "expected none: placements are known one by one"
        )
    if len(scene.data_paths) > 1:
        raise InputError(
            f"{scene.path}: data.recordings: got {len(scene.data_paths)}, expected data.file: the "
            "copy of a scene has one recording"
        )
    expected = _drift(scene, drift)
    if arguments.csv:
        target = scene_file(scene, arguments.to)
        check_copy(scene, target, arguments.force)
        recalibrate(scene, Path(arguments.csv), target, noise, expected)
    else:
        propose(scene, noise, expected)


def _drift(scene: Scene, stated: list[float]) -> Expected:
    """The drift that is stated, or that of the scene, or the usual drift; and where it is from."""
    trained = scene.training.disturbance
    if stated:
        found, source = Disturbance(gain=stated[0], offset=stated[1]), "DRIFT"
        if found.none:
            raise InputError("DRIFT=0,0: expected a gain or an offset above 0")
    elif trained.gain or trained.offset:
        found, source = trained, f"training.drift of {scene.path.name}"
    else:
        text = f"gains by {100 * GAIN:g} %, offsets by {100 * OFFSET:g} % of the largest reading"
        return None, f"{text} (as is usual; DRIFT=gain,offset says another)"
    return found, f"gains by {100 * found.gain:g} %, offsets by {found.offset:g} ({source})"


def _noise(scene: Scene, stated: list[float], repeats: Real | None) -> tuple[Real | None, str]:
    """The noise of a reading of each sensor as a signal, and a text that says where it comes from.

    It is the noise that is stated, or that estimated from repeats, or that of the scene.
    """
    factors = np.array([s.factor for s in scene.scales(scene.sensors)])
    if stated:
        return stated[0] / factors, f"{stated[0]:g} (NOISE)"
    if repeats is not None:
        values = ", ".join(
            f"{n} {one:.2g}" for n, one in zip(scene.sensors, repeats * factors, strict=True)
        )
        return repeats, f"{values} (estimated from repeats)"
    trained = scene.training.disturbance.noise
    if trained:
        return trained / factors, f"{trained:g} (training.noise of {scene.path.name})"
    return None, "not known"


def propose(scene: Scene, stated: list[float], expected: Expected) -> None:
    """Print the placements that lower the expected error most."""
    noise, source = _noise(scene, stated, None)
    stop_if_dry_run(f"print placements that tell most of the sensors of scene {scene.name}")
    recorded = Sensitivity.of(scene, np.zeros(len(scene.sensors)), expected[0])
    if noise is not None:
        recorded = replace(recorded, noise=noise)
    found = plan(recorded)
    times, least = (found.times, len(found.placements)) if found else (1, 0)
    print(f"drift expected: {expected[1]}")
    print(f"noise of a reading: {source}")
    print("\nplacements, each the one that lowers the error expected over the recording most; root")
    print("mean squares in % that are expected after a correction with it and those above it:")
    nothing = planned(recorded, np.eye(2 * len(scene.sensors)))
    print(f"{'':4}{''.join(f'{name:>12}' for name in scene.outputs)}")
    print(f"{'':4}{_cells(nothing.before)}  no correction")
    for count, one in enumerate(islice(proposed(recorded, times), max(PROPOSED, least)), start=1):
        where = placement(scene, recorded.recorded.targets[one.row])
        print(f"{count:3} {_cells(one.expected.after)}  {where}")
    print(f"\n{_needed(found)}")
    if noise is None:
        print(
            "The noise of a reading is not known and taken as none: give it as NOISE=, or read\n"
            "each placement twice or more, from which it is estimated."
        )
    print(
        "Read the sensors there and give the rows as CSV= with the columns of the scene, and with a"
    )
    print(f"column {COLUMN!r} that has the same number in all rows of one placement.")


def _cells(values: Real) -> str:
    return "".join(f"{value:12.2f}" for value in values)


def _needed(found: Plan | None) -> str:
    """A sentence that says how many placements ensure a gain."""
    drifts = f"{100 * ENOUGH:g} of 100 drifts as they are expected"
    if found is None:
        return (
            f"No {MOST_PLACEMENTS} placements read {max(REPEATS)} times are enough to correct "
            f"{drifts} surely."
        )
    read = "once" if found.times == 1 else f"{found.times} times each"
    return (
        f"{len(found.placements)} placements that tell most, read {read}, are enough to correct "
        f"{drifts} surely."
    )


def recalibrate(
    scene: Scene, path: Path, target: Path, stated: list[float], expected: Expected
) -> None:
    """Fit a correction, print what it gains, and write it if it surely helps."""
    rows = replace(scene, data_paths=(path,), group_by="", where={}).vectors()
    with naming(path):
        placements, place = grouped(rows, numbers_of(path, [*scene.sensors, *scene.outputs]))
    noise, source = _noise(scene, stated, noise_of_repeats(rows, placements, place))
    if noise is None:
        raise InputError(
            f"{path}: got {len(rows.codes)} readings of {len(placements)} placements, expected at "
            f"least {LEAST_FREE} repeats, from which the noise of a reading is estimated: a column "
            f"{COLUMN!r} says which rows are one; or give NOISE=, in the unit of the readings"
        )
    stop_if_dry_run(f"tell what a correction gains, and write {target} if it surely gains")
    recorded = Sensitivity.of(scene, noise, expected[0])
    found = fit(recorded, placements)
    left, ahead = left_out(recorded, placements, found), outlook(recorded, found)
    refusal = _refusal(recorded, placements, found, left)
    print(f"{len(placements)} placements, {len(rows.codes)} readings of each sensor")
    print(f"drift expected: {expected[1]}")
    print(f"noise of a reading: {source}")
    tell_left_out(scene, placements, left)
    tell_outlook(scene, recorded, ahead)
    _warn_unexplained(scene, placements, left)
    if refusal:
        raise InputError(f"{path}: nothing written: {refusal}")
    correction = recorded.correction(found.theta)
    story = {
        "recalibrated_from": scene.name,
        "recalibrated_with": path.name,
        "recalibrated_with_sha256": hashlib.sha256(path.read_bytes()).hexdigest(),
        "placements": len(placements),
        "readings": len(rows.codes),
        "correction": {
            name: {"gain": one.factor, "offset": one.offset}
            for name, one in zip(scene.sensors, correction, strict=True)
        },
    }
    written = write_copy(scene, correction, story, target)
    print("\nsignal to the networks = gain * signal of the sensor + offset")
    for name, one in zip(scene.sensors, correction, strict=True):
        print(f"{name}: gain {one.factor:.5f}, offset {one.offset:+.5f}")
    print("\n".join(f"wrote {file}" for file in written))


def _refusal(
    recorded: Sensitivity,
    placements: Placements,
    found: Fit,
    left: LeftOut,
) -> str:
    """The reason why a correction is not written, and what to do; empty if it surely helps."""
    if helps(recorded, placements, found, left):
        return ""
    if planned(recorded, found.root).enough:
        if not left.improves:
            return (
                "placements that are left out come out no closer with a correction that is fitted "
                "to the others"
            )
        return (
            "these placements would have shown a drift as it is expected, and show none from which "
            "a correction surely gains"
        )
    return (
        "these placements tell too little for a sure gain. "
        f"{_needed(plan(recorded))} make recalibrate without CSV= names them"
    )


def tell_left_out(scene: Scene, placements: Placements, left: LeftOut) -> None:
    """Print the errors of each placement when it is left out."""
    print("\nerrors in % of each placement, as it is > with a correction fitted to all others:")
    for number, (before, after) in enumerate(zip(left.before, left.after, strict=True), start=1):
        errors = "".join(
            f"{abs(one):9.2f} >{abs(other):6.2f}" for one, other in zip(before, after, strict=True)
        )
        print(f"{number:3} {errors}  {placement(scene, placements.targets[number - 1])}")


def tell_outlook(scene: Scene, recorded: Sensitivity, ahead: Outlook) -> None:
    """Print the errors that are expected over the recording."""
    print("\nroot mean squares of errors in % that are expected over the recording, in floating")
    print("point; 'gain' is how likely the correction gains:")
    print(f"{'output':16}{'uncorrected':>12}{'corrected':>12}{'recorded':>12}{'gain':>10}")
    chance, *chances = ahead.chances[0]
    parts = scene.outputs, ahead.before, ahead.after, recorded.error, chances
    for name, *errors, gain in zip(*parts, strict=True):
        cells = "".join(f"{error:12.2f}" for error in errors)
        print(f"{name:16}{cells}{_percent(gain):>10}")
    print(f"{'all':52}{_percent(chance):>10}")


def _percent(chance: float) -> str:
    return ">99 %" if chance > 0.99 else f"{100 * chance:.0f} %"


def _warn_unexplained(scene: Scene, placements: Placements, left: LeftOut) -> None:
    """Warn of a placement that no correction fitted to the others explains."""
    parts = np.abs(left.after) / left.expected
    number, output = np.unravel_index(parts.argmax(), parts.shape)
    if parts[number, output] > MOST_LEFT:
        warnings.warn(
            f"{scene.outputs[output]} of placement {number + 1} "
            f"({placement(scene, placements.targets[number])}) is off by "
            f"{parts[number, output]:.1f} times what gain, offset and noise explain: is it noted "
            "rightly? Or more than gain and offset has changed",
            stacklevel=2,
        )
