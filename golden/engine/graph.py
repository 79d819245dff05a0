"""The neurons of a scene: sums of products that become words.

Layers, biases and activations alike are such neurons.
"""

from dataclasses import dataclass
from enum import IntEnum

from golden.engine.formats import DROPPED, HIDDEN, OUTPUT_SHIFT, SAMPLE, WIDTH
from golden.engine.function_table import LineTable
from golden.engine.ranges import Range
from golden.numbers.fixed import Fix
from golden.numbers.precision import SIGNAL
from golden.trained.function import TANH, Function


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


# The largest magnitude of the word of a sample.
LARGEST_SAMPLE = -SIGNAL.low << (SAMPLE.frac - SIGNAL.frac)
# The kinds for which the coefficient comes from a table.
LOOKED_UP = (Kind.INTERCEPT, Kind.DISTANCE)


def start_of(output: bool) -> int:
    """The value at which every sum of an engine starts, of outputs or of others."""
    return 1 << (DROPPED - 1 + (OUTPUT_SHIFT if output else 0))


@dataclass(frozen=True)
class Term:
    """One product of a sum.

    source: Number of the value that is read: a sample, or ``inputs`` + the number of a neuron; -1
        for none.
    weight: Code of 18 bits; 0 where the coefficient comes from a table.
    function: The function from whose table the coefficient comes, where it does.
    second: Number of the value that is the coefficient, without its lowest bits; -1 for none.
    """

    kind: Kind
    source: int
    weight: int
    function: Function = TANH
    second: int = -1

    @property
    def values(self) -> tuple[int, int]:
        """The numbers of the values that it reads."""
        return self.source, self.second


# The term of a sum that has no other.
NOTHING = Term(Kind.ONE, -1, 0)


@dataclass(frozen=True)
class Neuron:
    """A sum of products that is rounded, saturated and stored.

    name: How the listing calls it.
    result: Format of the word that the sum becomes.
    output: Whether it is an output of the scene, which is rounded to the signal's format.
    relu: Whether a sum below 0 becomes 0.
    cut: The number of the word's lowest bits that are 0; only a ReLU has any.
    even: Where bits are cut: whether a sum half way between two words becomes the even one.
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
        """Whether it takes functions of other words, such as the tanh of another neuron."""
        return any(term.kind is Kind.INTERCEPT for term in self.terms)

    @property
    def function(self) -> Function:
        """The function that it looks up first; tanh where it looks up none."""
        return next((term.function for term in self.terms if term.kind in LOOKED_UP), TANH)

    @property
    def start(self) -> int:
        """The value at which the sum starts: half a unit of the result, or of an output."""
        return start_of(self.output)


@dataclass(frozen=True)
class Graph:
    """All neurons of a scene, each after those whose results it reads.

    inputs: Samples of a frame.
    useless_nodes: Hidden nodes that are not built, because no output uses them.
    useless_terms: Terms that are left out, because their weight is 0.
    ranges: The range of each hidden layer in which saturation would be an error.
    """

    inputs: int
    neurons: tuple[Neuron, ...]
    useless_nodes: int = 0
    useless_terms: int = 0
    ranges: tuple[Range, ...] = ()

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
    def functions(self) -> tuple[Function, ...]:
        """The functions that neurons look up, each once; tanh where there are none."""
        found = dict.fromkeys(
            term.function
            for neuron in self.neurons
            for term in neuron.terms
            if term.kind in LOOKED_UP
        )
        return tuple(found) or (TANH,)

    @property
    def looks_up(self) -> bool:
        """Whether any neuron takes a function."""
        return any(neuron.looks_up for neuron in self.neurons)

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

    def largest(self, term: Term, table: LineTable) -> int:
        """The largest magnitude that the product of a term can have."""
        if term.kind is Kind.INTERCEPT:
            return max(map(abs, table.intercepts)) << DROPPED
        if term.kind is Kind.DISTANCE:
            return max(map(abs, table.slopes)) << (table.width - 1)
        if term.kind is Kind.ONE:
            return abs(term.weight) << DROPPED
        reach = LARGEST_SAMPLE if term.source < self.inputs else 1 << (WIDTH - 1)
        return abs(term.weight) * reach

    def bound(self, neuron: Neuron, table: LineTable) -> int:
        """The largest magnitude that a neuron's sum can reach, its start included."""
        return neuron.start + sum(self.largest(term, table) for term in neuron.terms)

    def sum_bits(self, table: LineTable) -> int:
        """The number of bits that hold every sum, its sign included."""
        return max(self.bound(neuron, table) for neuron in self.neurons).bit_length() + 1

    def reach(self, table: LineTable) -> int:
        """The largest magnitude of the codes that a function takes; 0 for none."""
        sources = {
            term.source for n in self.neurons for term in n.terms if term.kind is Kind.INTERCEPT
        }
        bounds = [
            LARGEST_SAMPLE
            if source < self.inputs
            else self.bound(self.neurons[source - self.inputs], table) >> DROPPED
            for source in sources
        ]
        return min(max(bounds, default=0), -HIDDEN.low)
