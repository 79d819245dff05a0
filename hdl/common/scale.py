"""Multiplication by a constant."""

from myhdl import always_comb, block

from hdl.common.signals import signed, unsigned


@block
def scale(data, product, *, factor: int):
    """``product``, wide enough for it, is ``data`` times the positive ``factor``."""
    # VHDL converts a number to the width of the signal that it multiplies.
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
