"""Read-only memories."""

from collections.abc import Sequence

from myhdl import always, always_comb, block, intbv
from myhdl._Signal import Constant

from golden.fixed import Codes


def padded(words: Codes, size: int) -> tuple[int, ...]:
    """``words`` as plain numbers, the last one repeated up to ``size`` of them.

    Padded, because a short table raises IndexError in MyHDL where VHDL reads the last word.
    """
    return tuple(int(w) for w in words) + (int(words[-1]),) * (size - len(words))


@block
def rom(addr, word, *, words: Codes, meanings: Sequence[str] = ()):
    """``word`` is ``words[addr]``; addresses beyond the last word read the last word.

    A tuple read as an entire right-hand side is the one form of a small table that MyHDL converts
    rightly; it becomes a case statement, which synthesis turns into LUTs.
    """
    contents = padded(words, addr.max)

    @always_comb
    def read():
        word.next = contents[addr]

    return read


@block
def registered_rom(clk, addr, word, *, words: Codes, meanings: Sequence[str] = ()):
    """``rom``, one clock later: the form that synthesis turns into a block RAM."""
    contents = padded(words, addr.max)

    @always(clk.posedge)
    def read():
        word.next = contents[addr]

    return read


class Constants(list):
    """Words as a list that MyHDL writes as one table, whoever reads it.

    For a memory with more than one read port, which a ``case`` statement would make twice.

    Parameters
    ----------
    words : sequence of int
    width : int
    meanings : sequence of str
        What each of them stands for; the last holds for all beyond.
    """

    def __init__(self, words: Sequence[int], width: int, meanings: Sequence[str]) -> None:
        super().__init__(Constant(intbv(word, min=0, max=1 << width)) for word in words)
        self.meanings = meanings
