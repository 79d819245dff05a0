"""One operation each, without a clock: ``ops.add(left, right, total)`` writes ``total``.

Every result has a signal of its own, wide enough for each value, because MyHDL, VHDL and Verilog
cut the bits of a longer expression at different widths. One of two operands may be a Python number,
but not what another is subtracted from.
"""

from myhdl import always_comb, block, concat


@block
def widen(data, wide):
    """The same value in another signal, which may have more bits and a sign."""

    @always_comb
    def copy():
        wide.next = data

    return copy


@block
def invert(data, inverted):
    """Every bit of ``data`` inverted; this is -1 - ``data``."""

    @always_comb
    def turn():
        inverted.next = ~data

    return turn


@block
def negate(data, opposite):
    """``data`` has a bit more than its values need: VHDL negates in its width."""

    @always_comb
    def turn():
        opposite.next = -data

    return turn


@block
def add(left, right, total):
    @always_comb
    def compute():
        total.next = left + right

    return compute


@block
def subtract(left, right, difference):
    if isinstance(left, int):
        raise ValueError("subtract: got a number first, which a synthesiser swaps; negate and add")

    @always_comb
    def compute():
        difference.next = left - right

    return compute


@block
def multiply(left, right, product):
    @always_comb
    def compute():
        product.next = left * right

    return compute


@block
def shift_left(data, places, moved):
    """``moved`` is no wider than ``data``, because VHDL moves in the width of ``data``."""
    if len(moved) > len(data):
        raise ValueError(f"shift_left: got {len(data)} bits into {len(moved)}, expected no more")

    @always_comb
    def move():
        moved.next = data << places

    return move


@block
def shift_right(data, places, kept):
    """The lowest bits of ``data`` are cut off, which rounds down."""

    @always_comb
    def cut():
        kept.next = data >> places

    return cut


@block
def xor(left, right, result):
    @always_comb
    def compute():
        result.next = left ^ right

    return compute


@block
def either(left, right, result):
    @always_comb
    def compute():
        result.next = left or right

    return compute


@block
def both(left, right, result):
    @always_comb
    def compute():
        result.next = left and right

    return compute


@block
def equal(left, right, result):
    @always_comb
    def compare():
        result.next = left == right

    return compare


@block
def unequal(left, right, result):
    @always_comb
    def compare():
        result.next = left != right

    return compare


@block
def less(left, right, result):
    @always_comb
    def compare():
        result.next = left < right

    return compare


@block
def bits(data, high, low, part):
    """The bits of ``data`` from ``low`` to below ``high``."""

    @always_comb
    def cut():
        part.next = data[high:low]

    return cut


@block
def signed_bits(data, high, low, part):
    """The bits of ``data`` from ``low`` to below ``high``, as a signed number."""

    @always_comb
    def cut():
        part.next = data[high:low].signed()

    return cut


@block
def join(high, low, word):
    """The bits of ``high`` above those of ``low``."""

    @always_comb
    def put():
        word.next = concat(high, low)

    return put
