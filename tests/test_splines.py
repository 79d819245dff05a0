"""Tests networks of learned functions: their splines, derivatives, training and pruning."""

import numpy as np
import pytest
from derivatives import differences
from scipy.interpolate import BSpline

from golden.input_error import InputError
from golden.numbers.real import Real
from golden.trained.spline_basis import Basis
from tactus.train.descent.objective import Rows
from tactus.train.splines.descent import descend, stopped_early
from tactus.train.splines.edges import CURVED, FLAT, STRAIGHT, Edges
from tactus.train.splines.loss import CrossEntropy, Squares
from tactus.train.splines.network import SplineNetwork, starting
from tactus.train.splines.objective import Penalty, SplineObjective
from tactus.train.splines.training import Learned, SplineSettings, pruned, refitted, trained

BASIS = Basis(-0.5, 1.5, 4)


def network(nodes: int = 2, outputs: int = 2, seed: int = 1) -> SplineNetwork:
    bases = (BASIS, Basis(-1.0, 1.0, 4), Basis(0.0, 1.0, 4))
    return starting(bases, 5, nodes, outputs, np.random.default_rng(seed))


def rows(count: int = 40, outputs: int = 2, seed: int = 2) -> Rows:
    rng = np.random.default_rng(seed)
    inputs = rng.uniform(-1, 1.5, (count, 3))
    return Rows(inputs, rng.normal(size=(count, outputs)), rng.uniform(0.5, 2, (count, outputs)))


def curve(count: int, seed: int, noise: float = 0.0) -> Rows:
    """Rows of a law of two of three inputs; the third tells nothing."""
    rng = np.random.default_rng(seed)
    inputs = rng.uniform(-1, 1, (count, 3))
    targets = np.exp(0.8 * inputs[:, :1] ** 2 + 0.5 * inputs[:, 1:2]) - 1
    return Rows(inputs, targets + noise * rng.normal(size=targets.shape), np.ones((count, 1)))


def rms(model, given: Rows) -> float:
    return float(np.sqrt(((model.process(given.inputs) - given.targets) ** 2).mean()))


def test_the_splines_are_those_of_scipy() -> None:
    knots = BASIS.low + BASIS.width * np.arange(-3, BASIS.intervals + 4)
    x = np.linspace(BASIS.low, BASIS.high, 50)[:-1]
    values, slopes = BASIS.at(x)
    expected = BSpline(knots, np.eye(BASIS.count), 3)
    np.testing.assert_allclose(values, expected(x), atol=1e-12)
    np.testing.assert_allclose(slopes, expected.derivative()(x), atol=1e-12)
    np.testing.assert_allclose(BASIS.bends(x), expected.derivative(2)(x), atol=1e-11)


@pytest.mark.parametrize(
    ("given", "message"),
    [((1.0, 1.0, 4), "expected low < high"), ((0.0, 1.0, 0), "intervals: got 0")],
)
def test_an_impossible_basis_is_refused(given, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Basis(*given)


@pytest.mark.parametrize("word_error", [0.0, 0.3])
@pytest.mark.parametrize("kind", [FLAT, STRAIGHT, CURVED])
def test_derivatives_are_differences(kind: int, word_error: float) -> None:
    like = network()
    edges = Edges.curved(like.shape).with_kind(1, kind).with_kind(7, min(kind + 1, CURVED))
    freedom = edges.freedom(like)
    aim = SplineObjective(like, rows(), Penalty(0.3, 0.01), freedom, Squares(), word_error)
    point: Real = np.asarray(np.linalg.lstsq(freedom, like.packed())[0], dtype=np.float64)
    value, gradient, hessian = aim.value_gradient_hessian(point)
    assert value == pytest.approx(aim.value(point))
    np.testing.assert_allclose(2 * gradient, differences(aim.value, point), atol=1e-6)
    if not word_error:
        slopes = differences(lambda p: aim.errors(p).ravel(), point)
        np.testing.assert_allclose(hessian, slopes @ slopes.T + aim.stiffness, atol=1e-6)


def labelled(count: int = 40, classes: int = 3, seed: int = 2) -> Rows:
    """Rows of random classes."""
    rng = np.random.default_rng(seed)
    targets = np.eye(classes)[rng.integers(0, classes, count)]
    return Rows(rng.uniform(-1, 1.5, (count, 3)), targets, np.ones_like(targets))


@pytest.mark.parametrize("kind", [FLAT, STRAIGHT, CURVED])
def test_the_gradient_for_classes_is_the_differences(kind: int) -> None:
    like = network(outputs=3)
    edges = Edges.curved(like.shape).with_kind(1, kind)
    freedom = edges.freedom(like)
    given = labelled()
    aim = SplineObjective(like, given, Penalty(0.3, 0.01), freedom, CrossEntropy())
    point: Real = np.asarray(np.linalg.lstsq(freedom, like.packed())[0], dtype=np.float64)
    logits = aim.network(point).process(given.inputs)
    parts = np.exp(logits) / np.exp(logits).sum(axis=1, keepdims=True)
    entropy = -np.log(parts[given.targets == 1]).sum()
    assert aim.value(point) == pytest.approx(entropy + point @ aim.stiffness @ point)
    value, gradient, hessian = aim.value_gradient_hessian(point)
    assert value == pytest.approx(aim.value(point))
    np.testing.assert_allclose(2 * gradient, differences(aim.value, point), atol=1e-6)
    expected = aim.stiffness.copy()
    slopes = differences(lambda p: aim.network(p).process(given.inputs), point)
    for row, by_row in zip(parts, np.moveaxis(slopes, 0, -1), strict=True):
        expected += by_row.T @ (np.diag(row) - np.outer(row, row)) @ by_row / 2
    np.testing.assert_allclose(hessian, expected, atol=1e-6)


def test_classes_are_learned_and_pruned() -> None:
    """A class is decided by one input of three, of which the others tell nothing."""
    rng = np.random.default_rng(4)

    def drawn(count: int) -> Rows:
        inputs = rng.uniform(-1, 1, (count, 3))
        inside = np.abs(inputs[:, 0]) + 0.1 * rng.normal(size=count) < 0.5
        targets = np.eye(2)[inside.astype(int)]
        return Rows(inputs, targets, np.ones_like(targets))

    parts = drawn(200), drawn(200)
    settings = SplineSettings(1, 4, 4, 0.1, 0.1, loss=CrossEntropy())
    found = trained(settings, np.random.default_rng(1), *parts)
    less = pruned(found, *parts, Learned.error)
    for one in (found, less):
        wrong = one.process(parts[1].inputs).argmax(axis=1) != parts[1].targets.argmax(axis=1)
        assert wrong.mean() < 0.15
    assert found.edges.first.tolist() == [[CURVED] * 3]
    assert less.edges.first.tolist() == [[CURVED, FLAT, FLAT]]
    assert less.error(parts[1]) <= 1.02 * found.error(parts[1])


def test_errors_of_words_are_expected_in_the_objective() -> None:
    """The objective is what it is on average when the hidden sums of its rows are disturbed."""
    like, given, part = network(), rows(), 1e-3
    freedom = np.eye(len(like.packed()))
    plain, aim = (
        SplineObjective(like, given, Penalty(0), freedom, Squares(), own) for own in (0.0, part)
    )
    point = like.packed()
    sums = like.sums(like.spread(given.inputs))
    outputs = like.process(given.inputs)
    rng = np.random.default_rng(3)
    drawn = sums + part * np.ptp(sums, axis=0) * rng.normal(size=(4000, *sums.shape))
    disturbed = np.einsum("...hk,ohk->...o", like.hidden.at(drawn)[0], like.second) + like.biases
    added = ((disturbed - outputs) / given.scale) ** 2
    mean = added.sum(axis=(1, 2)).mean()
    assert aim.value(point) - plain.value(point) == pytest.approx(mean, rel=0.05)


def test_a_descent_ends_lower_and_early() -> None:
    like = network(2, 1)
    freedom = Edges.curved(like.shape).freedom(like)
    aim = SplineObjective(like, curve(60, 1), Penalty(1e-3), freedom, Squares())
    start = like.packed()
    assert aim.value(descend(aim, start, 50)) < 0.05 * aim.value(start)
    np.testing.assert_array_equal(descend(aim, start, 0), start)
    # The other rows are those of the start, so any step leads away from them.
    here = Rows(aim.rows.inputs, like.process(aim.rows.inputs), aim.rows.scale)
    watched = SplineObjective(like, here, Penalty(0), freedom, Squares())
    near = stopped_early(aim, start, 50, watched, 3)
    assert aim.value(near) < aim.value(start)
    assert watched.value(near) < watched.value(descend(aim, start, 50))


def test_a_law_is_learnt_and_pruned() -> None:
    """The functions of the input that tells nothing become flat, and the error stays."""
    training, validation, test = (curve(120, seed, 0.01) for seed in (1, 2, 3))
    settings = SplineSettings(1, 4, 4, 1e-3)
    found = min(
        (
            trained(settings, np.random.default_rng(start), training, validation)
            for start in range(3)
        ),
        key=lambda model: rms(model, validation),
    )
    assert rms(found, test) < 0.03
    less = pruned(found, training, validation, rms)
    assert less.steps < found.steps
    assert less.edges.first[0, 2] == FLAT
    assert rms(less, test) < 1.1 * rms(found, test)
    dear = pruned(found, training, validation, lambda model, rows: float(model is not found))
    assert dear is found
    again = refitted(less, validation)
    assert again.edges is less.edges
    assert rms(again, validation) < rms(less, validation)
