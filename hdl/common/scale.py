"""Multiplication by a constant."""

from myhdl import always_comb, block

from hdl.common.signals import unsigned


@block
def scale(data, product, *, factor: int):
    """``product`` is the unsigned ``data`` times ``factor``, without a clock.

    ``product`` must have room for it; only its low bits are kept otherwise.
    """
    # VHDL converts a number to the width of the signal that it multiplies.
    wide = unsigned(max(len(data), factor.bit_length()))

    @always_comb
    def widen():
        wide.next = data

    @always_comb
    def multiply():
        product.next = wide * factor

    return widen, multiply
