"""LMS as steps of an engine, bit for bit that of ``golden.learning.gradient``.

A *sum* is what it is in an engine: products, one in each step, then half a unit, rounding and
saturation, and a word that is stored. An engine that does not learn lacks:

=========  =======================================================================================
what       how
=========  =======================================================================================
PRODUCT    the coefficient is a second word without its three lowest bits, with the sign kept
places     a word is stored where the step says, not at the next address
exchange   theta stands twice; an equation reads the one copy and writes the other, and they are
           exchanged unless a new word saturated: the step is not taken then, and flagged
=========  =======================================================================================

Samples and known outputs lie where the sequencer of placements points. The steps of all equations,
one after the other, are one pass over one placement.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum

from golden.engine.formats import DROPPED, WIDTH
from golden.learning.corrected import Corrected
from golden.learning.gradient import row_weights
from golden.numbers.fixed import Fix

_WORD = Fix(WIDTH, 0)


class Kind(Enum):
    """What a step does; PRODUCT is not in an engine that does not learn."""

    WEIGHT = "a word times a weight"
    ONE = "the number one times a weight"
    LOOK_UP = "intercept or slope of the table"
    PRODUCT = "a word times a second word"


@dataclass(frozen=True)
class Term:
    """One step of a sum.

    source: The name of the word that is read; empty for none.
    weight: The weight of the program.
    second: The word that is the coefficient of a product.
    """

    kind: Kind
    source: str
    weight: int = 0
    second: str = ""


@dataclass(frozen=True)
class Sum:
    """A sum of products.

    name: The name of its word.
    rounded: Whether it begins with half a unit of a word, and not with what its terms hold.
    """

    name: str
    terms: tuple[Term, ...]
    rounded: bool = True


def one(weight: int) -> Iterator[Term]:
    """The number one times a weight, in as many steps as the weight needs."""
    while weight:
        part = max(_WORD.low, min(_WORD.high, weight))
        yield Term(Kind.ONE, "", part)
        weight -= part


def by(source: str, weight: int) -> Term:
    """A word times a weight."""
    return Term(Kind.WEIGHT, source, weight)


def times(source: str, second: str) -> Term:
    """A word times a second word."""
    return Term(Kind.PRODUCT, source, second=second)


def whole(source: str, sign: int = 1) -> Term:
    """A word itself, as a term of a sum in its own format."""
    return by(source, sign << DROPPED)


def lms(taught: Corrected, constants: Sequence[Sequence[int]]) -> list[list[Sum]]:
    """The sums of the equation of each output.

    constants: The step and the leak of each output; see ``golden.learning.gradient``.
    """
    return [
        [*_equation(taught, k), Sum("step", (by("error", step),)), *_new_theta(taught, leak)]
        for k, (step, leak) in enumerate(constants)
    ]


def _equation(taught: Corrected, output: int) -> Iterator[Sum]:
    yield from corrected(taught)
    yield from _network(taught, output)
    yield from _row(taught, output)


def corrected(taught: Corrected) -> Iterator[Sum]:
    """The sums of the corrected samples."""
    pairs = zip(taught.gains.tolist(), taught.offsets.tolist(), strict=True)
    for k, (gain, offset) in enumerate(pairs):
        yield Sum(f"gain {k}", (by(f"theta {k}", gain),))
        yield Sum(f"offset {k}", (by(f"theta {taught.sensors + k}", offset),))
        terms = whole(f"sample {k}"), times(f"gain {k}", f"sample {k}"), whole(f"offset {k}")
        yield Sum(f"z {k}", terms)


def _network(taught: Corrected, output: int) -> Iterator[Sum]:
    hidden, last = taught.networks[output].layers
    seen = [f"z {k}" for k in range(taught.sensors)] + [f"known {k}" for k in range(output)]
    for j, (row, begun) in enumerate(zip(hidden.weights, hidden.starts, strict=True)):
        terms = [by(name, weight) for name, weight in zip(seen, row, strict=True)]
        yield Sum(f"q {j}", (*one(begun >> DROPPED), *terms))
        yield Sum(f"h {j}", (Term(Kind.LOOK_UP, f"q {j}"), Term(Kind.LOOK_UP, f"q {j}")))
    # The start holds what an output is rounded by, which is no half of a word.
    terms = [by(f"h {j}", weight) for j, weight in enumerate(last.weights[0])]
    yield Sum("y", (*one(last.starts[0] >> DROPPED), *terms), rounded=False)
    yield Sum("error", (whole(f"known {output}"), whole("y", -1)))


def _row(taught: Corrected, output: int) -> Iterator[Sum]:
    of_one, of_square = taught.slope_weights[output]
    gains, offsets = row_weights(taught)
    for j in range(len(of_square)):
        yield Sum(f"square {j}", (times(f"h {j}", f"h {j}"),))
    for k in range(taught.sensors):
        terms = [by(f"square {j}", -int(weight)) for j, weight in enumerate(of_square[:, k])]
        yield Sum(f"slope {k}", (*one(int(of_one[k])), *terms))
        yield Sum(f"by gain {k}", (times(f"slope {k}", f"sample {k}"),))
        yield Sum(f"row {k}", (by(f"by gain {k}", int(gains[k])),))
        yield Sum(f"row {taught.sensors + k}", (by(f"slope {k}", int(offsets[k])),))


def _new_theta(taught: Corrected, leak: int = 0) -> Iterator[Sum]:
    for k in range(2 * taught.sensors):
        kept = by(f"theta {k}", (1 << DROPPED) - leak)
        yield Sum(f"new theta {k}", (kept, times("step", f"row {k}")))
