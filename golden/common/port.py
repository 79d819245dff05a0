"""The ports of a block, as its twin publishes them."""

from dataclasses import dataclass, field, replace

from golden.numbers.fixed import Fix


@dataclass(frozen=True)
class Unsigned:
    """Format of an unsigned port.

    width: Number of bits.
    frac: Fraction bits; None for a count or an address, and if the block does not know them.
    last: The largest code that occurs; by default the largest of the format.
    """

    width: int
    frac: int | None = None
    last: int = field(default=-1, compare=False)

    def __post_init__(self) -> None:
        if self.last < 0:
            object.__setattr__(self, "last", (1 << self.width) - 1)

    def __str__(self) -> str:
        bits = f"{self.width} bit{'' if self.width == 1 else 's'}"
        return bits if self.frac is None else f"{bits}, {self.frac} fraction bits"


@dataclass(frozen=True)
class Port:
    """One port of an entity.

    name: Name in the exported files.
    direction: "in" or "out".
    meaning: Description in one line. For a group, ``*`` stands for the number of the port.
    kind: Format of the codes; None is a single bit.
    number: The port's number in its group.
    by_weights: Whether the weights of a network decide which of its values occur.
    """

    name: str
    direction: str
    meaning: str
    kind: Fix | Unsigned | None = None
    number: int | None = None
    by_weights: bool = False

    @property
    def width(self) -> int:
        """Number of bits; 0 for a single bit, which is no vector."""
        return 0 if self.kind is None else self.kind.width

    @property
    def signed(self) -> bool:
        return isinstance(self.kind, Fix)

    @property
    def row(self) -> str:
        """The port's name, or ``name_*`` for every port of a group."""
        return self.name if self.number is None else f"{self.name.removesuffix(str(self.number))}*"

    @property
    def comment(self) -> str:
        """Format and meaning in one line of plain text, for an exported file."""
        meaning = self.meaning.replace("`", "")
        if self.number is not None:
            meaning = meaning.replace("*", str(self.number))
        kind = "" if self.kind is None else f"{'signed ' if self.signed else ''}{self.kind}: "
        return f"{kind}{meaning}"


def input_port(name: str, meaning: str, kind: Fix | Unsigned | None = None) -> Port:
    return Port(name, "in", meaning, kind)


def output_port(name: str, meaning: str, kind: Fix | Unsigned | None = None) -> Port:
    return Port(name, "out", meaning, kind)


def group(port: Port, count: int) -> tuple[Port, ...]:
    """``count`` ports like ``port``: ``name_0``, ``name_1``, ..."""
    return tuple(replace(port, name=f"{port.name}_{n}", number=n) for n in range(count))


CLOCK = input_port("clk", "clock, rising edge")
RESET = input_port("rst", "synchronous reset, active high")
CLOCKED = (CLOCK, RESET)
