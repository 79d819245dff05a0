"""Compares the bit-true profile of equation 3.18 with real arithmetic, also at extremes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from golden.input_error import InputError
from golden.numbers.precision import SIGNAL
from golden.visualisation.load_profile import RECTANGLE, TRIANGLE, LoadProfile, load_profile, ramp
from golden.visualisation.power_fold import PowerFold
from tactus.core.table import read_table
from tactus.scene import load_scene
from tactus.verify.benches.written import write_scene
from tb.common.cases import VISUALISATION, random_mlp

APPENDIX_2 = Path(__file__).parents[1] / "scenes" / "data" / "appendix2.csv"
PROFILE = load_profile()
LSB = 2.0**-13


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


EXTREME = [SIGNAL.low, SIGNAL.low + 1, -1, 0, 1, 2, 5529, 5530, SIGNAL.high - 1, SIGNAL.high]


def test_the_bound_over_extremes_of_every_input() -> None:
    frames = np.stack(np.meshgrid(*[EXTREME] * 4, indexing="ij"), axis=-1)
    assert units(frames) < 1.81


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


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: ramp(SIGNAL, 0.05, 1.0), "ramp: got positions from 0 to 8192"),
        (lambda: ramp(SIGNAL, 0.05, 0.82), "expected a whole number of steps"),
        (lambda: ramp(SIGNAL, 0.05, float("inf")), "ramp: 0 to inf in steps of"),
        (lambda: ramp(SIGNAL, -0.05, 0.8), "in steps of -0.05, expected a whole number of steps"),
        (lambda: ramp(SIGNAL, 0.05, 0.8, 0.9), "expected a whole number of steps upwards"),
        (lambda: ramp(SIGNAL, 0.05, 0.0), "ramp: 0 to 0 in steps of"),
        (lambda: ramp(SIGNAL, 0.5, 0.5, -1.5), "got positions from -12288 to 4096, expected"),
        (lambda: ramp(SIGNAL, 0.001, 0.5, -1.0), "1501 points with guard=17, which take 31 bits"),
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


def test_a_scene_names_what_is_drawn(tmp_path: Path) -> None:
    section = VISUALISATION.replace("y0", "y4") + "start = -0.2\nstep = 0.25\n"
    network = random_mlp((2, 3, 5), 1.0, 1)
    scene = load_scene(str(write_scene(tmp_path, "drawn", "exact", [network], sections=section)))
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
