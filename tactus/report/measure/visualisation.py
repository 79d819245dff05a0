"""Equation 3.18: bit-true against real arithmetic."""

import itertools

import numpy as np

from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.numbers.units import FULL_SCALE, WIDTH_MM
from golden.visualisation.load_profile import RECTANGLE, TRIANGLE, LoadProfile, load_profile
from tactus.core.table import read_table
from tactus.physics.digit_data import RECORDED
from tactus.report.measure.table import Cell, Table

RANDOM_FRAMES = 20_000
UNITS = 2**13


def errors_in_units(profile: LoadProfile, frames: Codes) -> Real:
    """The magnitude of the error of the bit-true profile in units of 2**-13, for each point."""
    found = SIGNAL.to_real(profile.process(frames)[1])
    return np.asarray(UNITS * np.abs(found - profile.real(frames)))


def quotient_error(profile: LoadProfile, power: int) -> float:
    """The largest error in units of 2**-13 over every quotient t and all values that it stands for.

    The profile falls with t. So the error of a quotient is largest at one of the two ends of the
    interval that the divider truncates to it. The last quotient stands for every larger one.
    """
    divider = profile.divider
    t = np.arange(1 << divider.out_width)
    load = np.asarray(profile.fmt.high)
    found = profile.fmt.to_real(profile.height(load, t, np.asarray(power)))
    ends = np.stack([t, t + 1]) / 2.0**divider.out_frac
    exact = profile.fmt.to_real(load) * np.exp(-(ends**power))
    exact[1, -1] = 0
    return float(UNITS * np.abs(found - exact).max())


def profile(seed: int) -> Table:
    """Equation 3.18 bit-true against real arithmetic."""
    design = load_profile()
    rows: list[list[Cell]] = []

    def add(frames: str, width: float | None, power: int | None, errors: Real) -> None:
        rows.append([frames, width, power, errors.size, float(errors.mean()), float(errors.max())])

    table = read_table(RECORDED, ["load", "position", "width", "shape"])
    codes = SIGNAL.quantise(table)[0]
    powers = np.where(codes[:, 3] > design.shape_threshold, TRIANGLE, RECTANGLE)
    for name, load in zip("ABCDEFGH", dict.fromkeys(table[:, 0]), strict=True):
        chosen = table[:, 0] == load
        width = float(table[chosen][0, 2] / FULL_SCALE * WIDTH_MM)
        power = int(powers[chosen][0])
        add(f"load {name}", width, power, errors_in_units(design, codes[chosen]))
    rng = np.random.default_rng(seed)
    drawn = rng.integers(SIGNAL.low, SIGNAL.high + 1, (RANDOM_FRAMES, 4))
    add("random", None, None, errors_in_units(design, drawn))
    ends = (SIGNAL.low, -1, 0, 1, 2, SIGNAL.high)
    extreme = np.array(list(itertools.product(ends, repeat=4)))
    add("extreme codes", None, None, errors_in_units(design, extreme))
    for power in (RECTANGLE, TRIANGLE):
        points = 1 << design.divider.out_width
        rows.append(["every quotient", None, power, points, None, quotient_error(design, power)])
    return Table(
        "profile",
        ["frames", "width mm", "P", "points", "mean units", "largest units"],
        rows,
        "Equation 3.18 as the hardware computes it (section 5.8, with the ramp of 0 to 0.8 in "
        "steps of 0.05) is compared with real arithmetic at the same codes. The errors are in "
        "units of 2^-13. 'Every quotient' takes every t = C (i_p - i_m) that the divider can give, "
        "with everything that the divider truncates, at full load. This is the bound for any "
        "frame.",
    )
