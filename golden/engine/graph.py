"""The neurons of a scene: sums of products that become words. tanh is such a neuron too."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum
from fractions import Fraction

from golden.engine.formats import (
    DROPPED,
    HIDDEN,
    ONE,
    OUTPUT_SHIFT,
    RESULT,
    SAMPLE,
    WIDTH,
    coeff_frac,
)
from golden.engine.tanh_table import TanhTable
from golden.fixed import Fix
from golden.mlp import Mlp
from golden.precision import SIGNAL

_MOST = (1 << (WIDTH - 1)) - 1


class Kind(IntEnum):
    """How the multiplier's operand is made from the word that was read."""

    # The word itself.
    WORD = 0
    # The number one with the sign of the word.
    INTERCEPT = 1
    # The low bits of the word, as a distance from the middle of the segment.
    DISTANCE = 2
    # The number one, whatever the word is.
    ONE = 3


@dataclass(frozen=True)
class Term:
    """One product of a sum.

    Parameters
    ----------
    kind : Kind
    source : int
        Number of the value that is read: a sample, or ``inputs`` + the number of a neuron; -1 for
        none.
    weight : int
        Code of 18 bits; 0 where the coefficient comes from the table of tanh.
    """

    kind: Kind
    source: int
    weight: int


@dataclass(frozen=True)
class Neuron:
    """A sum of products that is rounded, saturated and stored.

    Parameters
    ----------
    name : str
        How the listing calls it.
    result : Fix
        Format of the word that the sum becomes.
    terms : tuple of Term
    output : bool
        Whether it is an output of the scene, which is rounded to the signal's format.
    """

    name: str
    result: Fix
    terms: tuple[Term, ...]
    output: bool = False

    @property
    def start(self) -> int:
        """The value at which the sum starts: half a unit of the result, or of an output."""
        return 1 << (DROPPED - 1 + (OUTPUT_SHIFT if self.output else 0))


@dataclass(frozen=True)
class Graph:
    """All neurons of a scene, each after those whose results it reads.

    Parameters
    ----------
    inputs : int
        Samples of a frame.
    neurons : tuple of Neuron
    useless_nodes : int
        Hidden nodes that are not built, because no output uses them.
    useless_terms : int
        Terms that are left out, because their weight is 0.
    """

    inputs: int
    neurons: tuple[Neuron, ...]
    useless_nodes: int = 0
    useless_terms: int = 0

    @property
    def outputs(self) -> int:
        return sum(neuron.output for neuron in self.neurons)

    def format_of(self, source: int) -> Fix:
        """The format of a value."""
        return SAMPLE if source < self.inputs else self.neurons[source - self.inputs].result

    def largest(self, term: Term, table: TanhTable) -> int:
        """The largest magnitude that the product of a term can have."""
        if term.kind is Kind.INTERCEPT:
            return max(table.intercepts) << DROPPED
        if term.kind is Kind.DISTANCE:
            return max(table.slopes) << (table.width - 1)
        if term.kind is Kind.ONE:
            return abs(term.weight) << DROPPED
        low = -SIGNAL.low << (SAMPLE.frac - SIGNAL.frac)
        reach = low if term.source < self.inputs else 1 << (WIDTH - 1)
        return abs(term.weight) * reach

    def bound(self, neuron: Neuron, table: TanhTable) -> int:
        """The largest magnitude that a neuron's sum can reach, its start included."""
        return neuron.start + sum(self.largest(term, table) for term in neuron.terms)

    def reach(self, table: TanhTable) -> int:
        """The largest magnitude that the code of q can have in any hidden neuron."""
        sums = [n for n in self.neurons if n.result == HIDDEN]
        bounds = [self.bound(neuron, table) >> DROPPED for neuron in sums]
        return min(max(bounds), -HIDDEN.low)


def graph_of(arrangement: str, mlps: Sequence[Mlp], lean: bool = True) -> Graph:
    """The neurons of trained networks.

    Parameters
    ----------
    arrangement : str
        "single", "multiple" or "cascade".
    mlps : sequence of Mlp
    lean : bool
        Whether to leave out terms whose weight is zero, and hidden nodes that no output uses. The
        results are the same either way.

    Notes
    -----
    A weight that does not fit in 18 bits becomes several terms. A later network of a cascade reads
    an output as its word holds it, before the lowest bits are dropped. Half a unit of the output's
    last place has been added to this word for rounding; the biases of the later network subtract it
    again.
    """
    samples = mlps[0].shape[0]
    neurons: list[Neuron] = []
    earlier: list[int] = []
    useless = zeros = 0
    for number, mlp in enumerate(mlps):
        place = f"network {number + 1} " if len(mlps) > 1 else ""
        seen = [*range(samples), *(earlier if arrangement == "cascade" else [])]
        second = [[_code(w, RESULT, RESULT) for w in row] for row in mlp.w2.tolist()]
        hidden = range(mlp.shape[1])
        used = [j for j in hidden if not lean or any(row[j] for row in second)] or [0]
        useless += len(hidden) - len(used)
        activated = {}
        for j in used:
            weights = [
                (source, _code(w, HIDDEN, SAMPLE if source < samples else RESULT))
                for source, w in zip(seen, mlp.w1[j].tolist(), strict=True)
            ]
            # Half a unit of the output's last place, times the sum of the weights of earlier
            # outputs.
            moved = sum(code for source, code in weights if source >= samples)
            half = Fraction(1, 1 << (SIGNAL.frac + 1 + coeff_frac(HIDDEN, RESULT)))
            bias = _code(Fraction(mlp.b1[j]) - moved * half, HIDDEN, ONE)
            name = f"{place}node {j + 1}"
            neurons.append(Neuron(f"{name} sum", HIDDEN, _terms(bias, weights, lean)))
            value = samples + len(neurons) - 1
            zeros += lean * sum(not code for code in (bias, *(code for _, code in weights)))
            terms = (Term(Kind.INTERCEPT, value, 0), Term(Kind.DISTANCE, value, 0))
            neurons.append(Neuron(f"{name} tanh", RESULT, terms))
            activated[j] = samples + len(neurons) - 1
        outputs = []
        for i, row in enumerate(second):
            name = f"output {len(earlier) + i + 1}"
            bias = _code(Fraction(mlp.b2[i]), RESULT, ONE)
            weights = [(activated[j], row[j]) for j in used]
            zeros += lean * sum(not code for code in (bias, *(code for _, code in weights)))
            neurons.append(Neuron(name, RESULT, _terms(bias, weights, lean), output=True))
            outputs.append(samples + len(neurons) - 1)
        earlier += outputs
    return Graph(samples, tuple(neurons), useless, zeros)


def _code(value: float | Fraction, result: Fix, operand: Fix) -> int:
    """The nearest code of a weight, with halves rounded up. The code may have any width."""
    scaled = Fraction(value) * (1 << coeff_frac(result, operand))
    return int((2 * scaled + 1) // 2)


def _terms(bias: int, weights: Sequence[tuple[int, int]], lean: bool) -> tuple[Term, ...]:
    found = [Term(Kind.ONE, -1, part) for part in _parts(bias)]
    for source, weight in weights:
        found += [Term(Kind.WORD, source, part) for part in _parts(weight)]
    kept = [term for term in found if term.weight] if lean else found
    return tuple(kept or [Term(Kind.ONE, -1, 0)])


def _parts(code: int) -> Iterator[int]:
    """Split a code into codes of 18 bits whose sum it is."""
    count = max(1, -(-abs(code) // _MOST))
    for k in range(count):
        yield code * (k + 1) // count - code * k // count
