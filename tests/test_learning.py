"""Tests the rules by which an engine could learn: their arithmetic, and what they never do."""

from collections.abc import Sequence

import numpy as np
import pytest
from conftest import tiered

from golden.dense import layers_of
from golden.engine.finish import word_of
from golden.engine.formats import SAMPLE_SHIFT
from golden.engine.integer_network import evaluate
from golden.fixed import Codes, Fix
from golden.input_error import InputError
from golden.learning import costs, steps
from golden.learning.conjugate import Conjugate
from golden.learning.corrected import THETA, Corrected
from golden.learning.gradient import LENGTH, STEP, Gradient, constants
from golden.learning.lesson import ROW, Lesson, bounded, by_differences, equation, start
from golden.learning.noise import Noise
from golden.learning.output_layers import OutputLayers, trained
from golden.learning.perturbation import OVER_R, Perturbation
from golden.learning.recursive import SQUARE, Recursive, root_of
from golden.learning.unit import Unit, coefficient
from golden.mlp import Mlp
from golden.precision import SIGNAL
from golden.recalibration.sensitivity import Sensitivity
from golden.scene import load_scene
from tb.report.measure.on_line_learning import Learner

SCENE = load_scene("digit")
VECTORS = SCENE.vectors()
TARGETS = SIGNAL.quantise(VECTORS.targets)[0]
# No engine has a wider accumulator.
MOST_BITS = 48


@pytest.fixture(scope="module")
def taught() -> Corrected:
    recorded = Sensitivity.of(SCENE, np.zeros(len(SCENE.sensors)))
    return Corrected.of(SCENE.mlps(), recorded.gain, recorded.offset)


@pytest.fixture(scope="module")
def recording() -> Lesson:
    """Every row of the recording as the one placement of a drift of its own, without any drift."""
    return Lesson(VECTORS.codes[:, np.newaxis], TARGETS[:, np.newaxis])


def squares(drifts: int, fmt: Fix, root: float = 0.004) -> Codes:
    """The same r^2 for all outputs and drifts."""
    return np.full((drifts, len(SCENE.outputs)), max(1, round(root**2 * 2.0**fmt.frac)))


def rules(taught: Corrected, drifts: int) -> dict[str, tuple[Learner, int]]:
    """The rules that could be built, with the passes of a test."""
    fine = squares(drifts, Fix(62, SQUARE))
    damping = squares(drifts, LENGTH)
    over = np.full((drifts, taught.outputs), 250 << OVER_R)
    # Half of what no equation of the recording overshoots with.
    steps = STEP.quantise(0.5 / np.array([0.151, 0.091, 0.019, 0.042]))[0]
    rate = np.stack([steps, np.ones_like(steps)], axis=1)
    return {
        "LMS": (Gradient(taught, 0, damping, rate), 2),
        "Kaczmarz": (Gradient(taught, 3, damping), 2),
        "wide": (Gradient(taught, 3, damping, wide=True), 2),
        "square root": (Recursive(taught, fine, 18, root=True), 2),
        "covariance": (Recursive(taught, fine, 18, root=False), 1),
        "perturbation": (Perturbation(taught, over, 1), 4),
    }


def test_without_a_correction_the_networks_are_those_of_the_scene(taught: Corrected) -> None:
    theta = np.zeros((len(VECTORS.codes), 2 * taught.sensors), dtype=np.int64)
    outputs = taught.process(theta, VECTORS.codes)
    np.testing.assert_array_equal(outputs, evaluate(taught.networks, VECTORS.codes))
    np.testing.assert_array_equal(outputs, SCENE.twin().process(VECTORS.codes))


def test_a_correction_is_gain_and_offset(taught: Corrected) -> None:
    rng = np.random.default_rng(1)
    theta = rng.integers(THETA.low, THETA.high + 1, (50, 8))
    samples = rng.integers(-6000, 6000, (50, 4))
    z = taught.samples(theta, samples << SAMPLE_SHIFT, Unit(50)) / 2**16
    by_gain, by_offset = np.split(THETA.to_real(theta), 2, axis=1)
    recorded = Sensitivity.of(SCENE, np.zeros(4))
    x = SIGNAL.to_real(samples)
    expected = x * (1 + recorded.gain * by_gain) + recorded.offset * by_offset
    np.testing.assert_allclose(z, expected, atol=8e-5)


def test_a_word_is_that_of_an_engine() -> None:
    sums = np.random.default_rng(1).integers(-(1 << 33), 1 << 33, (1, 1000))
    unit = Unit(1)
    words = unit.word("some", sums, 3)
    np.testing.assert_array_equal(words, word_of(sums + (1 << 13), 0))
    assert unit.saturated["some"] == np.sum((sums + (1 << 13) >> 14) != words) > 0
    assert (unit.steps, unit.clocks, unit.words["some"]) == (3000, 3008, 1000)


def test_quotients_round_towards_zero_and_no_denominator_is_below_one() -> None:
    unit = Unit(1)
    found = unit.quotient("q", np.array([[7, -7, 5, 1 << 40]]), np.array([[2, 2, 0, 1]]))
    np.testing.assert_array_equal(found, [[3, -3, 5, (1 << 17) - 1]])
    assert unit.saturated["q"] == 1
    assert unit.saturated["q, denominator"] == 1


def test_roots_are_exact() -> None:
    roots = np.random.default_rng(1).integers(1, 1 << 30, 1000)
    for shift in (-1, 0, 1):
        squares = roots * roots + shift
        found = root_of(squares)
        assert (found * found <= squares).all()
        assert ((found + 1) ** 2 > squares).all()


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


def test_differences_are_near_derivatives(taught: Corrected, recording: Lesson) -> None:
    unit, theta = Unit(recording.drifts), start(recording, taught)
    for output in range(taught.outputs):
        exact = equation(taught, recording, theta, 0, output, unit)
        near = by_differences(taught, recording, theta, 0, output, unit)
        np.testing.assert_array_equal(near.error, exact.error)
        off = np.sqrt(np.mean((near.row - exact.row) ** 2.0))
        assert off < 0.25 * np.sqrt(np.mean(exact.row**2.0))


def test_an_equation_says_how_far_theta_is(taught: Corrected, recording: Lesson) -> None:
    """Near the theta that is sought: the error is the row times what is missing."""
    unit = Unit(recording.drifts)
    theta = np.random.default_rng(1).integers(-800, 800, (recording.drifts, 8))
    for output in range(taught.outputs):
        at, there = (
            equation(taught, recording, one, 0, output, unit) for one in (0 * theta, theta)
        )
        change = (at.error - there.error) / 2**17
        expected = (ROW.to_real(at.row) * THETA.to_real(theta)).sum(axis=1)
        assert np.corrcoef(change, expected)[0, 1] > 0.95


def test_formulas_count_the_steps(taught: Corrected, recording: Lesson) -> None:
    drifts = recording.drifts
    expected = [
        costs.equation_steps(4, output, len(layers_of(mlp)[0].biases))
        for output, mlp in enumerate(SCENE.mlps())
    ]
    assert sum(expected) == 484
    for name, more in (
        ("LMS", costs.lms_steps(8)),
        ("Kaczmarz", costs.kaczmarz_steps(8)),
        ("square root", costs.square_root_steps(8)),
    ):
        rule, _ = rules(taught, drifts)[name]
        unit = Unit(drifts)
        rule.learn(recording, 1, unit)
        assert unit.steps == sum(expected) + 4 * more


@pytest.mark.parametrize("name", ["LMS", "Kaczmarz"])
def test_a_program_of_steps_learns_bit_for_bit_the_same(taught: Corrected, name: str) -> None:
    """Also where steps are refused: the third placement asks for the impossible."""
    lesson = adversarial("dead", 1, 3)
    lesson.targets[0, 2] = SIGNAL.high
    noise, rate = (
        np.array([[40, 30, 20, 10]]),
        np.array([[20000, 3], [30000, 0], [90000, 70], [60000, 1]]),
    )
    if name == "LMS":
        program = steps.lms(taught, rate.tolist())
        rule = Gradient(taught, 0, noise, rate)
    else:
        program = steps.kaczmarz(taught, noise[0].tolist(), 0)
        rule = Gradient(taught, 0, noise)
    run = steps.Run(taught, program, [0] * 8)
    unit, kept = Unit(1), start(lesson, taught)
    for _ in range(60):
        for placement in range(len(lesson)):
            run.show(lesson, placement)
            for output in range(taught.outputs):
                kept = rule.step(lesson, kept, placement, output, unit)
            np.testing.assert_array_equal(run.theta, kept[0])
    assert run.flags == unit.saturated["step"][0] > 0
    counted = steps.counted(program)
    # A bias that does not fit in a weight is two steps, as in any program.
    ones = [sum(t.kind is steps.Kind.ONE for t in one.terms) for p in program for one in p]
    assert sum(counted.values()) == unit.steps / (60 * 3) + ones.count(2)
    assert counted[steps.Kind.QUOTIENT] == (4 if name == "Kaczmarz" else 0)


def adversarial(kind: str, drifts: int, placements: int) -> Lesson:
    """Placements that no sensor and no load would give."""
    rng = np.random.default_rng([drifts, placements])
    samples = rng.integers(SIGNAL.low, SIGNAL.high + 1, (drifts, placements, 4))
    targets = rng.integers(SIGNAL.low, SIGNAL.high + 1, (drifts, placements, 4))
    rows = rng.integers(0, len(TARGETS), (drifts, placements))
    if kind == "contradicting":
        samples = np.repeat(VECTORS.codes[rows[:, :1]], placements, axis=1)
    elif kind == "dead":
        samples, targets = VECTORS.codes[rows], TARGETS[rows]
        dead = rng.integers(0, 4, drifts)
        ends = np.array([SIGNAL.low, 0, SIGNAL.high])[rng.integers(0, 3, drifts)]
        samples[np.arange(drifts), :, dead] = ends[:, np.newaxis]
    elif kind == "ends":
        samples = VECTORS.codes[rows]
        targets = np.where(targets < 0, SIGNAL.low, SIGNAL.high)
    return Lesson(samples, targets)


KINDS = ("random", "contradicting", "dead", "ends")
NAMES = ("LMS", "Kaczmarz", "wide", "square root", "covariance", "perturbation")
# Equations are drifts times placements, times four outputs, times passes. The rules that could be
# built see more than a million of each kind with ALL=1.
CASES = tiered(
    [(name, 50, 12) for name in NAMES],
    [(name, 3000, 45) for name in ("LMS", "square root")],
)


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case[0]}-{case[1]}")
@pytest.mark.parametrize("kind", KINDS)
def test_no_word_leaves_its_format(
    taught: Corrected, kind: str, case: tuple[str, int, int]
) -> None:
    """Whatever is shown: theta stays in its format, and no sum is wider than an accumulator."""
    name, drifts, placements = case
    lesson = adversarial(kind, drifts, placements if name != "perturbation" else 4)
    rule, passes = rules(taught, drifts)[name]
    unit = Unit(drifts)
    theta = rule.learn(lesson, passes, unit)
    THETA.check(theta)
    assert unit.bits <= MOST_BITS
    # It did learn.
    assert np.abs(theta).max() > 1 << (THETA.frac - 3)
    if name == "square root":
        assert not unit.saturated["d^2"].any()


def test_a_step_that_does_not_fit_is_not_taken_and_flagged() -> None:
    theta = np.array([[0, THETA.high - 1], [5, THETA.low]])
    unit = Unit(2)
    found = bounded(theta, theta + np.array([[3, 1], [3, -1]]), unit)
    np.testing.assert_array_equal(found, [[3, THETA.high], [5, THETA.low]])
    np.testing.assert_array_equal(unit.saturated["step"], [0, 1])


def test_steps_are_refused_at_the_end_of_theta(taught: Corrected) -> None:
    """A target that no correction reaches drives theta to its end, where steps are refused."""
    drifts = 20
    lesson = adversarial("ends", drifts, 4)
    lesson = Lesson(lesson.samples, np.full_like(lesson.targets, SIGNAL.high))
    unit = Unit(drifts)
    theta = Gradient(taught, 0, squares(drifts, LENGTH)).learn(lesson, 100, unit)
    THETA.check(theta)
    assert unit.saturated["step"].sum() > 0
    assert np.abs(theta).max() > 0.9 * THETA.high


def test_a_square_root_stays_positive_where_a_covariance_does_not(taught: Corrected) -> None:
    """With a noise of almost nothing, and the same placement over and over."""
    drifts = 30
    lesson = adversarial("contradicting", drifts, 40)
    tiny = np.full((drifts, 4), 4)
    lost = {}
    for root in (True, False):
        unit = Unit(drifts)
        Recursive(taught, tiny, 18, root).learn(lesson, 1, unit)
        lost[root] = int(unit.saturated["d^2"].sum())
    assert lost[True] == 0 < lost[False]


def drifted(drifts: int, placements: int) -> tuple[Lesson, Codes]:
    """Placements of the recording under drifts, and the whole recording."""
    rng = np.random.default_rng(5)
    x = VECTORS.inputs * (1 + 0.03 * rng.standard_normal((drifts, 1, 4)))
    codes = SIGNAL.quantise(x + 0.02 * rng.standard_normal((drifts, 1, 4)))[0]
    rows = np.array([rng.permutation(len(TARGETS))[:placements] for _ in range(drifts)])
    return Lesson(np.take_along_axis(codes, rows[..., np.newaxis], 1), TARGETS[rows]), codes


def test_what_placements_do_not_tell_is_not_learned(taught: Corrected) -> None:
    """Theta stays near a drift of -2 % however often two placements are shown that are alike.

    The networks have errors of their own here, of about 1 %, which no drift explains.
    """
    wrong = 0.01 * np.random.default_rng(1).standard_normal(TARGETS.shape)
    known = SIGNAL.quantise(VECTORS.targets + wrong)[0]
    rule = Gradient(taught, 0, squares(12, LENGTH), constants(taught, VECTORS.codes, known))
    apart = np.abs(VECTORS.inputs[:, np.newaxis] - VECTORS.inputs).sum(axis=-1)
    rows = apart.argsort(axis=1)[::4, :2]
    lesson = Lesson(SIGNAL.quantise(0.98 * VECTORS.inputs)[0][rows], known[rows])
    few, many = (np.abs(rule.learn(lesson, n, Unit(len(rows)))).max() for n in (50, 150))
    assert many < 1.1 * few < THETA.quantise(1.0)[0]


def errors(outputs: Sequence[Codes]) -> float:
    """The mean error of outputs of the whole recording, in percent."""
    return float(np.mean([VECTORS.percent_errors(SIGNAL.to_real(one)) for one in outputs]))


@pytest.mark.parametrize(
    ("name", "passes", "part"),
    [
        ("LMS", 20, 0.4),
        ("Kaczmarz", 20, 0.35),
        ("wide", 20, 0.35),
        ("square root", 1, 0.25),
        ("covariance", 1, 0.25),
        ("perturbation", 150, 0.6),
    ],
)
def test_a_rule_takes_most_of_a_drift_away(
    taught: Corrected, name: str, passes: int, part: float
) -> None:
    drifts = 4
    lesson, codes = drifted(drifts, 12)
    before = errors([evaluate(taught.networks, one) for one in codes])
    rule, _ = rules(taught, drifts)[name]
    theta = rule.learn(lesson, passes, Unit(drifts))
    outputs = [
        taught.process(np.broadcast_to(one, (len(rows), 8)), rows)
        for one, rows in zip(theta, codes, strict=True)
    ]
    assert errors(outputs) < part * before


def test_conjugate_gradients_need_36_bits(taught: Corrected) -> None:
    drifts = 4
    lesson, codes = drifted(drifts, 12)
    found = {}
    for width in (18, 36):
        unit = Unit(drifts)
        rule = Conjugate(taught, squares(drifts, Fix(62, SQUARE), 0.002), width)
        theta = rule.learn(lesson, 2, unit)
        outputs = [
            taught.process(np.broadcast_to(one, (len(rows), 8)), rows)
            for one, rows in zip(theta, codes, strict=True)
        ]
        found[width] = errors(outputs), int(unit.saturated["alpha"].sum())
    assert found[36][0] < found[18][0]
    assert found[36][1] == 0 < found[18][1]


def test_output_layers_begin_as_they_were_trained(taught: Corrected) -> None:
    layers = OutputLayers(taught)
    weights = [trained(taught, output)[np.newaxis] for output in range(taught.outputs)]
    found = layers.process(weights, VECTORS.codes[np.newaxis])[0]
    near = np.abs(found - evaluate(taught.networks, VECTORS.codes))
    assert near.max() < 40 < 1 << 13
    for output, one in enumerate(weights):
        w2, b2 = SCENE.mlps()[output].w2, SCENE.mlps()[output].b2
        np.testing.assert_allclose(one[0] / 2**14, [*w2[0], b2[0]], atol=2e-4)


def test_output_layers_learn_too(taught: Corrected) -> None:
    drifts = 4
    lesson, codes = drifted(drifts, 12)
    before = errors([evaluate(taught.networks, one) for one in codes])
    for layers, passes in ((OutputLayers(taught, 0), 5), (OutputLayers(taught, 3, wide=True), 10)):
        learned = layers.learn(lesson, passes, Unit(drifts))
        assert errors(list(layers.process(learned, codes))) < 0.9 * before


def test_noise_is_that_of_the_recording(taught: Corrected) -> None:
    found = Noise.of(taught, VECTORS)
    quiet = found.squares(np.zeros(1), Fix(62, SQUARE))
    noisy = found.squares(np.full(1, 0.002), Fix(62, SQUARE))
    assert (noisy > quiet).all()
    np.testing.assert_allclose(quiet[0] / 2.0**SQUARE, found.own, rtol=1e-3)
    scale = VECTORS.scale.mean(axis=0)
    percent = 100 * np.sqrt(found.own) / scale
    assert (percent < 0.5).all()


def test_a_network_that_is_not_studied_is_refused(taught: Corrected) -> None:
    one = Mlp(np.ones((2, 4)), np.zeros(2), np.ones((2, 2)) / 4, np.zeros(2))
    with pytest.raises(InputError, match=r"network 1: got 2 layers and 2 outputs, expected one"):
        Corrected.of([one], np.ones(4) / 20, np.ones(4) / 50)


def test_short_words_are_exact_for_samples() -> None:
    codes = np.arange(SIGNAL.low, SIGNAL.high + 1)
    np.testing.assert_array_equal(coefficient(codes << SAMPLE_SHIFT), codes)
