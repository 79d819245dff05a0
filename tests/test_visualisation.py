"""Compares the bit-true profile of equation 3.18 with real arithmetic, also at extremes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from golden.input_error import InputError
from golden.numbers.precision import SIGNAL
from golden.visualisation.load_profile import (
    RECTANGLE,
    TRIANGLE,
    LoadProfile,
    load_profile,
)
from golden.visualisation.power_fold import PowerFold
from golden.visualisation.ramp import Ramp, ramp
from tactus.core.table import read_table
from tactus.report.measure.visualisation import quotient_error
from tactus.scene import load_scene
from tactus.verify.benches.written import write_scene
from tb.common.cases import VISUALISATION, random_mlp

APPENDIX_2 = Path(__file__).parents[1] / "scenes" / "data" / "appendix2.csv"
PROFILE = load_profile()
LSB = 2.0**-13
CODES = st.integers(SIGNAL.low, SIGNAL.high)


def recorded() -> np.ndarray:
    """The recorded targets as codes, which are the outputs of ideal networks."""
    return SIGNAL.quantise(read_table(APPENDIX_2, ["load", "position", "width", "shape"]))[0]


def units(frames, profile: LoadProfile = PROFILE) -> float:
    """The largest error in units of 2**-13."""
    found = SIGNAL.to_real(profile.process(frames)[1])
    return float(np.abs(found - profile.real(frames)).max() / LSB)


def test_every_recorded_frame_along_the_whole_ramp() -> None:
    frames = recorded()
    positions, heights = PROFILE.process(frames)
    assert heights.shape == (143, 17)
    assert np.allclose(SIGNAL.to_real(positions), np.arange(17) * 0.05, atol=0.51 * LSB)
    assert units(frames) < 1.2


def test_what_the_network_makes_of_every_recorded_frame() -> None:
    scene = load_scene("digit-single")
    assert scene.outputs == ("load", "position", "width", "shape")
    assert units(scene.twin().process(scene.vectors().codes)) < 1.82


@pytest.mark.parametrize("power", [TRIANGLE, RECTANGLE])
def test_the_bound_over_every_quotient(power: int) -> None:
    assert 1 < quotient_error(PROFILE, power) < 1.81


@given(st.tuples(CODES, CODES, CODES, CODES))
def test_the_bound_over_any_frame(frame) -> None:
    assert units(np.array(frame)) < 1.81


EXTREME = [SIGNAL.low, SIGNAL.low + 1, -1, 0, 1, 2, 5529, 5530, SIGNAL.high - 1, SIGNAL.high]


def test_the_bound_over_extremes_of_every_input() -> None:
    frames = np.stack(np.meshgrid(*[EXTREME] * 4, indexing="ij"), axis=-1)
    assert units(frames) < 1.81


@pytest.mark.parametrize("centre", [SIGNAL.low, -3000, SIGNAL.high])
def test_a_load_beside_the_ramp_shows_its_flank(centre: int) -> None:
    heights = PROFILE.process([SIGNAL.high, centre, SIGNAL.high, SIGNAL.high])[1]
    falling = heights if centre < 0 else heights[::-1]
    assert (np.diff(falling) <= 0).all()
    assert PROFILE.process([SIGNAL.high, centre, 400, 0])[1].max() == 0


def test_widths_hold_what_passes_through_them() -> None:
    """These are the widths that the hardware needs. Multipliers need at most 18 signed bits."""
    fold, between = PROFILE.power_fold, PROFILE.exp_interpolator
    assert max(fold.in_width, fold.out_width, between.word_width, between.factor_width) <= 17
    assert PROFILE.divider.numerator_width == (16383 * 5).bit_length()
    for part in (PROFILE.ramp, ramp(SIGNAL, 0.002, 0.998, -1.0)):
        bound = 1 << (part.acc_width - 1)
        assert -bound <= part.acc_low < part.acc_high < bound
    assert PROFILE.exp_memory.addr_width + between.offset_width == fold.out_width
    factor = (1 << between.frac) + (1 << (between.offset_width - 1))
    assert factor < 1 << between.factor_width
    assert between.process(PROFILE.exp_memory.words[0], 0) < 1 << between.word_width


@pytest.mark.parametrize("power", [1, 2, 3, 6])
def test_power_fold_is_the_power_saturated(power: int) -> None:
    fold = PowerFold(12, 10, 12, 8, 6)
    t = np.arange(1 << 12)
    found = fold.process(t, power)
    exact = (t / 2**10) ** power * 2**8
    assert (np.diff(found) >= 0).all()
    # Each use of the multiplier has a rounding error of half an LSB, which later uses multiply by
    # t.
    bound = 0.5 * power * np.maximum(1, t / 2**10) ** (power - 1) + 1e-9
    below = exact + bound < 4095
    assert (np.abs(found - exact) <= bound)[below].all()
    assert (found[exact - bound > 4095] == 4095).all()
    assert below[:1024].all()


@given(st.integers(0, 2**14 - 1), st.integers(0, 2**13 - 1))
def test_divider_is_shift_and_subtract(distance: int, width: int) -> None:
    """The hardware computes one bit of the quotient per step, with a remainder below the width."""
    divider = PROFILE.divider
    divisor = max(width, 1)
    numerator = distance * divider.gain
    integer_bits = divider.out_width - divider.out_frac
    if numerator >= divisor << integer_bits:
        quotient = (1 << divider.out_width) - 1
    else:
        quotient, remainder = 0, numerator >> integer_bits
        low = numerator & ((1 << integer_bits) - 1)
        for step in range(divider.out_width):
            bit = (low >> (integer_bits - 1 - step)) & 1 if step < integer_bits else 0
            remainder = 2 * remainder + bit
            fits = remainder >= divisor
            remainder -= divisor * fits
            quotient = 2 * quotient + fits
            assert remainder < divisor
    assert divider.process(distance, width) == quotient


def test_ramp_positions_are_the_nearest_codes() -> None:
    for step, stop, start in (
        (0.05, 0.8, 0.0),
        (0.01, 0.99, 0.0),
        (0.001, 0.999, 0.0),
        (0.125, 0.875, 0.0),
        (0.05, 0.75, 0.3),
        (0.002, 0.998, -1.0),
    ):
        part = ramp(SIGNAL, step, stop, start)
        ideal = start + np.arange(round((stop - start) / step) + 1) * step
        assert part.points == len(ideal)
        assert np.abs(SIGNAL.to_real(part.process()) - ideal).max() <= 0.51 * LSB


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: ramp(SIGNAL, 0.05, 1.0), "the last position is 8192, expected at most 8191"),
        (lambda: ramp(SIGNAL, 0.05, 0.82), "expected a whole number of steps"),
        (lambda: ramp(SIGNAL, 0.00005, 0.8), "more than half an LSB"),
        (lambda: ramp(SIGNAL, 0.0, 0.8), "ramp: step=0.0, expected a number above 0"),
        (lambda: ramp(SIGNAL, 0.05, float("nan")), "ramp: stop=nan"),
        (lambda: ramp(SIGNAL, 0.05, 0.0), "ramp: stop=0.0, expected a number above 0"),
        (lambda: ramp(SIGNAL, 0.05, 0.8, 0.8), "ramp: stop=0.8, expected a number above 0.8"),
        (lambda: ramp(SIGNAL, 0.05, 0.8, float("nan")), "ramp: start=nan, expected a finite"),
        (lambda: ramp(SIGNAL, 0.5, 0.5, -1.5), "the first position is -12288, expected at least"),
        (lambda: ramp(SIGNAL, 0.001, 0.5, -1.0), "1501 points with guard=17 need 31 bits"),
        (lambda: Ramp(SIGNAL, 0, 0, 1, 3), "ramp: got 3 points, step=0"),
        (lambda: replace(PROFILE.divider, gain=0), "divider: gain=0"),
        (lambda: replace(PROFILE.divider, gain_frac=16), "gain=5 with 16 fraction bits"),
        (lambda: replace(PROFILE.divider, out_width=15), "out_width=15, expected above out_frac"),
        (lambda: PowerFold(8, 4, 8, 5, 6), "power_fold: out_frac=5, expected 0 to 4"),
        (lambda: PowerFold(8, 8, 4, 4, 6), "and below out_width=4"),
        (lambda: PowerFold(8, 4, 8, 4, 1), "power_fold: max_power=1, expected 2 or more"),
        (lambda: PROFILE.power_fold.process(5, 0), "power: got 0, expected 1 to 6"),
        (lambda: PROFILE.power_fold.process(5, 7), "power: got 7, expected 1 to 6"),
        (lambda: PROFILE.power_fold.process(1 << 17, 2), "power_fold data: got 131072"),
        (lambda: PROFILE.divider.process(-1, 5), "divider distance: got -1"),
        (lambda: PROFILE.divider.process(1, 8192), "divider width: got 8192"),
        (lambda: PROFILE.exp_interpolator.process(1, 128), "exp_interpolator offset: got 128"),
        (lambda: PROFILE.process([0, 0, 0]), r"load_profile frames: got shape \(3,\)"),
        (lambda: PROFILE.process([8192, 0, 0, 0]), "load_profile frames: got code 8192"),
    ],
)
def test_what_does_not_fit_is_refused(call, message: str) -> None:
    with pytest.raises(InputError, match=message):
        call()


def drawn_scene(folder: Path, section: str) -> Path:
    mlp = random_mlp((2, 3, 5), 1.0, 1)
    return write_scene(folder, "drawn", "exact", [mlp], sections=section)


def test_a_scene_names_what_is_drawn(tmp_path: Path) -> None:
    section = VISUALISATION.replace("y0", "y4") + "start = -0.2\nstep = 0.25\n"
    scene = load_scene(str(drawn_scene(tmp_path, section)))
    design = scene.twin()
    outputs = design.process(scene.vectors().codes)
    positions, heights = design.profile(outputs)
    assert np.array_equal(SIGNAL.quantise([-0.2, 0.05, 0.3, 0.55, 0.8])[0], positions)
    own = replace(PROFILE, ramp=ramp(SIGNAL, 0.25, 0.8, -0.2))
    assert np.array_equal(heights, own.process(outputs[:, [4, 1, 2, 3]])[1])


def test_real_arithmetic_is_the_equation() -> None:
    """Load H, the triangle, and load A beside it: C = 2 / (0.4 w)."""
    frames = np.array([[5129, 4096, 3686, 7373], [7373, 2000, 7373, 3686]])
    x = PROFILE.ramp.process() / 8192
    for frame, power, found in zip(frames / 8192, (2, 6), PROFILE.real(frames), strict=True):
        d, centre, width, _ = frame
        assert np.allclose(found, d * np.exp(-((2 / (0.4 * width) * (x - centre)) ** power)))
