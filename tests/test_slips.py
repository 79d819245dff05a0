"""Tests slips of the thesis without another test: what is printed, and what is right."""

import numpy as np

from golden.numbers.fixed import Fix
from golden.numbers.precision import normalisation
from golden.sensing.scan_sequencer import ScanSequencer
from golden.trained.mlp import Mlp
from tactus.scene import load_scene
from tactus.scene.data import thesis_table

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
