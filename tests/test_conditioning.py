"""Tests the way from deflection to code: sensor, DC remover, gain, clipping, ADC."""

import math

import numpy as np
import pytest

from golden.input_error import InputError
from golden.numbers.precision import SIGNAL
from tactus.physics.conditioning import (
    CUTOFF,
    Conditioning,
    LowPass,
    ReflectiveSensor,
)

TIME = np.arange(20_000) / 200


def rng() -> np.random.Generator:
    return np.random.default_rng(1)


def amplitude(hertz: float) -> float:
    """The amplitude of a sine of 1 V after the high pass, when it has settled."""
    passed = Conditioning(1.0).amplify(np.sin(2 * math.pi * hertz * TIME), 0.0)
    return float(np.sqrt(2 * (passed[len(TIME) // 2 :] ** 2).mean()))


def test_the_parts_of_section_6_4_2_give_its_cutoff() -> None:
    assert 1 / (2 * math.pi * 560e3 * 4.7e-6) == pytest.approx(CUTOFF, rel=0.01)


@pytest.mark.parametrize("hertz", [0.06, 0.7, 5.0])
def test_the_high_pass_is_first_order(hertz: float) -> None:
    expected = 1 / math.sqrt(1 + (CUTOFF / hertz) ** 2)
    assert amplitude(hertz) == pytest.approx(expected, rel=2e-3)


def test_gain_clipping_and_quantisation() -> None:
    volts = np.array([0.0, 0.01, 0.05, 0.2, -0.2])
    codes, clipped = Conditioning(10, cutoff=0).convert(volts, 0.0)
    assert codes.tolist() == [0, 819, 4096, SIGNAL.high, SIGNAL.low]
    assert clipped == 2


def test_the_sensor_is_linear_within_its_range_and_flat_beyond() -> None:
    sensor = ReflectiveSensor(rest=4.0, sensitivity=500, linear=1e-3)
    assert sensor.read([0, 4e-4, -1e-3, 1e-3, 2e-3, -5], rng()) == pytest.approx(
        [4.0, 4.2, 3.5, 4.5, 4.5, 3.5]
    )


def test_the_low_pass_is_first_order_and_leaves_the_noise_that_it_says() -> None:
    filtered = LowPass(cutoff=25.0, rate=1000.0)
    time = np.arange(20_000) / 1000
    for hertz in (2.5, 25.0):
        passed = filtered.passed(np.sin(2 * math.pi * hertz * time))[10_000:]
        expected = 1 / math.sqrt(1 + (hertz / 25) ** 2)
        assert np.sqrt(2 * (passed**2).mean()) == pytest.approx(expected, rel=2e-3)
    # For white noise this is the sum of the squares of the impulse response.
    impulse = filtered.passed(np.r_[0.0, 1.0, np.zeros(5000)])
    assert math.sqrt((impulse**2).sum()) == pytest.approx(filtered.noise_left, rel=1e-9)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: ReflectiveSensor(linear=0), "linear: got 0, expected 1e-06 to 1"),
        (lambda: ReflectiveSensor(noise=-1), "noise: got -1, expected 0 to 10"),
        (lambda: ReflectiveSensor().read([np.nan], rng()), "deflection: got nan"),
        (lambda: Conditioning(1, cutoff=100), "cutoff: got 100, expected 0 to 99.8"),
        (lambda: Conditioning(1).amplify([np.inf], 0), "volts: got inf"),
        (lambda: Conditioning(1).amplify([], 0), r"volts: got shape \(0,\), expected \(n,\)"),
        (lambda: LowPass(cutoff=0), "cutoff: got 0, expected 1e-06 to "),
        (lambda: LowPass(rate=50), "cutoff: got 25"),
        (lambda: LowPass().passed([]), r"volts: got shape \(0,\), expected \(n,\)"),
        (lambda: LowPass().passed([0, np.nan]), "volts: got nan"),
        (lambda: LowPass().settling(0), "part: got 0"),
    ],
)
def test_what_lies_outside_the_model_is_refused(call, message: str) -> None:
    with pytest.raises(InputError, match=message):
        call()
