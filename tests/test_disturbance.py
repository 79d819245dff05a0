"""Tests the noise and the drift of sensors."""

import numpy as np
import pytest

from golden.input_error import InputError
from tactus.scene.disturbance import Disturbance

READINGS = np.linspace(-1, 1, 4000).reshape(1000, 4)


def test_without_any_readings_stay_what_they_are():
    assert Disturbance().none
    np.testing.assert_array_equal(Disturbance().of(READINGS, np.random.default_rng(1)), READINGS)


def test_noise_is_of_every_reading():
    noise = Disturbance(noise=0.002).of(READINGS, np.random.default_rng(1)) - READINGS
    # The standard deviation of 4000 draws is within 5 %, which is more than four of its own
    # deviations.
    assert noise.std() == pytest.approx(0.002, rel=0.05)
    assert abs(np.corrcoef(noise[:-1].ravel(), noise[1:].ravel())[0, 1]) < 0.1


def test_drift_is_one_of_each_sensor():
    changed = Disturbance(gain=0.01, offset=0.02).of(READINGS, np.random.default_rng(1))
    lines = [np.polyfit(READINGS[:, s], changed[:, s], 1) for s in range(4)]
    for s, line in enumerate(lines):
        np.testing.assert_allclose(np.polyval(line, READINGS[:, s]), changed[:, s], atol=1e-12)
    assert len({round(gain, 6) for gain, _ in lines}) == 4
    assert len({round(offset, 6) for _, offset in lines}) == 4


def test_draws_do_not_depend_on_the_sizes():
    small, large = (
        Disturbance(noise=size).of(READINGS, np.random.default_rng(7)) - READINGS
        for size in (1e-3, 2e-3)
    )
    np.testing.assert_allclose(2 * small, large, atol=1e-15)


@pytest.mark.parametrize("size", [-1e-3, float("nan"), float("inf"), 1e3])
@pytest.mark.parametrize("what", ["noise", "gain", "offset"])
def test_a_size_that_cannot_be_is_refused(what, size):
    with pytest.raises(InputError, match=what):
        Disturbance(**{what: size})
