"""Multiplication by a constant; rounding and saturation of an exact sum."""

from myhdl import always_comb, block

from golden.numbers.fixed import Rounding
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


@block
def requantise(exact, result, *, shift: int, rounding: Rounding):
    """``result`` is ``exact`` without its ``shift`` lowest bits, saturated to the result's range.

    Stages that would do nothing are left out: nothing is rounded where no bits are dropped, and
    nothing saturates where the shifted sum always fits. Every step has its own full-width signal,
    because VHDL and Verilog cut the bits of an expression at different widths.
    """
    width = len(exact)
    rounded = exact
    steps = []
    if rounding is Rounding.ROUND and shift > 0:
        # Each addend is at most 2**(max(width, shift) - 1) in magnitude, so the sum needs one bit
        # more.
        width = max(width, shift) + 1
        rounded = signed(width)
        half = 1 << (shift - 1)

        add_half = ops.add(exact, half, rounded)

        steps.append(add_half)

    kept = rounded
    if shift > 0:
        kept = signed(max(2, width - shift))

        cut = ops.shift_right(rounded, shift, kept)

        steps.append(cut)

    if len(kept) <= len(result):
        copy = ops.widen(kept, result)

        return steps, copy

    high = int(result.max) - 1
    low = int(result.min)

    @always_comb
    def saturate():
        if kept > high:
            result.next = high
        elif kept < low:
            result.next = low
        else:
            result.next = kept

    return steps, saturate
