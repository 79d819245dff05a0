"""Tests the rule by which an engine learns: their arithmetic, and what they never do."""

from collections import Counter

import numpy as np
import pytest
from pages import cells, section

from golden.engine.integer_network import evaluate
from golden.learning import steps
from golden.learning.corrected import THETA, Corrected
from golden.learning.gradient import Lesson, bounded, start
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
    hidden = recording.hidden(taught, start(recording, taught), 0, output)
    found = taught.slopes(output, hidden) / 2**14
    mlp = SCENE.mlps()[output]
    seen = np.hstack([SIGNAL.to_real(VECTORS.codes), SIGNAL.to_real(TARGETS)[:, :output]])
    h = np.tanh(seen @ mlp.w1.T + mlp.b1)
    expected = ((mlp.w2 * (1 - h * h)) @ mlp.w1)[:, :4]
    np.testing.assert_allclose(found, expected, atol=0.02)
    assert np.abs(expected).max() > 0.5


def test_the_page_counts_the_steps_of_a_pass(taught: Corrected) -> None:
    program = steps.lms(taught, [[20000, 3], [30000, 0], [90000, 70], [60000, 1]])
    counted = Counter(term.kind for sums in program for one in sums for term in one.terms)
    page = section("learning", "As a program of an engine")
    for kind in steps.Kind:
        assert cells(page, kind.value)[0] == str(counted[kind])


def test_a_step_that_does_not_fit_is_not_taken_and_flagged() -> None:
    theta = np.array([[0, THETA.high - 1], [5, THETA.low]])
    found, taken = bounded(theta, theta + np.array([[3, 1], [3, -1]]))
    np.testing.assert_array_equal(found, [[3, THETA.high], [5, THETA.low]])
    np.testing.assert_array_equal(taken, [True, False])
