"""LMS as sums of an engine, bit for bit that of ``golden.learning.gradient``.

A *sum* is what it is in an engine: products, one in each step, then half a unit, rounding and
saturation, and a word that is stored. An engine that does not learn lacks:

=========  =======================================================================================
what       how
=========  =======================================================================================
product    the coefficient is a second word without its three lowest bits, with the sign kept
places     a word is stored where the step says, not at the next address
exchange   theta stands twice; an equation reads the one copy and writes the other, and they are
           exchanged unless a new word saturated: the step is not taken then, and flagged
=========  =======================================================================================

Samples and known outputs lie where the sequencer of placements points. The steps of all equations,
one after the other, are one pass over one placement.
"""

from collections.abc import Iterator, Sequence

from golden.engine.formats import DROPPED, RESULT, WIDTH
from golden.engine.graph import LOOKED_UP, Graph, Kind, Neuron, Term, start_of
from golden.learning.corrected import Corrected
from golden.learning.gradient import row_weights
from golden.numbers.fixed import Fix

_WORD = Fix(WIDTH, 0)


class Sums:
    """Sums as neurons of an engine, whose words are called by names.

    With a second word, a term is a product of two words, which is not in an engine that does not
    learn.

    names: Those of the words that are in the memory before.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self.names = names
        self.neurons: list[Neuron] = []
        self._numbers = {name: n for n, name in enumerate(names)}

    @property
    def graph(self) -> Graph:
        return Graph(len(self.names), tuple(self.neurons))

    def add(self, name: str, *terms: Term, output: bool = False) -> None:
        """Append a sum; with ``output`` it begins with half a unit of an output, not of a word."""
        self._numbers[name] = len(self._numbers)
        self.neurons.append(Neuron(name, RESULT, terms, output=output))

    def by(self, name: str, weight: int) -> Term:
        """A word times a weight."""
        return Term(Kind.WORD, self._numbers[name], weight)

    def times(self, name: str, second: str) -> Term:
        """A word times a second word."""
        return Term(Kind.WORD, self._numbers[name], 0, second=self._numbers[second])

    def whole(self, name: str, sign: int = 1) -> Term:
        """A word itself, as a term of a sum in its own format."""
        return self.by(name, sign << DROPPED)

    def looked_up(self, name: str) -> Iterator[Term]:
        """The terms of tanh of a word."""
        return (Term(kind, self._numbers[name], 0) for kind in LOOKED_UP)


def one(weight: int) -> Iterator[Term]:
    """The number one times a weight, in as many steps as the weight needs."""
    while weight:
        part = max(_WORD.low, min(_WORD.high, weight))
        yield Term(Kind.ONE, -1, part)
        weight -= part


def lms(taught: Corrected, constants: Sequence[Sequence[int]]) -> list[Sums]:
    """The sums of the equation of each output; those of the new theta are the last ones.

    constants: The step and the leak of each output; see ``golden.learning.gradient``.
    """
    counts = {"sample": taught.sensors, "known": taught.outputs, "theta": 2 * taught.sensors}
    names = [f"{what} {k}" for what, count in counts.items() for k in range(count)]
    found = []
    for output, (step, leak) in enumerate(constants):
        sums = Sums(names)
        corrected(sums, taught)
        _network(sums, taught, output)
        _row(sums, taught, output)
        sums.add("step", sums.by("error", step))
        for k in range(2 * taught.sensors):
            kept = sums.by(f"theta {k}", (1 << DROPPED) - leak)
            sums.add(f"new theta {k}", kept, sums.times("step", f"row {k}"))
        found.append(sums)
    return found


def corrected(sums: Sums, taught: Corrected) -> None:
    """Add the corrected samples."""
    pairs = zip(taught.gains.tolist(), taught.offsets.tolist(), strict=True)
    for k, (gain, offset) in enumerate(pairs):
        sums.add(f"gain {k}", sums.by(f"theta {k}", gain))
        sums.add(f"offset {k}", sums.by(f"theta {taught.sensors + k}", offset))
        scaled = sums.times(f"gain {k}", f"sample {k}")
        sums.add(f"z {k}", sums.whole(f"sample {k}"), scaled, sums.whole(f"offset {k}"))


def _network(sums: Sums, taught: Corrected, output: int) -> None:
    hidden, last = taught.networks[output].layers
    seen = [f"z {k}" for k in range(taught.sensors)] + [f"known {k}" for k in range(output)]
    for j, (row, begun) in enumerate(zip(hidden.weights, hidden.starts, strict=True)):
        terms = (sums.by(name, weight) for name, weight in zip(seen, row, strict=True))
        sums.add(f"q {j}", *one(begun >> DROPPED), *terms)
        sums.add(f"h {j}", *sums.looked_up(f"q {j}"))
    # An engine begins the sum of an output with what the start holds to round it.
    begun = (last.starts[0] - start_of(True)) >> DROPPED
    terms = (sums.by(f"h {j}", weight) for j, weight in enumerate(last.weights[0]))
    sums.add("y", *one(begun), *terms, output=True)
    sums.add("error", sums.whole(f"known {output}"), sums.whole("y", -1))


def _row(sums: Sums, taught: Corrected, output: int) -> None:
    of_one, of_square = taught.slope_weights[output]
    gains, offsets = row_weights(taught)
    for j in range(len(of_square)):
        sums.add(f"square {j}", sums.times(f"h {j}", f"h {j}"))
    for k in range(taught.sensors):
        terms = (sums.by(f"square {j}", -int(weight)) for j, weight in enumerate(of_square[:, k]))
        sums.add(f"slope {k}", *one(int(of_one[k])), *terms)
        sums.add(f"by gain {k}", sums.times(f"slope {k}", f"sample {k}"))
        sums.add(f"row {k}", sums.by(f"by gain {k}", int(gains[k])))
        sums.add(f"row {taught.sensors + k}", sums.by(f"slope {k}", int(offsets[k])))
