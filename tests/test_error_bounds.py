"""Tests the bounds of the error of networks of any depth on the engine, against real arithmetic."""

from functools import cache

import numpy as np
import pytest

from golden.engine.bounds import error_bounds
from golden.networks.engine import Engine
from golden.networks.oracle import exact
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.trained.dense import Dense, Quantiser, Trained, layers_of, network_of
from tb.common.cases import random_network

SEEDS = range(4)
KINDS = (
    ("tanh",),
    ("relu",),
    ("sigmoid",),
    ("relu", "relu"),
    ("sigmoid", "tanh"),
    ("linear", "leaky_relu"),
    ("leaky_relu", "relu", "tanh"),
    ("hard_tanh", "relu", "sigmoid"),
    ("relu", "relu", "relu", "relu"),
)


def drawn(kinds: tuple[str, ...], seed: int) -> Trained:
    """A random network with 2 to 23 nodes in each hidden layer."""
    nodes = np.random.default_rng((seed, len(kinds))).integers(2, 24, len(kinds)).tolist()
    return random_network((4, *nodes, 2), kinds, 0.4 + 0.2 * seed, seed)


def frames(seed: int) -> np.ndarray:
    """Random samples; some of them are all at rails or 0."""
    rng = np.random.default_rng(seed)
    codes = rng.integers(SIGNAL.low, SIGNAL.high + 1, (1000, 4))
    codes[:200] = rng.choice([SIGNAL.low, 0, SIGNAL.high], (200, 4))
    return codes


def real(network: Trained, samples: Real) -> Real:
    """Outputs without rounding. What saturates in the engine saturates here: q at 8, y at 1.

    The engine computes a sigmoid as the tanh of half of q.
    """
    values = samples
    for layer in layers_of(network):
        q = values @ layer.weights.T + layer.biases
        end = {"tanh": 8, "sigmoid": 16}.get(layer.activation, np.inf)
        values = layer.activate(np.clip(q, -end, end))[0]
        if layer.quantiser:
            values = layer.quantiser.process(values)
    return np.clip(values, *SIGNAL.to_real([SIGNAL.low, SIGNAL.high]))


@cache
def seen(kinds: tuple[str, ...], seed: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The largest error of each output, and its bound, in units of 2**-13."""
    network, codes = drawn(kinds, seed), frames(seed)
    engine = Engine.of([network])
    results = engine.process(codes)
    assert np.array_equal(results[:20], exact(engine, codes[:20]))
    errors = np.abs(SIGNAL.to_real(results) - real(network, SIGNAL.to_real(codes))).max(axis=0)
    bounds = error_bounds(network, engine.program.segment_width, 4)
    unit = 2**SIGNAL.frac
    return tuple((unit * errors).tolist()), tuple((unit * bounds).tolist())


@pytest.mark.parametrize("kinds", KINDS, ids="-".join)
@pytest.mark.parametrize("seed", SEEDS)
def test_no_error_exceeds_its_bound(kinds: tuple[str, ...], seed: int) -> None:
    errors, bounds = seen(kinds, seed)
    assert max(errors) > 0.5
    for error, bound in zip(errors, bounds, strict=True):
        assert error <= bound


@pytest.mark.parametrize("rounding", ["even", "floor"])
def test_quantised_layers_are_exact(rounding: str) -> None:
    """Only the weights of the last layer and its results are rounded."""
    quantiser = Quantiser(2.0**-3, 0, 0, 15, rounding)
    network = random_network((4, 5, 3, 2), ("relu", "relu"), 1.0, 3, quantiser)
    engine = Engine.of([network])
    bounds = error_bounds(network, engine.program.segment_width, 4)
    assert (bounds < 1.5 * 2.0**-SIGNAL.frac).all()
    codes = frames(3)
    expected = real(network, SIGNAL.to_real(codes))
    assert (np.abs(SIGNAL.to_real(engine.process(codes)) - expected) <= bounds).all()


def test_a_quantiser_behind_what_is_not_exact_can_be_a_step_off() -> None:
    quantiser = Quantiser(2.0**-3, 0, 0, 15)
    layers = layers_of(random_network((4, 5, 3, 2), ("relu", "relu"), 1.0, 3, quantiser))
    weights = np.abs(layers[-1].weights).sum(axis=1)
    first = Dense(layers[0].weights, layers[0].biases, "tanh")
    network = network_of([first, *layers[1:]])
    bounds = error_bounds(network, 9, 4)
    assert (bounds >= weights * quantiser.scale).all()
