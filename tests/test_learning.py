"""Tests the rule by which an engine learns: their arithmetic, and what they never do."""

import numpy as np
import pytest
from pages import cells, section

from golden.engine.integer_network import evaluate
from golden.learning import steps
from golden.learning.corrected import THETA, Corrected
from golden.learning.gradient import Gradient
from golden.learning.lesson import Lesson, bounded, start
from golden.learning.unit import Unit
from golden.numbers.precision import SIGNAL
from tactus.recalibration.sensitivity import Sensitivity
from tactus.scene import load_scene

SCENE = load_scene("digit")
VECTORS = SCENE.vectors()
TARGETS = SIGNAL.quantise(VECTORS.targets)[0]


@pytest.fixture(scope="module")
def taught() -> Corrected:
    recorded = Sensitivity.of(SCENE, np.zeros(len(SCENE.sensors)))
    return Corrected.of(SCENE.mlps(), recorded.gain, recorded.offset)


@pytest.fixture(scope="module")
def recording() -> Lesson:
    """Every row of the recording as the one placement of a drift of its own, without any drift."""
    return Lesson(VECTORS.codes[:, np.newaxis], TARGETS[:, np.newaxis])


def test_without_a_correction_the_networks_are_those_of_the_scene(taught: Corrected) -> None:
    theta = np.zeros((len(VECTORS.codes), 2 * taught.sensors), dtype=np.int64)
    outputs = taught.process(theta, VECTORS.codes)
    np.testing.assert_array_equal(outputs, evaluate(taught.networks, VECTORS.codes))
    np.testing.assert_array_equal(outputs, SCENE.twin().process(VECTORS.codes))


@pytest.mark.parametrize("output", range(4))
def test_derivatives_are_those_of_the_network(
    taught: Corrected, recording: Lesson, output: int
) -> None:
    """By calculus on the trained network, which reads known outputs in front of it."""
    unit = Unit(recording.drifts)
    hidden = recording.hidden(taught, start(recording, taught), 0, output, unit)
    found = taught.slopes(output, hidden, unit) / 2**14
    mlp = SCENE.mlps()[output]
    seen = np.hstack([SIGNAL.to_real(VECTORS.codes), SIGNAL.to_real(TARGETS)[:, :output]])
    h = np.tanh(seen @ mlp.w1.T + mlp.b1)
    expected = ((mlp.w2 * (1 - h * h)) @ mlp.w1)[:, :4]
    np.testing.assert_allclose(found, expected, atol=0.02)
    assert np.abs(expected).max() > 0.5


def test_a_program_of_steps_learns_bit_for_bit_the_same(taught: Corrected) -> None:
    """Also where steps are refused: the third placement asks for the impossible."""
    lesson = dead_sensor(3)
    lesson.targets[0, 2] = SIGNAL.high
    rate = np.array([[20000, 3], [30000, 0], [90000, 70], [60000, 1]])
    program, rule = steps.lms(taught, rate.tolist()), Gradient(taught, rate)
    run = steps.Run(taught, program, [0] * 8)
    unit, theta = Unit(1), start(lesson, taught)
    for _ in range(60):
        for placement in range(len(lesson)):
            run.show(lesson, placement)
            for output in range(taught.outputs):
                theta = rule.step(lesson, theta, placement, output, unit)
            np.testing.assert_array_equal(run.theta, theta[0])
    assert run.flags == unit.saturated["step"][0] > 0
    counted = steps.counted(program)
    # A bias that does not fit in a weight is two steps, as in any program.
    ones = [sum(t.kind is steps.Kind.ONE for t in one.terms) for p in program for one in p]
    assert sum(counted.values()) == unit.steps / (60 * 3) + ones.count(2)
    page = section("learning", "As a program of an engine")
    for kind in steps.Kind:
        assert cells(page, kind.value)[0] == str(counted[kind])


def dead_sensor(placements: int) -> Lesson:
    """Placements of the recording that a sensor at the end of its range takes no part in."""
    rows = np.random.default_rng(1).integers(0, len(TARGETS), (1, placements))
    samples = VECTORS.codes[rows]
    samples[..., 2] = SIGNAL.high
    return Lesson(samples, TARGETS[rows])


def test_a_step_that_does_not_fit_is_not_taken_and_flagged() -> None:
    theta = np.array([[0, THETA.high - 1], [5, THETA.low]])
    unit = Unit(2)
    found = bounded(theta, theta + np.array([[3, 1], [3, -1]]), unit)
    np.testing.assert_array_equal(found, [[3, THETA.high], [5, THETA.low]])
    np.testing.assert_array_equal(unit.saturated["step"], [0, 1])
