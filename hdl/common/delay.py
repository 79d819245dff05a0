"""Shift registers."""

from myhdl import Signal, always, always_comb, always_seq, block


@block
def reset_register(clk, rst, data, data_late):
    """One clock of delay for state: cleared by reset."""

    @always_seq(clk.posedge, reset=rst)
    def keep():
        data_late.next = data

    return keep


@block
def register(clk, data, data_late):
    """One clock of delay for data: reset leaves it alone."""

    @always(clk.posedge)
    def keep():
        data_late.next = data

    return keep


@block
def delay(clk, rst, data, data_late, *, clocks: int):
    """``data_late`` is ``data`` of ``clocks`` clocks ago; ``rst`` None for data without reset.

    Raises
    ------
    ValueError
        When ``clocks`` is below 1.
    """
    if clocks < 1:
        raise ValueError(f"delay: clocks={clocks}, expected 1 or more")
    taps = [data, *(Signal(data.val) for _ in range(clocks - 1)), data_late]
    if rst is None:
        return [register(clk, taps[i], taps[i + 1]) for i in range(clocks)]
    return [reset_register(clk, rst, taps[i], taps[i + 1]) for i in range(clocks)]


@block
def connect(data, data_same):
    """``data_same`` is ``data``, in the same clock."""

    @always_comb
    def copy():
        data_same.next = data

    return copy
