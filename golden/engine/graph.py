"""The neurons of a scene, as sums that become words: layers, biases and activations alike."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from golden.engine.formats import DROPPED, HIDDEN, OUTPUT_SHIFT, SAMPLE, WIDTH
from golden.engine.tanh_table import TanhTable
from golden.fixed import Fix
from golden.precision import SIGNAL


class Kind(IntEnum):
    """What the multiplier's operand is made of the word that was read."""

    WORD = 0
    # The number one with the word's sign.
    INTERCEPT = 1
    # Its low bits, as a distance from the middle of the segment.
    DISTANCE = 2
    # The number one; the word does not matter.
    ONE = 3


@dataclass(frozen=True)
class Term:
    """One product of a sum.

    Parameters
    ----------
    kind : Kind
    source : int
        The value that is read: a sample, or ``inputs`` + the number of a neuron; -1 for none.
    weight : int
        Code of 18 bits; 0 where the table gives it.
    """

    kind: Kind
    source: int
    weight: int


@dataclass(frozen=True)
class Neuron:
    """A sum of products that is rounded, saturated and kept.

    Parameters
    ----------
    name : str
        For the listing.
    result : Fix
        Format of the word that it becomes.
    terms : tuple of Term
    output : bool
        An output of the scene: rounded to the signal's format.
    relu : bool
        A sum below 0 becomes 0.
    cut : int
        Lowest bits of the word that are 0; of a ReLU alone.
    even : bool
        Where bits are cut, a sum half way between two words becomes the even one.
    """

    name: str
    result: Fix
    terms: tuple[Term, ...]
    output: bool = False
    relu: bool = False
    cut: int = 0
    even: bool = False

    @property
    def constant(self) -> bool:
        """Whether it takes nothing but the number one."""
        return all(term.kind is Kind.ONE for term in self.terms)

    @property
    def looks_up(self) -> bool:
        """Whether it is the tanh of another neuron."""
        return any(term.kind is Kind.INTERCEPT for term in self.terms)

    @property
    def start(self) -> int:
        """What the sum starts with: half a unit of its result, or of the output."""
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

    @property
    def rectifies(self) -> bool:
        """Whether any sum below 0 becomes 0."""
        return any(neuron.relu for neuron in self.neurons)

    @property
    def cut(self) -> int:
        """Lowest bits that every word of a ReLU has not."""
        return max((neuron.cut for neuron in self.neurons), default=0)

    @property
    def even(self) -> bool:
        """Whether sums half way between two words of a ReLU become the even one."""
        return any(neuron.even for neuron in self.neurons)

    @property
    def first_sums(self) -> list[Neuron]:
        """The hidden sums that see nothing but samples and outputs."""
        return [
            neuron
            for neuron in self.neurons
            if not (neuron.output or neuron.looks_up)
            and not any(self._is_hidden(t.source) for t in neuron.terms)
        ]

    def _is_hidden(self, source: int) -> bool:
        if source < self.inputs:
            return False
        neuron = self.neurons[source - self.inputs]
        return not (neuron.output or neuron.constant)

    def format_of(self, source: int) -> Fix:
        """The format of a value."""
        return SAMPLE if source < self.inputs else self.neurons[source - self.inputs].result

    def largest(self, term: Term, table: TanhTable) -> int:
        """The largest magnitude of a product."""
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
        """The largest magnitude code of q that any sum in front of a tanh can be; 0 for none."""
        sums = {n.terms[0].source - self.inputs for n in self.neurons if n.looks_up}
        bounds = [self.bound(self.neurons[place], table) >> DROPPED for place in sums]
        return min(max(bounds, default=0), -HIDDEN.low)
