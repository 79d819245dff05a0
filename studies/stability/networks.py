"""Extreme cases of the networks: readings, rails, huge weights, full accumulators."""

import itertools
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from golden.activation.schemes import SCHEMES
from golden.instruments.converter_instrument import ConverterInstrument
from golden.layers.input_controller import InputController
from golden.layers.input_integral import InputIntegral
from golden.layers.output_integral import OutputIntegral
from golden.networks.arrangement import seen
from golden.networks.constants import constants_of
from golden.networks.design import Design, Settings
from golden.networks.designs import DESIGNS
from golden.networks.engine import Engine
from golden.networks.oracle import exact_sum
from golden.networks.parallel import Neuron
from golden.numbers.fixed import Codes, Fix, signed_width
from golden.numbers.precision import EXACT, SIGNAL, THESIS, Precision, normalisation
from golden.trained.dense import DenseNetwork, mlp_of, packed, unpacked
from studies.stability.case import (
    BOUNDED,
    EQUAL,
    HIGH,
    LOW,
    Row,
    accepted,
    combinations,
    exact_network,
    largest,
    real_error,
    worst,
)
from tactus.scene import Scene, load_scene, scene_names

FACTOR = 512  # a Y_i larger than any shipped network has
# A bound of more than this part of full scale tells nobody that an output is right.
USELESS = 0.01 * 2.0**SIGNAL.frac
# Networks whose weights and biases are all at a limit. From a Q_j of 2400 on, thresholds of the
# gradient activation coincide in 14 bits; 31.99 fills a word of 18 bits.
SHAPES = ((1, 1, 1), (4, 3, 2))
MOST_Q, MOST_WORD = 2390, 31.99


def _alternating(inputs: int) -> Codes:
    """A frame with alternating rails, and its opposite."""
    # The rows have odd length, so the second row begins with the other rail.
    return np.resize([LOW, HIGH], (2, inputs + inputs % 2 + 1))[:, :inputs]


def readings() -> Iterator[Row]:
    """Readings that no sensor should give."""
    network = load_scene("digit-single").twin()
    bad = [np.nan, np.inf, -np.inf]
    count = accepted([partial(SIGNAL.quantise, [0.0, value]) for value in bad])
    yield Row("readings", "NaN and infinity", "refuse them", "accepted of 3", count, 0)
    codes, saturated = SIGNAL.quantise([1.0, 1e300, -1.1, -1e300])
    off = largest(codes - np.array([HIGH, HIGH, LOW, LOW]))
    yield Row("readings", "beyond the range", "stop at the rails", "codes off", off, 0)
    yield Row("readings", "beyond the range", "count them", "not counted", 4 - saturated, 0)
    outside = [[0, 0, 0, code] for code in (LOW - 1, HIGH + 1, 2**62)]
    calls: list[Callable[[], object]] = [partial(network.process, [frame]) for frame in outside]
    calls += [partial(network.process, [[0] * 3]), partial(network.process, [[0.5] * 4])]
    must, figure = "refuse them", "accepted of 5"
    yield Row("readings", "no codes, or too few", must, figure, accepted(calls), 0)
    one = np.ones((1, 1))
    weights = [partial(mlp_of, one * value, one[0], one, one[0]) for value in bad]
    count = accepted(weights)
    yield Row("weights", "NaN and infinity", "refuse them", "accepted of 3", count, 0)
    # Frames of three, four, six and again four samples, for a network with four inputs.
    last = np.zeros(17, dtype=bool)
    last[[2, 6, 12, 16]] = True
    scan = InputController(4, 0).process(last, np.arange(17))
    good = np.isin(np.arange(17), [6, 16])
    off = int((scan.done != good).sum()) + abs(int(scan.error.sum()) - 2)
    must = "refuse two, take the others"
    yield Row("frames", "too short, good, too long, good", must, "decisions off", off, 0)


def rails() -> Iterator[Row]:
    """The networks of every shipped scene with their sensors at the rails."""
    for name in scene_names():
        scene = load_scene(name)
        network = scene.twin()
        if isinstance(network, ConverterInstrument):
            # A converter gives fewer codes, so all codes are given to the hardware after it.
            network = network.readout
        for number, (case, sent) in enumerate(_sent(scene).items()):
            found = network.process(sent)
            frames = scene.window.frames(sent)
            off = largest(found - exact_network(network, scene.arrangement, frames))
            yield Row(name, case, EQUAL, "codes off", off, 0)
            errors, bounds = _errors(scene, frames, found)
            nearest = worst(errors, bounds)
            yield Row(name, case, BOUNDED, "error in 2^-13", *nearest)
            widest = int(np.argmax(bounds))
            if not number and bounds[widest] > max(USELESS, nearest[1]):
                figure = "error in 2^-13, output of the widest bound"
                yield Row(name, case, BOUNDED, figure, errors[widest], bounds[widest])


def _sent(scene: Scene) -> dict[str, Codes]:
    """The frames of the sensors for each case. With past samples they follow in time."""
    inputs, past = len(scene.sensors), scene.window.past
    if not past:
        return {
            "all sensors at rails or 0, alternating ones too": combinations(inputs),
        }
    rng = np.random.default_rng(0)
    drawn = rng.choice([LOW, 0, HIGH], (past + 500, inputs))
    moving = rng.integers(LOW, HIGH + 1, (past + 500, inputs))
    moving[:, 0] = HIGH
    return {
        "all sensors at rails or 0, now and before": drawn,
        "alternating rails, from frame to frame": np.resize(_alternating(inputs), drawn.shape),
        "rails in the past, 0 now": np.concatenate([drawn[:past], np.zeros_like(drawn[:past])]),
        "a sensor that stopped at a rail": moving,
    }


def _errors(scene: Scene, frames: Codes, found: Codes) -> tuple[list[float], list[float]]:
    """The largest error of each output, and its bound, in units of 2^-13.

    Each network is compared with its own inputs, so that in a cascade the errors of earlier
    networks do not count twice.
    """
    columns = [found[:, [i]] for i in range(found.shape[1])]
    pairs: list[tuple[float, float]] = []
    for i, mlp in enumerate(scene.mlps()):
        codes = seen(scene.arrangement, frames, columns[:i])
        given = found if scene.arrangement == "single" else columns[i]
        twin = scene.build(mlp, lean=False)
        pairs += real_error(mlp, scene.precision, twin, codes, given, len(scene.inputs))
    errors, bounds = zip(*pairs, strict=True)
    return list(errors), list(bounds)


def huge_weights() -> Iterator[Row]:
    """Weights that make Q_j huge, up to the limit of a format."""
    rng = np.random.default_rng(0)
    mlp = mlp_of(rng.normal(0, 60, (3, 4)), rng.normal(0, 60, 3), np.full((1, 3), 0.3), np.zeros(1))
    most = int(normalisation(mlp.layers[0].weights, mlp.layers[0].biases).max())
    frames = np.concatenate([combinations(4), rng.integers(LOW, HIGH + 1, (500, 4))])
    for name, precision, build in _designs():
        network = build(mlp)
        found = network.process(frames)
        case = f"weights of 60, Q_j to {most}, {precision.name}"
        off = largest(found - exact_network(network, "single", frames))
        yield Row(name, case, EQUAL, "codes off", off, 0)
        ((error, bound),) = real_error(mlp, precision, network, frames, found, 4)
        yield Row(name, case, BOUNDED, "error in 2^-13", error, bound)
    yield from _at_limits()
    one, none = np.ones((1, 1)), np.zeros(1)
    beyond = mlp_of(2e5 * one, none, one, none)
    kinds = [name for name, scheme in SCHEMES.items() if THESIS in scheme.precisions]
    count = accepted([partial(constants_of, beyond, Settings(THESIS, name)) for name in kinds])
    must, figure = "refuse them", f"accepted of {len(kinds)}"
    yield Row("constants", "Q_j of 200000, thesis, every activation", must, figure, count, 0)
    count = accepted([partial(constants_of, beyond, Settings(EXACT, "precise"))])
    yield Row("constants", "weights of 200000, exact", must, "accepted of 1", count, 0)
    whole = mlp_of(np.full((1, 2), -1.0), np.ones(1), 0.3 * one, none)
    count = accepted([partial(constants_of, whole, Settings(THESIS, "gradient"))])
    must = "refuse them: the sum would wrap"
    yield Row("constants", "weights of whole numbers, thesis", must, "accepted of 1", count, 0)


def _designs() -> Iterator[tuple[str, Precision, Callable[[DenseNetwork], Design]]]:
    """Every design of tanh networks in each of its precisions: name, precision, how to build it."""
    for (name, design), precision in itertools.product(DESIGNS.items(), (THESIS, EXACT)):
        if precision.name in design.precisions and not design.learned_functions:
            known = design.known_activations or (precision.activation,)
            activation = precision.activation if precision.activation in known else known[0]
            settings = Settings(precision, activation)
            yield name, precision, partial(_built, design, settings)
            if design is Engine:
                several = replace(settings, options={"lanes": 4})
                yield "lanes", precision, partial(_built, design, several)


def _built(design: type[Design], settings: Settings, mlp: DenseNetwork) -> Design:
    return design.of([mlp], settings)


def _at_limits() -> Iterator[Row]:
    """All weights and biases at a limit, with signs that add up, alternate, or are drawn."""
    rng = np.random.default_rng(0)
    for name, precision, build in _designs():
        off = 0.0
        for shape in SHAPES:
            inputs, hidden, outputs = shape
            first, second = np.zeros((hidden, inputs)), np.zeros((outputs, hidden))
            like = mlp_of(first, np.zeros(hidden), second, np.zeros(outputs))
            length = len(packed(like))
            frames = combinations(inputs)
            size = MOST_Q / (inputs + 1) - 0.5 if precision.normalise else MOST_WORD
            for signs in (np.ones(length), np.resize([1, -1], length), rng.choice([-1, 1], length)):
                network = build(unpacked(size * signs, like))
                found = network.process(frames)
                off = max(off, largest(found - exact_network(network, "single", frames)))
        case = f"weights and biases all at their limits, 1:1:1 and 4:3:2, {precision.name}"
        yield Row(name, case, EQUAL, "codes off", off, 0)


def accumulators() -> Iterator[Row]:
    """Every weight, bias and sample at an end of its format."""
    wide = Fix(EXACT.coeff_width, EXACT.coeff_width - 1)
    for precision, fmt in ((THESIS, SIGNAL), (EXACT, wide)):
        shift, hidden = precision.product_shift, precision.hidden_fmt
        blocks: dict[str, list[InputIntegral | Neuron | OutputIntegral]] = {}
        # A weight and a bias fill 31 bits, or also the 32nd, at which the twin takes wider
        # integers.
        for count, bias, weight in itertools.product(
            (1, 2, 25), (fmt.low, fmt.high), (fmt.low, fmt.high)
        ):
            weights = (weight,) * count
            for block in (
                InputIntegral(SIGNAL, fmt, hidden, shift, (weights,), (bias,)),
                Neuron(SIGNAL, fmt, SIGNAL, shift, weights, bias, factor=FACTOR),
                OutputIntegral(SIGNAL, fmt, SIGNAL, shift, (weights,), (bias,), (FACTOR,)),
            ):
                blocks.setdefault(block.block, []).append(block)
        case = f"1 to 25 weights, bias and samples at their ends, {precision.name}"
        for name, alike in blocks.items():
            found = [_filled(block) for block in alike]
            off = max(pair[0] for pair in found)
            yield Row(name, case, EQUAL, "codes off", off, 0)
            bits, width = max((pair[1:] for pair in found), key=lambda pair: pair[0] / pair[1])
            must = "keep inside its accumulator"
            yield Row(name, case, must, "bits of the sum", bits, width)


def _filled(block: InputIntegral | Neuron | OutputIntegral) -> tuple[float, int, int]:
    """Codes that differ from Python's integers, bits of the largest sum, bits of the hardware."""
    if isinstance(block, Neuron):
        weights, bias = block.weights, block.bias
    else:
        weights, bias = block.weights[0], block.biases[0]
    factor = 1 if isinstance(block, InputIntegral) else FACTOR
    count = len(weights)
    frames = np.concatenate([np.full((1, count), LOW), np.full((1, count), HIGH)])
    frames = np.concatenate([frames, _alternating(count)])
    exact = [exact_sum(block, weights, bias, frame, factor) for frame in frames.tolist()]
    off = largest(np.ravel(block.process(frames)) - [result for _, result in exact])
    return off, signed_width(total for total, _ in exact), block.acc_width
