"""Extreme cases of several hidden layers on the engine."""

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from golden.engine.formats import WIDTH
from golden.engine.integer_network import sample_words
from golden.engine.ranges import hidden_peaks
from golden.networks.design import Settings
from golden.networks.engine import Engine
from golden.networks.oracle import engine_bounds, exact
from golden.numbers.fixed import Codes, signed_width
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.trained.dense import Dense, DenseNetwork, Quantiser
from studies.stability.case import BOUNDED, EQUAL, HIGH, LOW, Row, combinations, largest

MODEL = "deep engine"
SEGMENT_WIDTH = 9
# Each kind of activation, all of them saturating ones, and a mixture.
KINDS = (
    ("relu", "relu", "relu"),
    ("leaky_relu", "linear", "leaky_relu"),
    ("sigmoid", "hard_tanh", "tanh"),
    ("relu", "tanh", "linear"),
)
# Layers of one kind whose weights reach an end: behind tanh that of 18 bits, behind others that of
# the sums.
ENDS = ("relu", "linear", "tanh")
# The largest weights of 18 bits in front of a tanh: for samples, and for results of a tanh.
MOST_OF_SAMPLES, MOST_OF_TANH = 31.9, 63.9
MOST = 2 ** (WIDTH - 1) - 1


def rails() -> Iterator[Row]:
    """Networks of each kind with their sensors at the rails."""
    frames = combinations(4)
    for kinds in KINDS:
        network = _random((4, 8, 6, 5, 2), kinds)
        yield from _judged(network, f"{', '.join(kinds)}: all sensors at rails or 0", frames)


def ends() -> Iterator[Row]:
    """All weights and biases at an end, with signs that add up, cancel, or do so layer by layer."""
    for kind in ENDS:
        case = f"{kind}, {kind}: all weights and biases at their ends"
        # A lean engine makes no sum that no output uses, and its accumulator is as narrow as its
        # sums allow. With every node built, all sums count.
        lean, whole = _filled(kind, lean=True), _filled(kind, lean=False)
        yield Row(MODEL, case, EQUAL, "codes off", max(lean[0], whole[0]), 0)
        must = "keep inside its accumulator"
        yield Row(MODEL, case, must, "bits of the sum", *lean[1:])
        yield Row(MODEL, case, must, "bits of the sum, all nodes built", *whole[1:])


def dead() -> Iterator[Row]:
    """A layer of ReLU whose nodes are 0 for every sample."""
    frames = combinations(4)
    first, *others = _random((4, 8, 6, 2), ("relu", "relu")).layers
    asleep = -np.abs(first.weights).sum(axis=1) - 1
    network = DenseNetwork((Dense(first.weights, asleep, "relu"), *others))
    yield from _judged(network, "every ReLU of layer 1 is dead", frames)


def ties() -> Iterator[Row]:
    """Sums that are half way between two words, or between two codes of a quantiser."""
    # The weights are odd codes, so their products with these samples are odd halves of a word.
    frames = 1024 * np.arange(-7, 8, 2)[:, np.newaxis]
    network = DenseNetwork(
        (
            Dense(np.array([[3.0], [-5.0], [7.0]]) * 2.0**-15, np.zeros(3), "relu"),
            Dense(np.full((2, 3), 1000.0), np.zeros(2)),
        )
    )
    (whole,) = Engine.of([network]).integers
    sums, _ = next(whole.run(sample_words(frames)))
    shift = whole.layers[0].shift
    tied = (2 * sums % (2 << shift) == 1 << shift).sum()
    case = f"relu: {tied} sums half way between two words"
    yield from _judged(network, case, frames)
    # Multiples of half the scale, of which every other one is a tie.
    frames = 512 * np.arange(-16, 16)[:, np.newaxis]
    for rounding, zero in (("even", 4), ("away", 0), ("floor", 4)):
        quantiser = Quantiser(2.0**-3, zero, 0, 15, rounding)
        network = DenseNetwork(
            (
                Dense(np.array([[1.0], [-1.0], [0.5]]), np.zeros(3), "linear", quantiser=quantiser),
                Dense(np.array([[0.25, 0.125, 0.0], [0.0, 0.0, 0.5]]), np.zeros(2)),
            )
        )
        sums = SIGNAL.to_real(frames) @ network.layers[0].weights.T
        count = int((sums / quantiser.scale % 1 == 0.5).sum())
        # All numbers are short, so floating point is exact here.
        expected, _ = SIGNAL.quantise(network.process(SIGNAL.to_real(frames)))
        off = largest(Engine.of([network]).process(frames) - expected)
        case = f"quantised, {rounding}: {count} sums half way between two codes"
        yield Row(MODEL, case, "round as the quantiser says", "codes off", off, 0)


def ranges() -> Iterator[Row]:
    """Ranges from the data, and frames that leave them."""
    rng = np.random.default_rng(0)
    recorded = rng.integers(-800, 801, (200, 16))
    beyond = rng.choice([LOW, HIGH], (200, 16))
    for kinds in (("relu", "relu"), ("leaky_relu", "linear")):
        network = _random((16, 8, 6, 2), kinds, spread=4.0)
        met = hidden_peaks(network, SIGNAL.to_real(recorded))
        engine = Engine.of([network], Settings(met=(met,)))
        names = f"{', '.join(kinds)}, ranges from the data"
        yield from _judged(network, f"{names}: recorded frames", recorded, met)
        case = f"{names}: frames that leave them"
        off = largest(engine.process(beyond) - exact(engine, beyond))
        yield Row(MODEL, case, EQUAL, "codes off", off, 0)
        counted = sum(int(counts.sum()) for counts in engine.saturations(beyond).values())
        missed = abs(counted - _saturated(engine, beyond))
        yield Row(MODEL, case, "count them", f"not counted of {counted}", missed, 0)


def _judged(
    network: DenseNetwork, case: str, frames: Codes, met: Sequence[float] = ()
) -> Iterator[Row]:
    """The network on the engine, against exact integers and against real arithmetic."""
    engine = Engine.of([network], Settings(met=(met,)))
    found = engine.process(frames)
    yield Row(MODEL, case, EQUAL, "codes off", largest(found - exact(engine, frames)), 0)
    real = network.process(SIGNAL.to_real(frames))
    errors = SIGNAL.to_real(found) - np.clip(real, *SIGNAL.to_real([LOW, HIGH]))
    bounds = engine_bounds(network, SEGMENT_WIDTH, network.shape[0], met)
    worst: Real = np.abs(errors).max(axis=0)
    place = int(np.argmax(worst / bounds))
    error, bound = (2**SIGNAL.frac * float(values[place]) for values in (worst, bounds))
    yield Row(MODEL, case, BOUNDED, "error in 2^-13", error, bound)


def _saturated(engine: Engine, frames: Codes) -> int:
    """How many hidden sums leave their words, in Python's integers."""
    (network,) = engine.integers
    count = 0
    for layer, (sums, _) in zip(network.layers, network.run(sample_words(frames)), strict=True):
        if layer.range and layer.range.from_data:
            codes = layer.rounded(sums)
            count += ((codes > MOST) | ((codes < -MOST - 1) & (not layer.rectifies))).sum()
    return count


def _filled(kind: str, lean: bool) -> tuple[float, int, int]:
    """Codes that differ from exact integers, bits of the largest sum, bits of the accumulator."""
    frames = combinations(4)
    off, pairs = 0.0, []
    for signs in itertools.product((1.0, -1.0), repeat=3):
        for mixed in (False, True):
            engine = Engine.of([_at_ends(kind, signs, mixed)], Settings(lean=lean))
            off = max(off, largest(engine.process(frames) - exact(engine, frames)))
            run = engine.program.run(frames)
            sums = [int(total) for _, (made,), _ in run for total in made]
            pairs.append((signed_width(sums), engine.acc_width))
    return off, *max(pairs, key=lambda pair: pair[0] / pair[1])


def _random(shape: tuple[int, ...], kinds: tuple[str, ...], spread: float = 1.5) -> DenseNetwork:
    """A network of normal weights, whose outputs stay below 1 for most frames."""
    rng = np.random.default_rng(len(shape))
    layers = [
        Dense(
            rng.normal(0, spread / np.sqrt(inputs), (nodes, inputs)),
            rng.normal(0, 0.5, nodes),
            kind,
        )
        for (inputs, nodes), kind in zip(itertools.pairwise(shape), (*kinds, "linear"), strict=True)
    ]
    last = layers[-1]
    samples = rng.uniform(-1, 1, (500, shape[0]))
    most = np.abs(DenseNetwork(tuple(layers)).process(samples)).max()
    return DenseNetwork((*layers[:-1], Dense(last.weights / most, last.biases / most)))


def _at_ends(kind: str, signs: Sequence[float], mixed: bool) -> DenseNetwork:
    """Two hidden layers of one kind with the largest weights that their formats hold.

    Each layer has one sign, or alternating ones.
    """
    nodes, inputs = 3, 4
    if kind == "tanh":
        sizes = (MOST_OF_SAMPLES, MOST_OF_TANH, 1.0)
    else:
        # The sums of layer 1 reach the end of the words without fraction bits, and those of layer 2
        # do so again.
        sizes = (MOST / (inputs + 1.1), 0.99 * MOST / (MOST * nodes + 1), 1 / (MOST * (nodes + 1)))
    widths = (inputs, nodes, nodes, 1)
    layers = []
    for size, sign, (taken, given), name in zip(
        sizes, signs, itertools.pairwise(widths), (kind, kind, "linear"), strict=True
    ):
        weights = np.full((given, taken), sign * size)
        if mixed:
            weights[:, 1::2] *= -1
        layers.append(Dense(weights, np.full(given, sign * size), name))
    return DenseNetwork(tuple(layers))
