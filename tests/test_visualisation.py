"""Compares the bit-true profile of equation 3.18 with real arithmetic, also at extremes."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from golden.input_error import InputError
from golden.numbers.fixed import Fix
from golden.numbers.precision import SIGNAL, normalisation
from golden.sensing.scan_sequencer import ScanSequencer
from golden.trained.mlp import Mlp
from golden.visualisation.functions import (
    WILBRAHAM_GIBBS,
    harmonic_limit,
    harmonic_load,
    harmonic_tail,
    power_load,
)
from golden.visualisation.load_profile import RECTANGLE, TRIANGLE, LoadProfile, load_profile, ramp
from golden.visualisation.power_fold import PowerFold
from tactus.core.table import read_table
from tactus.scene import load_scene, thesis_table
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
    """The profile falls with t, so the error of a quotient is largest where its interval ends.

    The last quotient stands for every larger one.
    """
    divider = PROFILE.divider
    t = np.arange(1 << divider.out_width)
    load = np.asarray(PROFILE.fmt.high)
    found = PROFILE.fmt.to_real(PROFILE.height(load, t, np.asarray(power)))
    ends = np.stack([t, t + 1]) / 2.0**divider.out_frac
    exact = PROFILE.fmt.to_real(load) * np.exp(-(ends**power))
    exact[1, -1] = 0
    assert 1 < np.abs(found - exact).max() / LSB < 1.81


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
        (lambda: ramp(SIGNAL, 0.5, 0.5, -1.5), "the first position is -12288, expected at least"),
        (lambda: ramp(SIGNAL, 0.001, 0.5, -1.0), "1501 points with guard=17 need 31 bits"),
        (lambda: PROFILE.power_fold.process(5, 7), "power: got 7, expected 1 to 6"),
        (lambda: PROFILE.power_fold.process(1 << 17, 2), "power_fold data: got 131072"),
        (lambda: PROFILE.divider.process(-1, 5), "divider distance: got -1"),
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


# The load, centre, half width and terms of Figure 3.27.
FIGURE_3_27 = thesis_table("load_function")["cases"]
POSITIONS = np.linspace(0, 1, 401)


@pytest.mark.parametrize("case", FIGURE_3_27)
def test_figure_3_27(case: str) -> None:
    """The height on the pulse is d less the mean 2 d w, and the tail bounds the difference."""
    load, centre, width, terms = FIGURE_3_27[case]
    top, base = load * (1 - 2 * width), -2 * load * width
    for position, value in ((centre, top), (centre - width, top - load / 2), (0.05, base)):
        miss = abs(harmonic_load(position, load, centre, width, terms) - value)
        assert miss <= harmonic_tail(position, load, centre, width, terms) + 1e-12
    if terms == 1000:
        assert harmonic_load(centre, load, centre, width, terms) == pytest.approx(top, abs=2e-3)


def test_the_limit_is_a_pulse_without_its_mean() -> None:
    load, centre, width = 0.8, 0.6, 0.15
    pulse = np.where(np.abs(POSITIONS - centre) < width, load, 0.0)
    edge = np.isclose(np.abs(POSITIONS - centre), width)
    limit = harmonic_limit(POSITIONS, load, centre, width)
    assert np.allclose((limit + 2 * load * width)[~edge], pulse[~edge], atol=1e-12)


@pytest.mark.parametrize("terms", [50, 500])
def test_gibbs_overshoot_does_not_go_away(terms: int) -> None:
    """The peak is 1 / (P + 1) inside of the jump, and tends to 0.0895 d above the pulse."""
    load, centre, width = 0.5, 0.5, 0.25
    offsets = np.linspace(0.2, 3, 2801) / (terms + 1)
    values = harmonic_load(centre - width + offsets, load, centre, width, terms)
    overshoot = values.max() - load * (1 - 2 * width)
    assert overshoot / load == pytest.approx(WILBRAHAM_GIBBS / math.pi - 0.5, abs=3 / terms)
    assert offsets[np.argmax(values)] * (terms + 1) == pytest.approx(1, abs=0.05)
    middle = harmonic_load(centre - width, load, centre, width, terms)
    assert middle == pytest.approx(load * (0.5 - 2 * width), abs=1 / terms)


@pytest.mark.parametrize("power", [2, 6])
@pytest.mark.parametrize("width", [0.1, 0.2, 0.4])
def test_3_18_at_chosen_points(power: int, width: float) -> None:
    """The points are the centre, the half width at 1 / e, half the height, and one far away."""
    load, centre, steepness = 0.744, 0.5, 2 / width
    at_half = math.log(2) ** (1 / power) / steepness
    for position, value in (
        (centre, load),
        (centre + width / 2, load / math.e),
        (centre - width / 2, load / math.e),
        (centre - at_half, load / 2),
        (centre + 4 * width, 0.0),
    ):
        found = power_load(position, load, centre, steepness, power)
        assert found == pytest.approx(value, abs=1e-12)


DIGIT = thesis_table("digit")


def test_equation_4_19_is_the_network_once_its_factors_are_moved() -> None:
    """It is compared with equation 3.11, on a network whose Q_j and Y_i are all above 1."""
    rng = np.random.default_rng(1)
    w1, b1, w2, b2 = (rng.normal(0, 2, shape) for shape in ((3, 4), 3, (2, 3), 2))
    x = rng.uniform(-1, 1, 4)
    right = Mlp(w1, b1, w2, b2).process(x[np.newaxis])[0]
    q, y = normalisation(w1, b1), normalisation(w2, b2)
    assert (q > 1).all()
    assert (y > 1).all()
    normalised = (w1 / q[:, np.newaxis]) @ x + b1 / q
    weights, biases = w2 / y[:, np.newaxis], b2 / y
    printed = weights @ (np.tanh(normalised) * q) + biases * y
    moved = y * (weights @ np.tanh(q * normalised) + biases)
    np.testing.assert_allclose(moved, right, rtol=1e-12)
    assert (np.abs(printed - right) > 0.1).all()


def test_the_two_top_bits_of_the_scan_counter_of_5_4_4() -> None:
    """The lower one changes at 31.25 kHz and the upper one at 15.625 kHz, the rate of a scan."""
    board = thesis_table("board")
    scan = ScanSequencer(Fix(14, 13), 4, 4, board["scan_counter_bits"], 8)
    address = scan.address_at(np.arange(scan.scan_clocks))
    rises = [int((np.diff(address >> bit & 1, append=0) == 1).sum()) for bit in (0, 1)]
    rates = [1000 * board["clock_mhz"] * count / scan.scan_clocks for count in rises]
    assert rates == [31.25, board["scan_rate_khz"]]


def test_elements_of_5_5_that_a_network_does_not_need() -> None:
    """NN_A, NN_B and NN_C do not need three, two and one of them. NN_D needs all seven."""
    core = load_scene("digit-thesis").twin().core
    needed = [network.inputs for network in core.networks]
    unwanted = [list(range(inputs + 1, needed[-1] + 1)) for inputs in needed]
    assert unwanted == [[5, 6, 7], [6, 7], [7], []]


def test_accuracies_of_the_text_are_not_those_of_the_tables() -> None:
    """These are the width in chapter 7, 85 % for single networks, and 97 % for x in section 6.6."""
    assert DIGIT["cascade_b"]["real_time"][2] < 2.9 == DIGIT["cascade_b"]["simulation"][3]
    assert max(DIGIT["hybrid"]["simulation"]) < 100 - 85 < max(DIGIT["hybrid"]["real_time"])
    swing = [thesis_table(f"swing.{name}")["percent_error"] for name in ("single", "cascade")]
    assert all(error[0] > 100 - 97 for error in swing)
