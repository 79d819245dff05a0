"""Makes the neurons of an engine from trained networks: codes of weights, and a format per layer.

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

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

from golden.cli import naming
from golden.dense import Trained, layers_of
from golden.engine.formats import (
    DROPPED,
    HIDDEN,
    ONE,
    RESULT,
    SAMPLE,
    SAMPLE_SHIFT,
    WIDTH,
    coeff_frac,
)
from golden.engine.function_table import format_of
from golden.engine.graph import Graph, Kind, Neuron, Term
from golden.engine.grid import OR_NEAREST, Grid, grid_of
from golden.engine.ranges import ENOUGH, Range, frac_of
from golden.fixed import Fix
from golden.function import TANH, Function
from golden.input_error import InputError
from golden.precision import SIGNAL

_MOST = (1 << (WIDTH - 1)) - 1
_HALF = 1 << (DROPPED - 1)
# A weight that does not fit in a word is as many terms as it takes, up to this number. No program
# has more words than four times this.
_MOST_TERMS = 1 << 16
# The least and the largest word.
_LOW, _HIGH = RESULT.low, RESULT.high


@dataclass(frozen=True)
class Value:
    """A word that a layer takes as an operand.

    Parameters
    ----------
    node : int
        The input of the layer to which it belongs. A node with leaky ReLU has two words.
    factor : Fraction
        The factor by which the weights of that input are multiplied.
    fmt : Fix
    low, high : int
        The least and the largest code.
    earlier : bool
        Whether it is an output of an earlier network.
    """

    node: int
    factor: Fraction
    fmt: Fix
    low: int
    high: int
    earlier: bool = False


@dataclass(frozen=True)
class Sums:
    """One layer, in codes.

    Parameters
    ----------
    activation : str
        "table", "relu", "leaky_relu", "hard_tanh" or "linear".
    result : Fix
        Format of the words that its sums become.
    biases : list of int
    weights : list of list of int
        A list for each node, with a weight for each word that it takes.
    values : list of Value
        The words that the next layer takes.
    grid : Grid or None
        The grid of a layer with a quantiser.
    rests : list of int
        For such a layer, the part of each sum's start value that is below the unit of a bias.
    range : Range or None
        The range of a layer in which saturation would be an error.
    functions : tuple of Function
        Of a "table", the function of each node.
    """

    activation: str
    result: Fix
    biases: list[int]
    weights: list[list[int]]
    values: list[Value]
    grid: Grid | None = None
    rests: list[int] = field(default_factory=list)
    range: Range | None = None
    functions: tuple[Function, ...] = ()


@dataclass(frozen=True)
class Exact:
    """One layer of a network, with numbers that are not rounded."""

    activation: str
    leak: Fraction
    weights: list[list[Fraction]]
    biases: list[Fraction]
    grid: Grid | None
    functions: tuple[Function, ...]


def exact_layers(network: Trained) -> list[Exact]:
    """The layers of a network, with sigmoid replaced by tanh.

    Behind a quantiser, words are differences from the lowest code. The biases of the next layer
    compensate for that.

    Raises
    ------
    InputError
        See ``grid_of``.
    """
    found: list[Exact] = []
    halved = False
    for number, layer in enumerate(layers_of(network), start=1):
        weights = [[Fraction(w) for w in row] for row in layer.weights.tolist()]
        biases = [Fraction(b) for b in layer.biases.tolist()]
        if halved:
            weights = [[w / 2 for w in row] for row in weights]
            biases = [b + sum(row) for b, row in zip(biases, weights, strict=True)]
        halved = layer.activation == "sigmoid"
        if halved:
            weights = [[w / 2 for w in row] for row in weights]
            biases = [b / 2 for b in biases]
        before = found[-1].grid if found else None
        if before:
            weights = [[w / before.factor for w in row] for row in weights]
            lowest = before.lowest
            biases = [b + lowest * sum(row) for b, row in zip(biases, weights, strict=True)]
        with naming(f"layer {number}"):
            grid = grid_of(layer)
        if grid:
            weights = [[w * grid.factor for w in row] for row in weights]
            biases = [b * grid.factor for b in biases]
        functions = layer.functions
        if layer.activation in ("tanh", "sigmoid"):
            functions = (TANH,) * layer.nodes
        kind = "table" if functions else layer.activation
        found.append(Exact(kind, Fraction(layer.leak), weights, biases, grid, functions))
    return found


def first_values(samples: int, earlier: int) -> list[Value]:
    """The operands of the first layer of a network: samples, and outputs of earlier networks."""
    ends = SIGNAL.low << SAMPLE_SHIFT, SIGNAL.high << SAMPLE_SHIFT
    one = Fraction(1)
    found = [Value(k, one, SAMPLE, *ends) for k in range(samples)]
    more = range(samples, samples + earlier)
    return found + [Value(k, one, RESULT, _LOW, _HIGH, earlier=True) for k in more]


def planned(network: Trained, values: list[Value], met: Sequence[float] = ()) -> list[Sums]:
    """The codes and formats of every layer of a network whose inputs are ``values``.

    ``met`` is what ``met_by`` finds on recorded frames; without it every range is from bounds.

    Raises
    ------
    InputError
        When the sums of a layer are too large for any format.
    """
    layers = exact_layers(network)
    found: list[Sums] = []
    for number, layer in enumerate(layers, start=1):
        output = number == len(layers)
        if layer.grid:
            with naming(f"layer {number}"):
                sums = _on_grid(layer, layer.grid, values)
            ends = 0, layer.grid.high
            values = [Value(j, Fraction(1), sums.result, *ends) for j in range(len(sums.biases))]
            found.append(replace(sums, values=values))
            continue
        fixed = RESULT if output or layer.activation == "hard_tanh" else None
        fixed = HIDDEN if layer.functions else fixed
        if fixed:
            sums = _coded(layer, fixed, values)
        else:
            with naming(f"layer {number}"):
                sums = _ranged(layer, values, met[number - 1] if met else 0.0)
        values = _given(layer, sums.result, *_ends(layer, sums, values))
        found.append(replace(sums, values=values))
    return found


def _ranged(layer: Exact, values: Sequence[Value], met: float) -> Sums:
    """The codes of a layer in which saturation would be an error; see ``golden.engine.ranges``.

    Raises
    ------
    InputError
        When the sums are too large for any format.
    """
    for frac in range(WIDTH - 1, -1, -1):
        sums = _coded(layer, Fix(WIDTH, frac), values)
        low, high = _ends(layer, sums, values)
        most = max(*high, -min(low))
        if min(low) >= _LOW and max(high) <= _HIGH:
            break
    else:
        frac = -1
    bound = most / 2.0 ** max(frac, 0)
    known = frac_of(met, WIDTH) if met else -1
    if known > frac and met * 2.0**frac < 1 << ENOUGH:
        fmt = Fix(WIDTH, known)
        return replace(_coded(layer, fmt, values), range=Range(fmt, bound, met, True))
    if frac < 0:
        raise InputError(f"got sums that reach {most:g}, expected {_HIGH} at most")
    return replace(sums, range=Range(sums.result, bound, met, False))


def _on_grid(layer: Exact, grid: Grid, values: Sequence[Value]) -> Sums:
    """The codes of a layer with which each sum is exact, or of the nearest weights and biases.

    Raises
    ------
    InputError
        When a weight or a bias is no whole number of code units, and must not be rounded.
    """
    fracs = [coeff_frac(grid.result, v.fmt) for v in values]
    weights = [
        [
            row[v.node] * v.factor * Fraction(2) ** frac
            for v, frac in zip(values, fracs, strict=True)
        ]
        for row in layer.weights
    ]
    starts = [
        (bias - grid.lowest) * Fraction(2) ** (grid.result.frac + DROPPED) for bias in layer.biases
    ]
    if not grid.nearest:
        _check_whole("weights", [weight for row in weights for weight in row])
        _check_whole("biases", starts)
    biases, rests = (
        list(part)
        for part in zip(*(divmod(_near(s) + grid.start, 1 << DROPPED) for s in starts), strict=True)
    )
    codes = [[_near(weight) for weight in row] for row in weights]
    return Sums(layer.activation, grid.result, biases, codes, [], grid, rests)


def _check_whole(what: str, codes: list[Fraction]) -> None:
    """Refuse codes that are no whole numbers.

    Raises
    ------
    InputError
    """
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
    return int((2 * value + 1) // 2)


def _coded(layer: Exact, result: Fix, values: Sequence[Value]) -> Sums:
    """The codes of a layer, for one format of its words."""
    weights = [
        [_code(row[value.node] * value.factor, result, value.fmt) for value in values]
        for row in layer.weights
    ]
    biases = []
    for bias, codes in zip(layer.biases, weights, strict=True):
        # An earlier output comes with half a unit of its last place added; see ``graph_of``.
        moved = sum(code for code, v in zip(codes, values, strict=True) if v.earlier)
        half = Fraction(1, 1 << (SIGNAL.frac + 1)) / Fraction(2) ** coeff_frac(result, RESULT)
        biases.append(_code(bias - moved * half, result, ONE))
    return Sums(layer.activation, result, biases, weights, [], functions=layer.functions)


def _ends(layer: Exact, sums: Sums, values: Sequence[Value]) -> tuple[list[int], list[int]]:
    """The least and the largest word of each node, if words had unlimited width."""
    low, high = [], []
    for bias, codes in zip(sums.biases, sums.weights, strict=True):
        both = [(c * v.low, c * v.high) for c, v in zip(codes, values, strict=True)]
        start = (bias << DROPPED) + _HALF
        low.append((start + sum(map(min, both))) >> DROPPED)
        high.append((start + sum(map(max, both))) >> DROPPED)
    if layer.activation == "relu":
        low, high = ([max(0, end) for end in ends] for ends in (low, high))
    return low, high


def _given(layer: Exact, result: Fix, low: list[int], high: list[int]) -> list[Value]:
    """The words that a layer gives to the next layer."""
    found = []
    one = Fraction(1)
    for node, (least, most) in enumerate(zip(low, high, strict=True)):
        ends = max(least, _LOW), min(most, _HIGH)
        if layer.functions:
            found.append(Value(node, one, format_of(layer.functions[node]), _LOW, _HIGH))
        elif layer.activation == "leaky_relu":
            found.append(Value(node, layer.leak, result, *ends))
            found.append(Value(node, 1 - layer.leak, result, 0, max(0, ends[1])))
        else:
            found.append(Value(node, one, result, *ends))
    return found


def graph_of(
    arrangement: str,
    networks: Sequence[Trained],
    lean: bool = True,
    met: Sequence[Sequence[float]] = (),
) -> Graph:
    """The neurons of trained networks.

    Parameters
    ----------
    arrangement : str
        "single", "multiple" or "cascade".
    networks : sequence of Mlp or DenseNetwork
    lean : bool
        Whether to leave out terms of zero weight, and hidden nodes that no output uses. The results
        are the same either way.
    met : sequence of sequences of float
        For each network what ``met_by`` finds on recorded frames; empty where there are none.

    Notes
    -----
    A weight that does not fit in 18 bits becomes several terms. A later network of a cascade reads
    the word of an output, to which half a unit of the output's last place is added; the biases of
    that network subtract it again. If the start value of a sum in a quantised layer has a part
    below the unit of a bias, this part is the weight of a word of one unit, which is a neuron of
    its own.
    """
    samples = networks[0].shape[0]
    neurons: list[Neuron] = []
    earlier: list[int] = []
    useless = zeros = 0
    plans: list[list[Sums]] = []
    ranges: list[Range] = []
    for network, reached in zip(networks, met or [()] * len(networks), strict=True):
        outputs = sum(len(plan[-1].biases) for plan in plans) if arrangement == "cascade" else 0
        plans.append(planned(network, first_values(samples, outputs), reached))
        _check_terms(plans[-1])
    _check_grids([x.grid for plan in plans for x in plan if "relu" in x.activation or x.grid])
    built = [_used(plan, lean) for plan in plans]
    pairs = [
        (layer, j)
        for plan, used in zip(plans, built, strict=True)
        for layer, nodes in zip(plan, used, strict=True)
        for j in nodes
    ]
    if any(layer.grid and layer.rests[j] for layer, j in pairs):
        neurons.append(Neuron("one unit", RESULT, (Term(Kind.ONE, -1, 1),)))
    for number, (layers, used) in enumerate(zip(plans, built, strict=True)):
        place = f"network {number + 1} " if len(networks) > 1 else ""
        seen = [*range(samples), *(earlier if arrangement == "cascade" else [])]
        useless += sum(
            len(layer.biases) - len(nodes) for layer, nodes in zip(layers, used, strict=True)
        )
        # Where each word is that a layer takes. Words of nodes that are not built are missing.
        sources: dict[int, int] = dict(enumerate(seen))
        for depth, (layer, nodes) in enumerate(zip(layers, used, strict=True), start=1):
            output = depth == len(layers)
            where = f"layer {depth} " if len(layers) > 2 else ""
            taken, sources = sources, {}
            firsts = []
            for j in nodes:
                name = f"output {len(earlier) + 1}" if output else f"{place}{where}node {j + 1}"
                weights = [(source, layer.weights[j][k]) for k, source in taken.items()]
                codes = (layer.biases[j], *(code for _, code in weights))
                zeros += lean * sum(not code for code in codes)
                if layer.grid and layer.rests[j]:
                    weights = [(samples, layer.rests[j]), *weights]
                terms = _terms(layer.biases[j], weights, lean)
                last = samples + len(neurons)
                firsts.append(len(neurons))
                made = [*_node(name, layer, terms, last, output, j)]
                neurons += made
                if output:
                    earlier.append(last)
                elif layer.activation == "leaky_relu":
                    sources |= {2 * j: last, 2 * j + 1: last + 1}
                else:
                    sources[j] = last + len(made) - 1
            if layer.range:
                text = f"{place}layer {depth}"
                ranges.append(replace(layer.range, layer=text, places=tuple(firsts)))
    return Graph(samples, tuple(neurons), useless, zeros, tuple(ranges))


def _check_terms(plan: list[Sums]) -> None:
    """Refuse a weight or a bias that would become more terms than any memory holds.

    Raises
    ------
    InputError
    """
    for number, layer in enumerate(plan, start=1):
        rows = zip(layer.biases, layer.weights, strict=True)
        for node, (bias, weights) in enumerate(rows, start=1):
            terms = -(-max(map(abs, (bias, *weights))) // _MOST)
            if terms > _MOST_TERMS:
                raise InputError(
                    f"layer {number}: node {node}: got a weight or a bias that takes {terms} "
                    f"products of {WIDTH} bits, expected {_MOST_TERMS} at most; scale samples and "
                    "outputs so that weights are smaller"
                )


def _check_grids(grids: list[Grid | None]) -> None:
    """Refuse different quantisers in one engine, which rounds all of its words alike.

    Raises
    ------
    InputError
    """
    kinds = {(WIDTH - 1 - g.cut, g.even) if g else None for g in grids}
    if len(kinds) > 1:
        texts = sorted(
            f"{kind[0]} bits{', halves to even' * kind[1]}" if kind else "none" for kind in kinds
        )
        raise InputError(
            f"quantisers: got layers of {' and of '.join(texts)}, expected the same for every "
            "layer with ReLU or a quantiser, the samples' too"
        )


def _node(
    name: str, layer: Sums, terms: tuple[Term, ...], place: int, output: bool, node: int
) -> Iterator[Neuron]:
    """The neurons of one node of a layer. The first of them is the value ``place``."""
    if output:
        yield Neuron(name, layer.result, terms, output=True)
    elif layer.functions:
        function = layer.functions[node]
        yield Neuron(f"{name} sum", layer.result, terms)
        looked_up = (Term(Kind.INTERCEPT, place, 0), Term(Kind.DISTANCE, place, 0))
        result = format_of(function)
        yield Neuron(f"{name} {function.name}", result, looked_up, function=function)
    elif layer.activation == "leaky_relu":
        yield Neuron(f"{name} sum", layer.result, terms)
        itself = Term(Kind.WORD, place, 1 << coeff_frac(layer.result, layer.result))
        yield Neuron(f"{name} relu", layer.result, (itself,), relu=True)
    elif layer.grid:
        yield Neuron(name, layer.result, terms, False, True, layer.grid.cut, layer.grid.even)
    else:
        yield Neuron(name, layer.result, terms, relu=layer.activation == "relu")


def _used(layers: Sequence[Sums], lean: bool) -> list[list[int]]:
    """The nodes of each layer that a later layer uses.

    A node that nothing uses could come after the last output, which must be the last of all.
    """
    found = [list(range(len(layer.biases))) for layer in layers]
    for n in range(len(layers) - 1, 0, -1) if lean else ():
        rows = [layers[n].weights[j] for j in found[n]]
        nodes = {
            value.node
            for k, value in enumerate(layers[n - 1].values)
            if any(row[k] for row in rows)
        }
        found[n - 1] = sorted(nodes)
    return found


def _code(value: Fraction, result: Fix, operand: Fix) -> int:
    """The nearest code of a weight, with halves rounded up. It may have any width."""
    frac = coeff_frac(result, operand)
    return _near(value * (1 << frac) if frac >= 0 else value / (1 << -frac))


def _terms(bias: int, weights: Sequence[tuple[int, int]], lean: bool) -> tuple[Term, ...]:
    found = [Term(Kind.ONE, -1, part) for part in _parts(bias)]
    for source, weight in weights:
        found += [Term(Kind.WORD, source, part) for part in _parts(weight)]
    kept = [term for term in found if term.weight] if lean else found
    return tuple(kept or [Term(Kind.ONE, -1, 0)])


def _parts(code: int) -> Iterator[int]:
    """A code as a sum of codes of 18 bits."""
    count = max(1, -(-abs(code) // _MOST))
    for k in range(count):
        yield code * (k + 1) // count - code * k // count
