"""Makes a trained network one in whole numbers: codes of weights, and a format per layer.

A layer with a quantiser gets codes with which it is exact, or is refused. All other numbers become
the nearest codes.

A sum before tanh saturates at -8 and 8, where tanh is flat, so its format is the same for every
network. Sums before other functions that are tables have this format too. Behind a ReLU or a linear
layer saturation would be an error. So the words of such a layer have the most fraction bits with
which none of its sums can overflow, whatever the samples are. The bounds of each sum follow from
the bounds of its operands, in whole numbers. Where these bounds waste bits, and recorded frames are
known, the range is that of the frames with a margin (``golden.engine.ranges``).

Two activations need no hardware of their own. ``sigmoid(q) = 1/2 + tanh(q / 2) / 2`` needs half of
the weights before and behind it, and a bias. ``leaky_relu(q) = leak q + (1 - leak) relu(q)`` needs
two words per node, both of which the next layer takes.
"""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np

from golden.engine.formats import (
    DROPPED,
    HIDDEN,
    OUTPUT_SHIFT,
    RESULT,
    SAMPLE,
    SAMPLE_SHIFT,
    WIDTH,
    coeff_frac,
)
from golden.engine.function_table import SEGMENT_WIDTH, format_of
from golden.engine.grid import OR_NEAREST, Exact, Value, grid_of
from golden.engine.integer_network import IntegerLayer, IntegerNetwork, LayerRounding
from golden.engine.ranges import ENOUGH, Range, frac_of
from golden.engine.sums_of_functions import added_up
from golden.input_error import InputError, naming
from golden.numbers.fixed import Fix
from golden.numbers.precision import SIGNAL
from golden.trained.dense import DenseNetwork
from golden.trained.function import TANH

# The least and the largest word.
_LOW, _HIGH = RESULT.low, RESULT.high
_fractions = np.vectorize(Fraction, otypes=[object])
# Half a unit of an output, in units of a product.
_HALF_OUTPUT = 1 << (DROPPED + OUTPUT_SHIFT - 1)


# One layer on its way into whole numbers, and the words that the next layer takes.
PlannedLayer = tuple[Exact, IntegerLayer, list[Value]]


def exact_layers(network: DenseNetwork) -> list[Exact]:
    """The layers of a network, with sigmoid replaced by tanh.

    Behind a quantiser, words are differences from the lowest code. The biases of the next layer
    compensate for that.
    """
    found: list[Exact] = []
    halved = False
    for number, layer in enumerate(network.layers, start=1):
        weights, biases = _fractions(layer.weights), _fractions(layer.biases)
        if halved:
            weights = weights / 2
            biases = biases + weights.sum(axis=1)
        halved = layer.activation == "sigmoid"
        if halved:
            weights, biases = weights / 2, biases / 2
        before = found[-1].grid if found else None
        if before:
            weights = weights / before.factor
            biases = biases + before.lowest * weights.sum(axis=1)
        with naming(f"layer {number}"):
            grid = grid_of(layer)
        if grid:
            weights, biases = weights * grid.factor, biases * grid.factor
        functions = layer.functions
        if layer.activation in ("tanh", "sigmoid"):
            functions = (TANH,) * layer.nodes
        kind = "table" if functions else layer.activation
        output = number == len(network.layers)
        found.append(
            Exact(number, kind, Fraction(layer.leak), weights, biases, grid, functions, output)
        )
    return found


def first_values(samples: int, earlier: int) -> list[Value]:
    """The operands of the first layer of a network: samples, and outputs of earlier networks."""
    ends = SIGNAL.low << SAMPLE_SHIFT, SIGNAL.high << SAMPLE_SHIFT
    one = Fraction(1)
    found = [Value(k, one, SAMPLE, *ends) for k in range(samples)]
    more = range(samples, samples + earlier)
    return found + [Value(k, one, RESULT, _LOW, _HIGH, earlier=True) for k in more]


def planned(
    network: DenseNetwork, values: list[Value], met: Sequence[float] = ()
) -> list[PlannedLayer]:
    """Every layer of a network whose inputs are ``values``, in codes and formats.

    ``met`` is what ``hidden_peaks`` finds on recorded frames; without it every range is from
    bounds.
    """
    found: list[PlannedLayer] = []
    for exact in added_up(exact_layers(network), values):
        with naming(f"layer {exact.number}"):
            reached = met[exact.number - 1] if met and not exact.output else 0.0
            layer = _layer(exact, values, reached)
        values = _values_for_next_layer(exact, layer, values)
        found.append((exact, layer, values))
    return found


def integer_networks(
    arrangement: str,
    networks: Sequence[DenseNetwork],
    met: Sequence[Sequence[float]] = (),
    segment_width: int = SEGMENT_WIDTH,
) -> tuple[IntegerNetwork, ...]:
    """Trained networks in whole numbers.

    arrangement: "single", "multiple" or "cascade".
    met: For each network what ``hidden_peaks`` finds on recorded frames; empty where there are
    none.
    segment_width: Bits of a sum within a segment of the table of a function.

    A later network of a cascade reads the word of an output, to which half a unit of the output's
    last place is added. The biases of that network subtract it again.
    """
    samples = networks[0].shape[0]
    found: list[IntegerNetwork] = []
    for network, reached in zip(networks, met or [()] * len(networks), strict=True):
        before = sum(one.layers[-1].nodes for one in found) if arrangement == "cascade" else 0
        plan = planned(network, first_values(samples, before), reached)
        layers = tuple(layer for _, layer, _ in plan)
        found.append(IntegerNetwork(samples, before, layers, segment_width))
    return tuple(found)


def _layer(exact: Exact, values: Sequence[Value], met: float) -> IntegerLayer:
    """One layer, in the format that its activation and its operands ask for."""
    if exact.grid:
        return _coded(exact, exact.grid.result, values)
    if exact.functions or exact.activation == "sums":
        return _coded(exact, HIDDEN, values)
    if exact.output or exact.activation == "hard_tanh":
        return _coded(exact, RESULT, values)
    return _ranged(exact, values, met)


def _ranged(exact: Exact, values: Sequence[Value], met: float) -> IntegerLayer:
    """The codes of a layer in which saturation would be an error; see ``golden.engine.ranges``."""
    frac = WIDTH - 1
    while True:
        layer = _coded(exact, Fix(WIDTH, frac), values)
        low, high = _ends(layer, values)
        most = max(*high, -min(low))
        fits = min(low) >= _LOW and max(high) <= _HIGH
        if fits or not frac:
            break
        # A bit less halves the sums, but for the rounding of weights, which is far below a range.
        # So formats in which they would be twice the range or more need not be tried.
        frac = max(0, frac - max(1, most.bit_length() - WIDTH))
    bound = most / 2.0**frac
    frac = frac if fits else -1
    known = frac_of(met, WIDTH) if met else -1
    if known > frac and met * 2.0**frac < 1 << ENOUGH:
        fmt = Fix(WIDTH, known)
        return replace(_coded(exact, fmt, values), range=Range(fmt, bound, met, True))
    if frac < 0:
        raise InputError(f"got sums that reach {most:g}, expected {_HIGH} at most")
    return replace(layer, range=Range(layer.result, bound, met, False))


def _coded(exact: Exact, result: Fix, values: Sequence[Value]) -> IntegerLayer:
    """The codes of a layer, for one format of its words.

    The start of a sum has the unit of a word, except in a layer with a quantiser, which needs it
    whole.
    """
    grid = exact.grid
    scales = [v.factor * Fraction(2) ** coeff_frac(result, v.fmt) for v in values]
    weights = exact.weights[:, [v.node for v in values]] * scales
    lowest = grid.lowest if grid else 0
    starts = (exact.biases - lowest) * Fraction(2) ** (result.frac + DROPPED)
    if grid and not grid.nearest:
        _check_whole("weights", weights.ravel().tolist())
        _check_whole("biases", starts.tolist())
    codes = tuple(tuple(map(_near, row)) for row in weights)
    unit = 1 if grid else 1 << DROPPED
    begun = []
    for row, start in zip(codes, starts, strict=True):
        # An earlier output comes with half a unit of its last place added; see ``evaluate``.
        moved = sum(code for code, value in zip(row, values, strict=True) if value.earlier)
        half = moved << (OUTPUT_SHIFT - 1)
        begun.append(_near((start - half) / unit) * unit + _HALF_OUTPUT * exact.output)
    word_of = {value.node: word for word, value in enumerate(values)}
    layer = IntegerLayer(
        codes,
        tuple(begun),
        result,
        rounding=LayerRounding.DOWN if exact.output else LayerRounding.UP,
        low=0 if exact.activation == "relu" else _LOW,
        leaky=exact.activation == "leaky_relu",
        functions=exact.functions,
        added=tuple(
            tuple((word_of[node], function) for node, function in added) for added in exact.added
        ),
    )
    if grid is None:
        return layer
    # Its codes are those of the quantiser, less the lowest of them.
    shift, rounding, high = DROPPED + grid.cut, grid.rounding, grid.high
    return replace(layer, shift=shift, rounding=rounding, low=0, high=high, cut=grid.cut)


def _check_whole(what: str, codes: list[Fraction]) -> None:
    """Refuse codes that are no whole numbers."""
    broken = [code for code in codes if code.denominator != 1]
    if broken:
        worst = max(broken, key=lambda code: abs(code - _near(code)))
        raise InputError(
            f"{len(broken)} of {len(codes)} {what} would be rounded, such as {float(worst):.7g} to "
            f"{_near(worst)} of the smallest step; expected scales of weights, samples and "
            "quantisers whose ratios are powers of two, those of the sums no less than "
            f"1/{1 << DROPPED} of that of the quantiser behind them{OR_NEAREST}"
        )


def _near(value: Fraction) -> int:
    """The nearest whole number, with halves rounded up."""
    return (2 * value.numerator + value.denominator) // (2 * value.denominator)


def _ends(layer: IntegerLayer, values: Sequence[Value]) -> tuple[list[int], list[int]]:
    """The least and the largest code of each node, if codes had unlimited width."""
    low, high = [], []
    for node, (start, codes) in enumerate(zip(layer.starts, layer.weights, strict=True)):
        both = [(c * v.low, c * v.high) for c, v in zip(codes, values, strict=True)]
        reach = (_HIGH + 1) << DROPPED
        both += [(-reach, reach)] * len(layer.added_to(node))
        low.append(layer.rounded(start + sum(map(min, both))))
        high.append(layer.rounded(start + sum(map(max, both))))
    if layer.rectifies:
        low, high = ([max(0, end) for end in ends] for ends in (low, high))
    return low, high


def _values_for_next_layer(
    exact: Exact, layer: IntegerLayer, values: Sequence[Value]
) -> list[Value]:
    """The words that a layer gives to the next layer."""
    found = []
    one = Fraction(1)
    for node, (low, high) in enumerate(zip(*_ends(layer, values), strict=True)):
        ends = max(low, layer.low), min(high, layer.high)
        if exact.grid:
            found.append(Value(node, one, layer.result, 0, exact.grid.high << layer.cut))
        elif layer.functions:
            found.append(Value(node, one, format_of(layer.functions[node]), _LOW, _HIGH))
        elif layer.leaky:
            found.append(Value(node, exact.leak, layer.result, *ends))
            found.append(Value(node, 1 - exact.leak, layer.result, 0, max(0, ends[1])))
        else:
            found.append(Value(node, one, layer.result, *ends))
    return found
