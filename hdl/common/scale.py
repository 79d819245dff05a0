"""Multiplication by a constant."""

from myhdl import block

from hdl.common import ops
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

    return ops.widen(data, wide), ops.multiply(wide, factor, product)
