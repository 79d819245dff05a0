"""Equations 3.17 and 3.18: error against terms, and bit-true against real arithmetic."""

import itertools

import numpy as np

from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.numbers.units import FULL_SCALE, WIDTH_MM
from golden.visualisation.functions import harmonic_limit, harmonic_load, harmonic_tail
from golden.visualisation.load_profile import RECTANGLE, TRIANGLE, LoadProfile, load_profile
from tactus.core.table import read_table
from tactus.report.measure.rbf import DATA
from tactus.report.measure.table import Cell, Table
from tactus.report.measure.timing import timed

# The load, centre and half width of the curves of Figure 3.27. B is A with 10 terms.
FIGURE_3_27 = {"A, B": (0.5, 0.5, 0.3), "C": (0.7, 0.5, 0.2)}
TERMS = (1, 10, 100, 1000, 10_000, 100_000)
FAR = 0.05  # from a jump, where the Gibbs overshoot has died away

RANDOM_FRAMES = 20_000
UNITS = 2**13


def series(_: int) -> Table:
    """Equation 3.17 against its closed form, for more and more terms."""
    rows: list[list[Cell]] = []
    for case, (load, centre, width) in FIGURE_3_27.items():
        grid = np.linspace(0, 1, 201)
        far = np.abs(np.abs(grid - centre) - width) >= FAR
        limit = harmonic_limit(grid[far], load, centre, width)
        top = load * (1 - 2 * width)
        for terms in TERMS:
            found, ms = timed(harmonic_load, grid[far], load, centre, width, terms)
            miss = np.abs(found - limit)
            bound = harmonic_tail(grid[far], load, centre, width, terms)
            near = np.minimum(centre, centre - width + np.linspace(0.5, 1.5, 101) / (terms + 1))
            peak = harmonic_load(near, load, centre, width, terms).max()
            rows.append(
                [
                    case,
                    terms,
                    terms * int(far.sum()),
                    ms,
                    float(miss.max() / load),
                    float(bound.max() / load),
                    float((peak - top) / load),
                ]
            )
    return Table(
        "series",
        ["case", "terms", "evaluations", "ms", "error / d", "bound / d", "overshoot / d"],
        rows,
        f"Equation 3.17 is compared with its limit, under the conditions of Figure 3.27. The error "
        f"is the largest one at a distance of {FAR} or more from a jump. The bound is that of the "
        "terms that are left out. The overshoot beside the jump tends to 0.0895, however many "
        "terms there are. The evaluations are the terms times the positions.",
        timed=["ms"],
    )


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

    table = read_table(DATA / "appendix2.csv", ["load", "position", "width", "shape"])
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
