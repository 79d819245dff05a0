"""Compiles integer networks to the neurons of an engine."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from golden.engine.formats import DROPPED, RESULT, WIDTH, coeff_frac
from golden.engine.function_table import format_of
from golden.engine.graph import LOOKED_UP, NOTHING, Graph, Kind, Neuron, Term, start_of
from golden.engine.integer_network import IntegerLayer, IntegerNetwork, LayerRounding
from golden.engine.ranges import Range
from golden.input_error import InputError
from golden.trained.function import Function

_MOST = (1 << (WIDTH - 1)) - 1
# A weight that does not fit in a word is as many terms as it takes, up to this number. No program
# has more words than four times this.
_MOST_TERMS = 1 << 16


def graph_of(networks: Sequence[IntegerNetwork], lean: bool = True) -> Graph:
    """The neurons of integer networks.

    lean: Whether to leave out terms of zero weight, and hidden nodes that no output uses. The
        results are the same either way.

    A weight that does not fit in 18 bits becomes several terms. The start of a sum becomes a bias,
    whose operand is the number one, without the half unit that every sum of an engine begins with.
    If it has a part below the unit of a bias, this part is the weight of a word of one unit, which
    is a neuron of its own.
    """
    samples = networks[0].samples
    neurons: list[Neuron] = []
    earlier: list[int] = []
    useless = zeros = 0
    ranges: list[Range] = []
    plans = [network.layers for network in networks]
    starts = [[_biases(layer, layer is layers[-1]) for layer in layers] for layers in plans]
    for layers, begun in zip(plans, starts, strict=True):
        _check_terms(layers, begun)
    _check_quantisers([layer for layers in plans for layer in layers])
    built = [_used(layers, lean) for layers in plans]
    rests = [
        pairs[j][1]
        for begun, used in zip(starts, built, strict=True)
        for pairs, nodes in zip(begun, used, strict=True)
        for j in nodes
    ]
    if any(rests):
        neurons.append(Neuron("one unit", RESULT, (Term(Kind.ONE, -1, 1),)))
    for number, network in enumerate(networks):
        layers, used = network.layers, built[number]
        place = f"network {number + 1} " if len(networks) > 1 else ""
        useless += sum(layer.nodes - len(nodes) for layer, nodes in zip(layers, used, strict=True))
        # Where each word is that a layer takes. Words of nodes that are not built are missing.
        sources = dict(enumerate([*range(samples), *earlier[: network.earlier]]))
        for depth, (layer, nodes) in enumerate(zip(layers, used, strict=True), start=1):
            output = depth == len(layers)
            where = f"layer {depth} " if len(layers) > 2 else ""
            taken, sources = sources, {}
            firsts = []
            for j in nodes:
                bias, rest = starts[number][depth - 1][j]
                name = f"output {len(earlier) + 1}" if output else f"{place}{where}node {j + 1}"
                weights = [(source, layer.weights[j][k]) for k, source in taken.items()]
                zeros += lean * sum(not code for code in (bias, *(code for _, code in weights)))
                if rest:
                    weights = [(samples, rest), *weights]
                terms = _terms(bias, weights, lean)
                added = layer.added_to(j)
                for word, function in added:
                    terms += _looked_up(taken[word], function)
                # Whatever is added starts the sum as well.
                if added and lean and terms[0] == NOTHING:
                    terms = terms[1:]
                last = samples + len(neurons)
                firsts.append(len(neurons))
                made = [*_node(name, layer, terms, last, output, j)]
                neurons += made
                if output:
                    earlier.append(last)
                elif layer.leaky:
                    sources |= {2 * j: last, 2 * j + 1: last + 1}
                else:
                    sources[j] = last + len(made) - 1
            if layer.range:
                text = f"{place}layer {depth}"
                ranges.append(replace(layer.range, layer=text, places=tuple(firsts)))
    return Graph(samples, tuple(neurons), useless, zeros, tuple(ranges))


def _biases(layer: IntegerLayer, output: bool) -> list[tuple[int, int]]:
    """The bias of each node, and what remains of the start of its sum below the unit of a bias."""
    half = 0 if layer.rounding is LayerRounding.DOWN else 1 << (layer.shift - 1)
    return [divmod(start + half - start_of(output), 1 << DROPPED) for start in layer.starts]


def _check_terms(
    layers: Sequence[IntegerLayer], starts: Sequence[Sequence[tuple[int, int]]]
) -> None:
    """Refuse a weight or a bias that would become more terms than any memory holds."""
    for number, (layer, biases) in enumerate(zip(layers, starts, strict=True), start=1):
        rows = zip(biases, layer.weights, strict=True)
        for node, ((bias, _), weights) in enumerate(rows, start=1):
            terms = -(-max(map(abs, (bias, *weights))) // _MOST)
            if terms > _MOST_TERMS:
                raise InputError(
                    f"layer {number}: node {node}: got a weight or a bias that takes {terms} "
                    f"products of {WIDTH} bits, expected {_MOST_TERMS} at most; scale samples and "
                    "outputs so that weights are smaller"
                )


def _check_quantisers(layers: Sequence[IntegerLayer]) -> None:
    """Refuse different quantisers in one engine, which rounds all words of a ReLU alike."""
    kinds = {
        (WIDTH - 1 - layer.cut, layer.rounding is LayerRounding.EVEN) if layer.cut else None
        for layer in layers
        if layer.rectifies or layer.leaky
    }
    if len(kinds) > 1:
        texts = sorted(
            f"{kind[0]} bits{', halves to even' * kind[1]}" if kind else "none" for kind in kinds
        )
        raise InputError(
            f"quantisers: got layers of {' and of '.join(texts)}, expected the same for every "
            "layer with ReLU or a quantiser, the samples' too"
        )


def _node(
    name: str, layer: IntegerLayer, terms: tuple[Term, ...], place: int, output: bool, node: int
) -> Iterator[Neuron]:
    """The neurons of one node of a layer. The first of them is the value ``place``."""
    if output:
        yield Neuron(name, layer.result, terms, output=True)
    elif layer.functions:
        function = layer.functions[node]
        yield Neuron(f"{name} sum", layer.result, terms)
        yield Neuron(f"{name} {function.name}", format_of(function), _looked_up(place, function))
    elif layer.leaky:
        yield Neuron(f"{name} sum", layer.result, terms)
        itself = Term(Kind.WORD, place, 1 << coeff_frac(layer.result, layer.result))
        yield Neuron(f"{name} relu", layer.result, (itself,), relu=True)
    else:
        even = layer.rounding is LayerRounding.EVEN
        yield Neuron(name, layer.result, terms, False, layer.rectifies, layer.cut, even)


def _looked_up(source: int, function: Function) -> tuple[Term, ...]:
    """The terms of a function of a word: the intercept of its segment, and the slope."""
    return tuple(Term(kind, source, 0, function) for kind in LOOKED_UP)


def _used(layers: Sequence[IntegerLayer], lean: bool) -> list[list[int]]:
    """The nodes of each layer that a later layer uses.

    A node that nothing uses could come after the last output, which must be the last of all.
    """
    found = [list(range(layer.nodes)) for layer in layers]
    for n in range(len(layers) - 1, 0, -1) if lean else ():
        rows = [layers[n].weights[j] for j in found[n]]
        per = 1 + layers[n - 1].leaky
        words = {k for row in rows for k, code in enumerate(row) if code}
        words |= {word for j in found[n] for word, _ in layers[n].added_to(j)}
        found[n - 1] = sorted({word // per for word in words})
    return found


def _terms(bias: int, weights: Sequence[tuple[int, int]], lean: bool) -> tuple[Term, ...]:
    found = [Term(Kind.ONE, -1, part) for part in _parts(bias)]
    for source, weight in weights:
        found += [Term(Kind.WORD, source, part) for part in _parts(weight)]
    kept = [term for term in found if term.weight] if lean else found
    return tuple(kept or [NOTHING])


def _parts(code: int) -> Iterator[int]:
    """A code as a sum of codes of 18 bits."""
    count = max(1, -(-abs(code) // _MOST))
    for k in range(count):
        yield code * (k + 1) // count - code * k // count
