"""Read-only memory, read without a clock."""

from myhdl import always_comb, block

from golden.fixed import Codes


@block
def rom(addr, word, *, words: Codes):
    """``word`` is ``words[addr]``; addresses beyond the last word read the last word.

    A tuple read as an entire right-hand side is the one form of a small table that MyHDL converts
    rightly; it becomes a case statement, which synthesis turns into LUTs.
    """
    # Padded, because a short table raises IndexError in MyHDL where VHDL reads the last word.
    contents = tuple(int(w) for w in words) + (int(words[-1]),) * (addr.max - len(words))

    @always_comb
    def read():
        word.next = contents[addr]

    return read
