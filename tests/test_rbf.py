"""Tests the radial basis function network: its equations, its training, and its cost."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.cluster.vq import kmeans2

from golden.input_error import InputError
from golden.networks.operations import (
    Operations,
    mlp_operations,
    rbf_operations,
    rbf_operations_drawn,
)
from golden.networks.rbf import Rbf
from golden.trained.mlp import Mlp
from tactus.report.measure.rbf import printed_figures, recorded
from tactus.report.measure.rbf_training import mixture_centres, squared_distances, train_rbf


def random_rbf(inputs: int, hidden: int, outputs: int, seed: int = 1) -> Rbf:
    rng = np.random.default_rng(seed)
    return Rbf(
        rng.uniform(-1, 1, (hidden, inputs)),
        rng.uniform(0.5, 2, hidden),
        rng.normal(0, 1, (outputs, hidden)),
        rng.normal(0, 1, outputs),
    )


def test_equations_3_13_and_3_14_by_hand() -> None:
    net = Rbf(np.array([[1.0, 2.0]]), np.array([0.5]), np.array([[3.0]]), np.array([-1.0]))
    assert net.process([1.0, 2.0]) == pytest.approx([2.0])
    assert net.process([2.0, 0.0]) == pytest.approx([3 * math.exp(-5 / 0.5) - 1])
    assert net.process(np.zeros((4, 5, 2))).shape == (4, 5, 1)
    assert net.shape == (2, 1, 1)


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("widths", np.array([1.0, 0.0, 1.0]), "widths: got 0, expected above 0"),
        ("widths", np.array([1.0, np.nan, 1.0]), "widths: got NaN or infinity"),
        ("widths", np.ones(2), r"centres, widths, weights, biases: got shapes"),
        ("centres", np.ones((2, 2)), "got shapes"),
        ("weights", np.ones((2, 2)), "got shapes"),
        ("biases", np.array([np.inf, 0.0]), "biases: got NaN or infinity"),
    ],
)
def test_what_is_no_network_is_refused(field: str, value, message: str) -> None:
    net = random_rbf(2, 3, 2)
    arrays = {name: getattr(net, name) for name in ("centres", "widths", "weights", "biases")}
    with pytest.raises(InputError, match=message):
        Rbf(**(arrays | {field: value}))


def test_centres_find_clusters_apart() -> None:
    rng = np.random.default_rng(2)
    true = np.array([[0.0, 0.0], [5.0, 0.0], [0.0, 5.0]])
    inputs = np.concatenate([c + rng.normal(0, 0.1, (40, 2)) for c in true])
    found = mixture_centres(inputs, 3, np.random.default_rng(1))
    means = inputs.reshape(3, 40, 2).mean(axis=1)
    assert squared_distances(means, found).min(axis=1) == pytest.approx([0, 0, 0], abs=1e-6)


def test_centres_are_those_of_the_mixture_not_of_k_means() -> None:
    """Next to a wide cluster is a narrow one. k-means cuts halfway, which shifts both centres."""
    rng = np.random.default_rng(2)
    narrow, wide = rng.normal(0, 0.1, (400, 2)), rng.normal([2, 0], 1, (400, 2))
    inputs = np.concatenate([narrow, wide])
    cut, _ = kmeans2(inputs, 2, minit="++", seed=1)
    found = mixture_centres(inputs, 2, np.random.default_rng(1))
    assert np.abs(np.sort(cut[:, 0]) - [0, 2]).max() > 0.3
    assert np.abs(np.sort(found[:, 0]) - [0, 2]).max() < 0.1


def test_training_reaches_a_network_of_its_own_kind() -> None:
    """With as many nodes as rows, least squares reach every target exactly."""
    rng = np.random.default_rng(3)
    inputs, targets = rng.uniform(-1, 1, (8, 2)), rng.uniform(-1, 1, (8, 2))
    net = train_rbf(inputs, targets, 8, np.random.default_rng(1))
    assert np.allclose(net.process(inputs), targets, atol=1e-3)


def test_outputs_are_the_least_squares() -> None:
    inputs, targets = recorded()
    net = train_rbf(inputs, targets, 6, np.random.default_rng(1))
    basis = np.concatenate([net.hidden(inputs), np.ones((len(inputs), 1))], axis=1)
    assert np.abs(basis.T @ (net.process(inputs) - targets)).max() < 1e-8
    distances = squared_distances(net.centres, net.centres)
    assert np.allclose(net.widths**2, distances.max())


def test_training_depends_on_the_generator_alone() -> None:
    inputs, targets = recorded()
    first, again, other = (
        train_rbf(inputs, targets, 6, np.random.default_rng(seed)) for seed in (1, 1, 2)
    )
    assert np.array_equal(first.centres, again.centres)
    assert not np.array_equal(first.centres, other.centres)


def test_training_refuses_what_it_cannot_place() -> None:
    with pytest.raises(InputError, match="hidden: got 1, expected 2 or more"):
        train_rbf(np.ones((5, 2)), np.ones((5, 1)), 1, np.random.default_rng(1))
    with pytest.raises(InputError, match="got 1 distinct rows for 3 centres"):
        train_rbf(np.ones((5, 2)), np.ones((5, 1)), 3, np.random.default_rng(1))


def test_the_recorded_rows_are_those_of_section_3_8() -> None:
    inputs, targets = recorded()
    assert inputs.shape == (57, 2)
    assert np.allclose(np.unique(targets[:, 0]), [6 / 14.44, 9 / 14.44, 11 / 14.44], atol=5e-4)


class Counted:
    """A number that counts the operations on it and on their results."""

    tally: dict[str, int]

    def __init__(self, value: float, tally: dict[str, int]):
        self.value, self.tally = value, tally

    def _count(self, kind: str, value: float) -> Counted:
        self.tally[kind] += 1
        return Counted(value, self.tally)

    def __add__(self, other):
        return self._count("additions", self.value + other.value)

    def __sub__(self, other):
        return self._count("additions", self.value - other.value)

    def __mul__(self, other):
        return self._count("multiplications", self.value * other.value)


def total(terms):
    first, *others = terms
    for term in others:
        first = first + term
    return first


def count(network: Mlp | Rbf, frame) -> Operations:
    """Evaluate the equations number by number. The results must be those of the network."""
    tally = {"additions": 0, "multiplications": 0}

    def counted(array):
        return np.vectorize(lambda v: Counted(v, tally), otypes=[object])(array)

    x = counted(np.asarray(frame))
    inputs, hidden, outputs = network.shape
    if isinstance(network, Mlp):
        w1, b1, w2, b2 = (counted(getattr(network, n)) for n in ("w1", "b1", "w2", "b2"))
        q = [total(w1[j, k] * x[k] for k in range(inputs)) + b1[j] for j in range(hidden)]
        r = [Counted(math.tanh(v.value), tally) for v in q]
    else:
        centres, w2, b2 = (counted(getattr(network, n)) for n in ("centres", "weights", "biases"))
        scale = counted(-1 / (2 * network.widths**2))
        differences = [[x[k] - centres[j, k] for k in range(inputs)] for j in range(hidden)]
        q = [total(d * d for d in row) * scale[j] for j, row in enumerate(differences)]
        r = [Counted(math.exp(v.value), tally) for v in q]
    y = [total(w2[i, j] * r[j] for j in range(hidden)) + b2[i] for i in range(outputs)]
    assert np.allclose([v.value for v in y], network.process(frame))
    return Operations(**tally)


@pytest.mark.parametrize("shape", [(2, 6, 2), (2, 7, 2), (4, 16, 4), (1, 1, 1), (3, 5, 2)])
def test_operations_are_those_of_the_equations(shape) -> None:
    inputs, hidden, outputs = shape
    frame = np.linspace(-0.7, 0.8, inputs)
    rng = np.random.default_rng(1)
    mlp = Mlp(
        *(rng.normal(0, 1, s) for s in ((hidden, inputs), hidden, (outputs, hidden), outputs))
    )
    assert count(mlp, frame) == mlp_operations(shape)
    assert count(random_rbf(*shape), frame) == rbf_operations(shape)


def test_operations_that_the_thesis_prints() -> None:
    """Both RBF agree with the diagram, and the MLP agrees except for two additions."""
    for hidden in (6, 7):
        printed = printed_figures(f"RBF 2:{hidden}:2")
        found = rbf_operations_drawn((2, hidden, 2))
        assert found == Operations(printed["multiplications"], printed["additions"])
    printed = printed_figures("MLP 2:6:2")
    assert mlp_operations((2, 6, 2)) == Operations(
        printed["multiplications"], printed["additions"] - 2
    )
