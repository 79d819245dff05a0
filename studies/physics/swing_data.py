"""``python -m studies.physics.swing_data FOLDER``: recordings of the swing, as in chapter 6.

There is one run for training and there are independent runs for testing. Each is released at
another angle, with another noise and another wobble. FOLDER gets swing-train.csv, swing-test-1.csv,
... and swing.toml, which says how they were made and what the coded targets are in millimetres.
"""

import argparse
import hashlib
import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
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
from studies.physics.swing import Motion, Swing, foot_forces, swing_motion
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.files import replace_file
from tactus.core.table import write_table
from tactus.physics.beam import GRAVITY

# Hz, of the DC remover of section 6.4.2. The thesis rounds 1 / (2 pi R C) of 560 kilohm and
# 4.7 microfarad to it.
CUTOFF = 0.06

# The reflective sensors below the plate. At rest the thesis has 3.5 to 4.7 V. The sensitivity is
# ours: with it a 10 kg swing moves the sensors by the 10 to 60 mV that the thesis reports. Beyond
# the linear range the output stays constant; 1 mm is the lower end of the 1 to 2 mm that section
# 6.2.1 prints for a person on the plate.
REST, SENSITIVITY, LINEAR = 4.1, 450.0, 1e-3  # V, V/m, m
MOST = float(np.finfo(np.float64).max)


def read_sensor(deflection: ArrayLike, rng: np.random.Generator, noise: float = 0.0) -> Real:
    """Volts of a sensor, linear within its range (Figure 6.9), for deflections in m.

    noise: Standard deviation in V of Gaussian noise, drawn from ``rng``.
    """
    (w,) = checked(deflection=(deflection, -MOST, MOST))
    volts = REST + SENSITIVITY * np.clip(w, -LINEAR, LINEAR)
    return np.asarray(volts + rng.normal(0, noise, w.shape))


@dataclass(frozen=True)
class Conditioning:
    """DC remover, gain, clipping circuit and ADC of one sensor; ``rate`` is in samples a second."""

    gain: float
    rate: float = 200.0

    def amplify(self, volts: ArrayLike, rest: float) -> Real:
        """Apply the high pass and then the gain; the result in V is not clipped.

        The high pass is the bilinear transform of s / (s + omega) with the right cut-off
        (``scipy.signal.butter``). Before the first sample it has settled at ``rest``.

        volts, shape (n,): At least one sample.
        rest: Output of the sensor at rest, in V.
        """
        v, r = checked(volts=(volts, -MOST, MOST), rest=(rest, -MOST, MOST))
        b, a = signal.butter(1, CUTOFF, "highpass", fs=self.rate)
        passed, _ = signal.lfilter(b, a, v - r, zi=[0.0])
        return np.asarray(self.gain * passed)

    def convert(self, volts: ArrayLike, rest: float) -> tuple[Codes, int]:
        """The output of the ADC: codes of Fix(14,13), and the number of samples that were clipped.

        Arguments are as in ``amplify``; rounding and saturation as in ``Fix.quantise``.
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

# The rig: a swing in the middle of the plate, with its frames along the plate's length. Without the
# weight of a frame, 10 kg, a swing from 35 degrees would lift its feet; the thesis takes "the rig"
# into account, but prints no weight.
PLATE, SWING = Plate(), Swing(frame_mass=10.0)
FRAMES = 0.350  # m from one A-frame to the other: section 6.2.2
# Sensors 1 and 3 lie on the line of the feet, this far in m from the middle of the plate's width.
# The value is ours: the thesis has them "closely to" the axis, but a sensor on the axis gives the
# same reading whichever frame carries the load, so that no sensor would detect the wobble.
OFFSET = 0.040

# The wobble is our addition: a lightly damped second mode, x'' + 2 zeta omega x' + omega^2 x = 0,
# in which the frames rock sideways on the plate, with the mass on them. 8 mm at release give the
# mean of 9 mm from end to end in Table 6.2; at least three quarters of it are drawn, so that all
# runs differ. Its frequency is no multiple of the swing's 0.7 Hz, and it decays about as fast.
WOBBLE, LEAST_WOBBLE = 0.008, 0.75
WOBBLE_HZ, WOBBLE_RATIO = 1.9, 0.004  # omega / (2 pi), zeta


def wobble(time: Real, amplitude: float, phase: float) -> tuple[Real, Real]:
    """x = amplitude cos(phase) in m at time 0, and x'' in m/s^2, in closed form."""
    omega = 2 * math.pi * WOBBLE_HZ
    # The roots of the characteristic equation are -zeta omega +- i omega sqrt(1 - zeta^2).
    root = omega * complex(-WOBBLE_RATIO, math.sqrt(1 - WOBBLE_RATIO**2))
    turning = amplitude * np.exp(root * time + 1j * phase)
    return np.real(turning), np.real(root**2 * turning)


def deflections(motion: Motion, lateral: Real, lateral_acceleration: Real) -> Real:
    """Deflection of the plate above each sensor in m, shape (n, 3).

    The force on each side (equations 6.4 and 6.5) is divided equally between its frames, as the
    thesis assumes, apart from the wobble. A mass at x off the middle, whose support it accelerates
    by x'' at the height of the axis, shifts the load to one frame by
    (D a_g x - D x'' height) / frames, half of it on each side.
    """
    tilt = SWING.mass * (GRAVITY * lateral - lateral_acceleration * SWING.height) / FRAMES
    sides = foot_forces(SWING, motion.angle, motion.speed)
    forces = np.stack([(n + sign * tilt) / 2 for n in sides for sign in (-1, 1)], axis=-1)
    if forces.min() < 0:
        worst = int(forces.min(axis=1).argmin())
        raise InputError(
            f"foot forces: got {forces.min():.3g} N at {motion.time[worst]:.3g} s, expected 0 "
            "or more; start at a smaller angle or give the frame a weight"
        )
    return np.asarray(forces @ _influence().T)


@cache
def _influence() -> Real:
    """Of the feet, side 1 then side 2, each left then right, on the three sensors."""
    middle, across, half = PLATE.length / 2, PLATE.width / 2, SWING.feet / 2
    feet = [
        [middle + side * half, across + frame * FRAMES / 2] for side in (-1, 1) for frame in (-1, 1)
    ]
    sensors = [
        [middle - half, across + OFFSET],
        [middle, across],
        [middle + half, across + OFFSET],
    ]
    return PLATE.influence(sensors, feet)


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


@cache
def record(angle: float, seed: int) -> Recording:
    """Release the swing at an angle in degrees; the seed determines the noise and the wobble."""
    rng = np.random.default_rng(seed)
    amplitude = WOBBLE * rng.uniform(LEAST_WOBBLE, 1)
    phase = rng.uniform(-math.pi, math.pi)
    motion = swing_motion(SWING, math.radians(angle), SECONDS, RATE)
    x, acceleration = wobble(motion.time, amplitude, phase)
    still = np.zeros(1)
    hanging = deflections(Motion(still, still, still), still, still)[0]
    columns, clipped = [], 0
    for gain, column, rest in zip(
        GAINS, deflections(motion, x, acceleration).T, hanging, strict=True
    ):
        settled = float(read_sensor(rest, rng))
        codes, cut = Conditioning(gain, RATE).convert(read_sensor(column, rng, NOISE), settled)
        columns.append(SIGNAL.to_real(codes))
        clipped += cut
    place = [x, SWING.arm * np.sin(motion.angle), 2 * SWING.arm * np.sin(motion.angle / 2) ** 2]
    return Recording(np.stack(columns, axis=-1), np.stack(place, axis=-1), clipped)


def coding() -> tuple[Real, Real]:
    """Offset in m and scale in 1/m with which the training run fills -0.7 to 0.7, shape (3,)."""
    place = record(ANGLES[0], 1).place
    offset = place.mean(axis=0)
    return offset, BOUND / np.abs(place - offset).max(axis=0)


def coded(number: int) -> Real:
    """Sensors and coded targets of a run, shape (n, 6), as in section 6.4.4; 0 is for training."""
    run, (offset, scale) = record(ANGLES[number], 1 + number), coding()
    return np.hstack([run.sensors, (run.place - offset) * scale])


def independent_run(number: int, columns: Sequence[str]) -> Real:
    """Some of ``COLUMNS`` of a run for testing, 1 and up, as ``write_recordings`` would write it.

    Codes of the ADC and four decimals hide the last bits in which processors differ.
    """
    return np.round(coded(number), DECIMALS)[:, [COLUMNS.index(name) for name in columns]]


def write_recordings(folder: Path) -> list[Path]:
    """Write a run for each angle. The first one trains, and its coding is used for all."""
    names = ["swing-train.csv", *(f"swing-test-{n}.csv" for n in range(1, len(ANGLES)))]
    runs = [record(angle, 1 + n) for n, angle in enumerate(ANGLES)]
    offset, scale = coding()
    story = [
        "# Provenance of the recordings of the swing: generated, not measured.",
        'source = "studies.physics.swing_data: plate and swing of thesis chapter 6, Appendix 7"',
        'sensors = "three reflective sensors below the plate, conditioned to -1 .. 1 V; unit V"',
        f'targets = "x, y, z of the mass, coded so that the training run fills +-{BOUND}"',
        f'rate = "{RATE:g} samples per second, from release"',
        'licence = "generated by this project, under its own licence"',
        f"noise_v = {NOISE!r}  # standard deviation at each sensor, before the gain",
        f"gains = {list(GAINS)}",
        f"offset_mm = {[round(1e3 * float(v), 6) for v in offset]}  # of code 0, x y z",
        f"mm_per_unit = {[round(1e3 / float(v), 6) for v in scale]}  # x y z",
    ]
    paths = []
    for n, (name, angle, recording) in enumerate(zip(names, ANGLES, runs, strict=True)):
        path = folder / name
        write_table(path, COLUMNS, coded(n), DECIMALS)
        paths.append(path)
        story += [
            "",
            f"[{path.stem}]",
            f"seed = {1 + n}",
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
    folder = parser.parse_args().folder
    stop_if_dry_run(f"write recordings of {len(ANGLES)} swings into {folder}")
    for path in write_recordings(folder):
        print(f"wrote {path}")


if __name__ == "__main__":
    sys.exit(run(main))
