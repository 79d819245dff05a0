"""Shift registers."""

from myhdl import Signal, always_comb, always_seq, block


@block
def delay(clk, rst, data, data_late, *, clocks: int):
    """``data_late`` is ``data`` of ``clocks`` clocks ago, without a reset if ``rst`` is None."""
    if clocks < 1:
        raise ValueError(f"delay: clocks={clocks}, expected 1 or more")
    # The output itself is the last register.
    taps = [Signal(data.val) for _ in range(clocks - 1)]
    count = len(taps)

    @always_seq(clk.posedge, reset=rst)
    def keep():
        if count == 0:
            data_late.next = data
        else:
            taps[0].next = data
            for i in range(1, count):
                taps[i].next = taps[i - 1]
            data_late.next = taps[count - 1]

    return keep


@block
def connect(data, data_same):
    """``data_same`` is ``data``, in the same clock."""

    @always_comb
    def copy():
        data_same.next = data

    return copy
