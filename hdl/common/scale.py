"""Multiplication by a constant."""

from myhdl import always_comb, block

from hdl.common.signals import signed, unsigned


@block
def scale(data, product, *, factor: int):
    """``product`` is ``data`` times the positive ``factor``; it must be wide enough for that."""
    # VHDL converts a number to the width of the signal that it multiplies, so this signal must be
    # wide enough for the factor, too.
    if data.min < 0:
        wide = signed(max(len(data), factor.bit_length() + 1))
    else:
        wide = unsigned(max(len(data), factor.bit_length()))

    @always_comb
    def widen():
        wide.next = data

    @always_comb
    def multiply():
        product.next = wide * factor

    return widen, multiply
