"""``python -m studies.physics.swing_data FOLDER``: recordings of the swing, as in chapter 6.

There is one run for training and there are independent runs for testing. Each is released at
another angle, with another noise and another wobble. FOLDER gets swing-train.csv, swing-test-1.csv,
... and swing.toml, which says how they were made and what the coded targets are in millimetres.
"""

from __future__ import annotations

import argparse
import hashlib
import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike
from scipy import signal

from golden.input_error import InputError
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real, checked
from studies.physics.plate import Plate
from studies.physics.swing import Motion, Swing, Wobble, foot_forces, swing_motion
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.files import replace_file
from tactus.core.table import write_table
from tactus.physics.beam import GRAVITY

# Hz, of the DC remover of section 6.4.2. The thesis rounds 1 / (2 pi R C) of 560 kilohm and
# 4.7 microfarad to it.
CUTOFF = 0.06
SCAN_RATE = 15_625.0  # complete scans of the digit's sensors a second: section 5.4.4


@dataclass(frozen=True)
class ReflectiveSensor:
    """A reflective proximity sensor below the plate, linear within its range (Figure 6.9).

    rest: Output in V without deflection, 0 to 100; the thesis has 3.5 to 4.7.
    sensitivity: V/m, -1e6 to 1e6. The default of 450 is ours: with it a 10 kg swing moves the
        sensors by the 10 to 60 mV that the thesis reports.
    linear: m, 1 um to 1 m. Beyond this deflection, in both directions, the output stays constant.
        The default of 1 mm is the lower end of the 1 to 2 mm that section 6.2.1 prints for a person
        on the plate.
    noise: Standard deviation of Gaussian noise, V, 0 to 10.
    """

    rest: float = 4.1
    sensitivity: float = 450.0
    linear: float = 1e-3
    noise: float = 0.0

    def __post_init__(self) -> None:
        checked(
            rest=(self.rest, 0, 100),
            sensitivity=(self.sensitivity, -1e6, 1e6),
            linear=(self.linear, 1e-6, 1),
            noise=(self.noise, 0, 10),
        )

    def read(self, deflection: ArrayLike, rng: np.random.Generator) -> Real:
        """Volts for deflections in m; the noise comes from ``rng``."""
        most = float(np.finfo(np.float64).max)
        (w,) = checked(deflection=(deflection, -most, most))
        volts = self.rest + self.sensitivity * np.clip(w, -self.linear, self.linear)
        return np.asarray(volts + rng.normal(0, self.noise, w.shape))


@dataclass(frozen=True)
class Conditioning:
    """DC remover, gain, clipping circuit and ADC of one sensor.

    gain: G, -1e6 to 1e6; the thesis has 10 for sensors 1 and 3, and 80 for sensor 2.
    cutoff: Cut-off of the first-order high pass in Hz, 0 to below half of the rate; with 0, DC
        passes too.
    rate: Samples per second, 1e-3 to 1e9.
    """

    gain: float
    cutoff: float = CUTOFF
    rate: float = 200.0

    def __post_init__(self) -> None:
        checked(gain=(self.gain, -1e6, 1e6), rate=(self.rate, 1e-3, 1e9))
        checked(cutoff=(self.cutoff, 0, 0.499 * self.rate))

    def amplify(self, volts: ArrayLike, rest: float) -> Real:
        """Apply the high pass and then the gain; the result in V is not clipped.

        The high pass is the bilinear transform of s / (s + omega) with the right cut-off
        (``scipy.signal.butter``). Before the first sample it has settled at ``rest``.

        volts, shape (n,): At least one sample.
        rest: Output of the sensor at rest, in V.
        """
        most = float(np.finfo(np.float64).max)
        v, r = checked(volts=(volts, -most, most), rest=(rest, -most, most))
        if v.ndim != 1 or not v.size:
            raise InputError(f"volts: got shape {v.shape}, expected (n,) with n of 1 or more")
        if self.cutoff == 0:
            return np.asarray(self.gain * v)
        b, a = signal.butter(1, self.cutoff, "highpass", fs=self.rate)
        passed, _ = signal.lfilter(b, a, v - r, zi=[0.0])
        return np.asarray(self.gain * passed)

    def convert(self, volts: ArrayLike, rest: float) -> tuple[Codes, int]:
        """The output of the ADC: codes of Fix(14,13), and the number of samples that were clipped.

        Arguments and errors are as in ``amplify``; rounding and saturation as in ``Fix.quantise``.
        """
        return SIGNAL.quantise(self.amplify(volts, rest))


COLUMNS = ("sensor1", "sensor2", "sensor3", "x", "y", "z")
GAINS = (10.0, 80.0, 10.0)  # section 6.4.2
RATE, SECONDS = 200.0, 25.0  # section 6.4.3
# In degrees. The first run trains; the last two test what was chosen without them.
ANGLES = (35.0, 30.0, 25.0, 20.0, 33.0)
BOUND = 0.7  # of the coded targets, section 6.4.4
DECIMALS = 4  # of a recording; they keep every code of the ADC

# In V at the sensor, before the gain. See docs/physics.md: Figure 6.14 is not in the text of the
# thesis. This noise alone causes about the whole error of the thesis' best network.
NOISE = 5e-5

# In kg. Without the weight of a frame, a swing from 35 degrees would lift its feet. The thesis
# takes "the rig" into account, but prints no weight.
FRAME_MASS = 10.0
# The largest wobble at release, and the least part of it that is drawn, so that all runs differ.
WOBBLE = 0.008  # m
LEAST_WOBBLE = 0.75


@dataclass(frozen=True)
class Recording:
    """One run of the swing.

    sensors, shape (n, 3): Output of the ADC in V, as values of Fix(14,13).
    place, shape (n, 3): x (wobble), y = arm sin(phi), z = arm (1 - cos(phi)) of the mass in m,
        relative to where it hangs.
    clipped: Number of samples beyond the range of the ADC.
    """

    sensors: Real
    place: Real
    clipped: int


def record(
    angle: float,
    seed: int,
    noise: float = NOISE,
    seconds: float = SECONDS,
    rig: Rig | None = None,
    rate: float = RATE,
) -> Recording:
    """Release the swing and record it.

    angle: Angle at release in degrees, -60 to 60.
    seed: 0 or more; determines the noise and the wobble (6 to 8 mm at release, with any phase).
    noise: Standard deviation at each reflective sensor in V, 0 to 10.
    seconds: See ``swing_motion``; the default is 25.
    rig: The default is a frame of 10 kg on the plate of the thesis.
    rate: Samples per second.
    """
    checked(angle=(angle, -60, 60), seed=(seed, 0, 2**63))
    rig = Rig(swing=Swing(frame_mass=FRAME_MASS)) if rig is None else rig
    rng = np.random.default_rng(seed)
    wobble = Wobble(
        amplitude=WOBBLE * rng.uniform(LEAST_WOBBLE, 1), phase=rng.uniform(-math.pi, math.pi)
    )
    motion = swing_motion(rig.swing, math.radians(angle), seconds, rate)
    x, acceleration = wobble.displacement(motion.time)
    deflections = rig.deflections(rig.forces(motion, x, acceleration))
    still = np.zeros(1)
    hanging = rig.deflections(rig.forces(Motion(still, still, still), still, still))[0]
    columns, clipped = [], 0
    for gain, deflection, rest in zip(GAINS, deflections.T, hanging, strict=True):
        sensor = ReflectiveSensor(noise=noise)
        settled = float(ReflectiveSensor().read(rest, rng))
        codes, cut = Conditioning(gain, rate=rate).convert(sensor.read(deflection, rng), settled)
        columns.append(SIGNAL.to_real(codes))
        clipped += cut
    arm = rig.swing.arm
    place = [x, arm * np.sin(motion.angle), 2 * arm * np.sin(motion.angle / 2) ** 2]
    return Recording(np.stack(columns, axis=-1), np.stack(place, axis=-1), clipped)


@dataclass(frozen=True)
class Coding:
    """Coded target = (place - offset) * scale, computed from the training run as in section 6.4.4.

    offset, shape (3,): The mean of each coordinate in m.
    scale, shape (3,): In 1/m: 0.7 divided by the largest magnitude after the offset.
    """

    offset: Real
    scale: Real = field(repr=False)

    @classmethod
    def of(cls, recording: Recording) -> Coding:
        """The coding with which a recording fills -0.7 to 0.7."""
        offset = recording.place.mean(axis=0)
        return cls(offset, BOUND / np.abs(recording.place - offset).max(axis=0))

    def code(self, recording: Recording) -> Real:
        """Sensors and coded targets, shape (n, 6)."""
        return np.hstack([recording.sensors, (recording.place - self.offset) * self.scale])


@cache
def _training() -> Recording:
    return record(ANGLES[0], 1)


@cache
def _independent(number: int) -> Real:
    """Run ``number`` of those for testing, 1 and up, as ``write_recordings`` would write it.

    It is made when it is needed. Codes of the ADC and four decimals hide the last bits in which
    processors differ.
    """
    run = record(ANGLES[number], 1 + number)
    return np.round(Coding.of(_training()).code(run), DECIMALS)


def independent_run(number: int, columns: Sequence[str]) -> Real:
    """Some of ``COLUMNS`` of a run for testing, shape (rows, columns)."""
    return _independent(number)[:, [COLUMNS.index(name) for name in columns]]


def write_recordings(
    folder: Path, seed: int = 1, angles: Sequence[float] = ANGLES, noise: float = NOISE
) -> list[Path]:
    """Write a run for each angle. The first one trains, and its coding is used for all.

    seed: Seed of the first run; run n after it has seed + n.
    angles: In degrees; at least one.
    noise: See ``record``.
    """
    if not angles:
        raise InputError("angles: got none, expected at least one")
    names = ["swing-train.csv", *(f"swing-test-{n}.csv" for n in range(1, len(angles)))]
    runs = [record(angle, seed + n, noise) for n, angle in enumerate(angles)]
    coding = Coding.of(runs[0])
    story = [
        "# Provenance of the recordings of the swing: generated, not measured.",
        'source = "studies.physics.swing_data: plate and swing of thesis chapter 6, Appendix 7"',
        'sensors = "three reflective sensors below the plate, conditioned to -1 .. 1 V; unit V"',
        f'targets = "x, y, z of the mass, coded so that the training run fills +-{BOUND}"',
        f'rate = "{RATE:g} samples per second, from release"',
        'licence = "generated by this project, under its own licence"',
        f"noise_v = {noise!r}  # standard deviation at each sensor, before the gain",
        f"gains = {list(GAINS)}",
        f"offset_mm = {[round(1e3 * float(v), 6) for v in coding.offset]}  # of code 0, x y z",
        f"mm_per_unit = {[round(1e3 / float(v), 6) for v in coding.scale]}  # x y z",
    ]
    paths = []
    for n, (name, angle, recording) in enumerate(zip(names, angles, runs, strict=True)):
        path = folder / name
        write_table(path, COLUMNS, coding.code(recording), DECIMALS)
        paths.append(path)
        story += [
            "",
            f"[{path.stem}]",
            f"seed = {seed + n}",
            f"angle_degrees = {angle!r}",
            f"rows = {len(recording.sensors)}",
            f"clipped = {recording.clipped}",
            f'sha256 = "{hashlib.sha256(path.read_bytes()).hexdigest()}"',
        ]
    with replace_file(folder / "swing.toml") as temporary:
        temporary.write_text("\n".join([*story, ""]), encoding="utf-8")
    return [*paths, folder / "swing.toml"]


def main() -> None:
    parser = argparse.ArgumentParser(prog="studies.physics.swing_data", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--angles", type=float, nargs="+", default=ANGLES, help="degrees")
    parser.add_argument("--noise", type=float, default=NOISE, help="V before the gain")
    arguments = parser.parse_args()
    stop_if_dry_run(f"write recordings of {len(arguments.angles)} swings into {arguments.folder}")
    paths = write_recordings(arguments.folder, arguments.seed, arguments.angles, arguments.noise)
    for path in paths:
        print(f"wrote {path}")


@dataclass(frozen=True)
class Rig:
    """A swing in the middle of a plate, with its frames along the plate's length.

    frames: Distance of the two A-frames in m; 0.350 in thesis section 6.2.2.
    offset: Distance in m of sensors 1 and 3, which lie on the line of the feet, from the middle of
        the plate's width; sensor 2 lies in the middle. The value is ours: the thesis has them
        "closely to" the axis, but a sensor on the axis gives the same reading whichever frame
        carries the load, so that no sensor would detect the wobble.
    """

    plate: Plate = field(default_factory=Plate)
    swing: Swing = field(default_factory=Swing)
    frames: float = 0.350
    offset: float = 0.040

    def __post_init__(self) -> None:
        checked(
            feet=(self.swing.feet, 0, self.plate.length),
            frames=(self.frames, 1e-3, self.plate.width),
            offset=(self.offset, -self.plate.width / 2, self.plate.width / 2),
        )

    @property
    def feet(self) -> Real:
        """The places of the four feet, shape (4, 2): side 1 then side 2, each left then right."""
        middle, across = self.plate.length / 2, self.plate.width / 2
        return np.array(
            [
                [middle + side * self.swing.feet / 2, across + frame * self.frames / 2]
                for side in (-1, 1)
                for frame in (-1, 1)
            ]
        )

    @property
    def sensors(self) -> Real:
        """The places of the three sensors, shape (3, 2)."""
        middle, across = self.plate.length / 2, self.plate.width / 2
        half = self.swing.feet / 2
        return np.array(
            [
                [middle - half, across + self.offset],
                [middle, across],
                [middle + half, across + self.offset],
            ]
        )

    def forces(self, motion: Motion, lateral: Real, lateral_acceleration: Real) -> Real:
        """Force of each foot in N, shape (n, 4).

        The force on each side (equations 6.4 and 6.5) is divided equally between its frames, as the
        thesis assumes, apart from the wobble, which is our addition. A mass at x off the middle,
        whose support it accelerates by x'' at the height of the axis, shifts the load to one frame
        by (D a_g x - D x'' height) / frames, half of it on each side.
        """
        swing = self.swing
        tilt = swing.mass * (GRAVITY * lateral - lateral_acceleration * swing.height) / self.frames
        sides = foot_forces(swing, motion.angle, motion.speed)
        forces = np.stack([(n + sign * tilt) / 2 for n in sides for sign in (-1, 1)], axis=-1)
        if forces.min() < 0:
            worst = int(forces.min(axis=1).argmin())
            raise InputError(
                f"foot forces: got {forces.min():.3g} N at {motion.time[worst]:.3g} s, expected 0 "
                "or more; start at a smaller angle or give the frame a weight"
            )
        return forces

    def deflections(self, forces: Real) -> Real:
        """Deflection of the plate above each sensor in m, shape (n, 3), for forces (n, 4)."""
        return np.asarray(forces @ self.plate.influence(self.sensors, self.feet).T)


if __name__ == "__main__":
    sys.exit(run(main))
