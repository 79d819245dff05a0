"""The network in whole numbers, which judges every engine, and the bounds of its error."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from golden.engine.formats import DROPPED, OUTPUT_SHIFT, RESULT
from golden.engine.integer_network import IntegerLayer, LayerRounding, evaluate, sample_words
from golden.engine.quantise import integer_networks
from golden.networks.bounds import engine_bounds
from golden.networks.design import Settings
from golden.networks.engine import Engine
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.trained.dense import ACTIVATIONS, Dense, Quantiser, Trained, layers_of, network_of
from golden.trained.function import Function
from tb.common.cases import random_network

TABLES = (Function("softsign", "x / (1 + abs(x))"), Function("bell", "exp(-x * x)"))
KINDS = [*ACTIVATIONS, *(f"table:{function.name}" for function in TABLES)]
OPTIONS: list[dict[str, object]] = [{}, {"pipeline": "deep"}]


def frames_of(inputs: int) -> Codes:
    """Random frames, coarse ones whose sums are half way between codes, and rails."""
    rng = np.random.default_rng(1)
    fine = rng.integers(SIGNAL.low, SIGNAL.high + 1, (30, inputs))
    coarse = rng.integers(-16, 16, (40, inputs)) << 9
    rails = rng.choice([SIGNAL.low, 0, SIGNAL.high], (20, inputs))
    return np.concatenate([fine, coarse, rails])


@st.composite
def shapes(draw: st.DrawFn, hidden: int) -> tuple[int, ...]:
    return tuple(draw(st.lists(st.integers(1, 5), min_size=hidden + 2, max_size=hidden + 2)))


@st.composite
def floating(draw: st.DrawFn) -> Trained:
    """Networks of one to four hidden layers of any activation."""
    kinds = draw(st.lists(st.sampled_from(KINDS), min_size=1, max_size=4))
    spread = draw(st.sampled_from([0.1, 1.0, 10.0]))
    shape = draw(shapes(len(kinds)))
    return random_network(shape, tuple(kinds), spread, draw(st.integers(0, 99)), functions=TABLES)


@st.composite
def quantised(draw: st.DrawFn) -> Trained:
    """Networks with a quantiser behind each hidden layer, in each rounding that there is."""
    kinds = draw(st.lists(st.sampled_from(["relu", "linear"]), min_size=1, max_size=3))
    bits = draw(st.integers(2, 8))
    low = draw(st.sampled_from([0, -1 << (bits - 1)])) if set(kinds) == {"linear"} else 0
    rounding = draw(st.sampled_from(["even", "floor"] if low else ["even", "floor", "away"]))
    scale = 2.0 ** -draw(st.integers(bits - 2, bits + 1))
    quantiser = Quantiser(scale, 0, low, low + (1 << bits) - 1, rounding)
    shape = draw(shapes(len(kinds)))
    return random_network(shape, tuple(kinds), 1.0, draw(st.integers(0, 99)), quantiser)


@settings(max_examples=60)
@given(network=st.one_of(floating(), quantised()), lean=st.booleans())
def test_every_engine_computes_the_network_in_whole_numbers(network: Trained, lean: bool) -> None:
    frames = frames_of(network.shape[0])
    expected = evaluate(integer_networks("single", [network]), frames)
    for options in OPTIONS:
        engine = Engine.of([network], Settings(options=options, lean=lean))
        assert np.array_equal(engine.process(frames), expected)


@pytest.mark.parametrize("arrangement", ["multiple", "cascade"])
@pytest.mark.parametrize("width", [8, 9])
def test_so_do_several_networks_on_one_engine(arrangement: str, width: int) -> None:
    kinds = [("relu", "tanh"), ("table:bell",), ("leaky_relu", "sigmoid")]
    networks = [
        random_network(
            (3 + n * (arrangement == "cascade"), *(4,) * len(k), 1), k, 0.7, n, None, TABLES
        )
        for n, k in enumerate(kinds)
    ]
    frames = frames_of(3)
    whole = integer_networks(arrangement, networks, segment_width=width)
    assert [one.earlier for one in whole] == ([0, 1, 2] if arrangement == "cascade" else [0] * 3)
    expected = evaluate(whole, frames)
    assert len(np.unique(expected, axis=0)) > 20
    for lanes in (1, 2):
        options = {"segment_width": width, "lanes": lanes}
        engine = Engine.of(networks, Settings(options=options), arrangement)
        assert np.array_equal(engine.process(frames), expected)


def test_a_quantised_network_does_not_see_the_half_unit_of_an_earlier_output() -> None:
    """It rounds the value itself, though a half is added to the word that it takes."""
    first = random_network((2, 3, 1), ("tanh",), 0.5, 1)
    behind = Quantiser(2.0**-SIGNAL.frac, 0, SIGNAL.low, SIGNAL.high, "even")
    second = network_of(
        [
            Dense(np.array([[0.0, 0.0, 1.0]]), np.zeros(1), "linear", quantiser=behind),
            Dense(np.array([[1.0]]), np.zeros(1)),
        ]
    )
    whole, frames = integer_networks("cascade", [first, second]), frames_of(2)
    words = np.array([list(whole[0].run(words))[-1][1] for words in sample_words(frames)])
    half = 1 << (OUTPUT_SHIFT - 1)
    expected = np.rint((words - half) / (1 << OUTPUT_SHIFT))
    found = evaluate(whole, frames)
    assert np.array_equal(found[:, 1:], expected)
    assert (words % (1 << OUTPUT_SHIFT) > half).any()
    engine = Engine.of([first, second], arrangement="cascade")
    assert np.array_equal(engine.process(frames), found)


@pytest.mark.parametrize(
    ("rounding", "expected"),
    [
        (LayerRounding.UP, [-2, -1, -1, 0, 0, 0, 1, 1, 2, 2]),
        (LayerRounding.EVEN, [-2, -2, -1, 0, 0, 0, 0, 1, 2, 2]),
        (LayerRounding.DOWN, [-2, -2, -2, -1, -1, 0, 0, 0, 1, 2]),
    ],
)
def test_a_sum_is_rounded_as_its_layer_says(rounding: LayerRounding, expected: list[int]) -> None:
    """In quarters of a code: -8, -6, -5, -2, -1, 0, 2, 3, 6 and 8."""
    layer = IntegerLayer(((1,),), (0,), RESULT, shift=2, rounding=rounding)
    sums = [-8, -6, -5, -2, -1, 0, 2, 3, 6, 8]
    assert [layer.rounded(total) for total in sums] == expected
    if rounding is LayerRounding.EVEN:
        assert expected == [round(Fraction(total, 4)) for total in sums]


def test_a_code_is_clipped_and_moved_to_its_place() -> None:
    layer = IntegerLayer(((1,), (-2,)), (5, 6), RESULT, shift=1, low=0, high=15, cut=13)
    sums = layer.sums([9], 9)
    assert sums == [14, -12]
    assert [layer.code(total) for total in sums] == [7, 0]
    assert [layer.code(total) for total in (29, 40)] == [15, 15]
    assert layer.words_for_next_layer([7, 0], 9) == [7 << 13, 0]
    leaky = IntegerLayer(((1,), (1,)), (0, 0), RESULT, leaky=True)
    assert leaky.words_for_next_layer([7, -7], 9) == [7, 7, -7, 0]


def test_the_codes_of_a_quantiser_are_those_of_its_file() -> None:
    """Worked by hand: codes count from the lowest one, and a tie goes to the even one."""
    quantiser = Quantiser(0.25, 2, 0, 7, "even")
    layers = [
        Dense(np.array([[1.0]]), np.array([0.125]), "linear", quantiser=quantiser),
        Dense(np.array([[0.5]]), np.array([0.0])),
    ]
    (whole,) = integer_networks("single", [network_of(layers)])
    layer, last = whole.layers
    assert (layer.rounding, layer.low, layer.high, layer.cut) == (LayerRounding.EVEN, 0, 7, 14)
    assert layer.shift == DROPPED + layer.cut
    assert last.rounding is LayerRounding.DOWN
    samples = np.array([[-1.0], [-0.5], [-0.25], [0.0], [0.25], [0.5], [0.75]])
    frames, _ = SIGNAL.quantise(samples)
    # (x + 1/8) / (1/4) + 2: -1.5, 0.5, 1.5, 2.5, 3.5, 4.5 and 5.5
    assert whole.hidden_codes(frames)[0].ravel().tolist() == [0, 0, 2, 2, 4, 4, 6]
    assert len(sample_words(frames)) == len(frames)
    found = SIGNAL.to_real(evaluate([whole], frames)).ravel()
    assert found.tolist() == [-0.25, -0.25, 0.0, 0.0, 0.25, 0.25, 0.5]


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


@pytest.mark.parametrize("rounding", ["even", "floor"])
def test_quantised_layers_are_exact(rounding: str) -> None:
    """Only the weights of the last layer and its results are rounded."""
    quantiser = Quantiser(2.0**-3, 0, 0, 15, rounding)
    network = random_network((4, 5, 3, 2), ("relu", "relu"), 1.0, 3, quantiser)
    engine = Engine.of([network])
    bounds = engine_bounds(network, engine.program.segment_width, 4)
    assert (bounds < 1.5 * 2.0**-SIGNAL.frac).all()
    codes = frames_of(4)
    expected = real(network, SIGNAL.to_real(codes))
    assert (np.abs(SIGNAL.to_real(engine.process(codes)) - expected) <= bounds).all()


def test_a_quantiser_behind_what_is_not_exact_can_be_a_step_off() -> None:
    quantiser = Quantiser(2.0**-3, 0, 0, 15)
    layers = layers_of(random_network((4, 5, 3, 2), ("relu", "relu"), 1.0, 3, quantiser))
    weights = np.abs(layers[-1].weights).sum(axis=1)
    first = Dense(layers[0].weights, layers[0].biases, "tanh")
    network = network_of([first, *layers[1:]])
    bounds = engine_bounds(network, 9, 4)
    assert (bounds >= weights * quantiser.scale).all()
