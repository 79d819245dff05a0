"""Read-only memories."""

from collections.abc import Sequence

from myhdl import always, always_comb, block, intbv
from myhdl._Signal import Constant

from golden.numbers.fixed import Codes


def padded(words: Codes, size: int) -> tuple[int, ...]:
    """``words`` as plain numbers; the last one is repeated until there are ``size`` of them.

    Beyond the end of a short table MyHDL raises IndexError where VHDL reads the last word.
    """
    return tuple(int(w) for w in words) + (int(words[-1]),) * (size - len(words))


@block
def rom(addr, word, *, words: Codes, meanings: Sequence[str] = ()):
    """``word`` is ``words[addr]``; addresses beyond the last word read the last word.

    MyHDL converts a small table correctly only where the read of a tuple is the entire right-hand
    side of an assignment. It writes a case statement, which synthesis turns into LUTs.
    """
    contents = padded(words, addr.max)

    @always_comb
    def read():
        word.next = contents[addr]

    return read


@block
def registered_rom(clk, addr, word, *, words: Codes, meanings: Sequence[str] = ()):
    """As ``rom``, but one clock later; synthesis turns this form into a block RAM."""
    contents = padded(words, addr.max)

    @always(clk.posedge)
    def read():
        word.next = contents[addr]

    return read


class Constants(list):
    """Words as a list that MyHDL writes as one table, however many processes read it.

    It serves memories with more than one read port: with ``case`` statements there would be one
    table per port.

    meanings: What each word stands for; the last one holds for all further words, too.
    """

    def __init__(self, words: Sequence[int], width: int, meanings: Sequence[str]) -> None:
        super().__init__(Constant(intbv(word, min=0, max=1 << width)) for word in words)
        self.meanings = meanings
