"""Parts that delay a stream of frames, or find its elements by their position."""

from myhdl import always, always_comb, always_seq, block

from hdl.common.delay import delay
from hdl.common.signals import Stream, unsigned


@block
def late_stream(clk, rst, in_: Stream, late: Stream, *, clocks: int):
    """A stream ``clocks`` clocks later."""
    return (
        delay(clk, rst, in_.valid, late.valid, clocks=clocks),
        delay(clk, None, in_.data, late.data, clocks=clocks),
        delay(clk, rst, in_.last, late.last, clocks=clocks),
    )


@block
def position(clk, rst, in_: Stream, count, *, stop: int):
    """``count`` is the element's position in its frame; beyond ``stop`` it stays there."""

    @always_seq(clk.posedge, reset=rst)
    def step():
        if in_.valid:
            if in_.last:
                count.next = 0
            elif count != stop:
                count.next = count + 1

    return step


@block
def window(clk, rst, in_: Stream, seen: Stream, *, elements: int):
    """The first ``elements`` of every frame as a frame of its own, in the same clock.

    A frame that is shorter keeps its own ``last``.
    """
    count = unsigned(elements.bit_length())
    counter = position(clk, rst, in_, count, stop=elements)

    @always_comb
    def look():
        seen.valid.next = in_.valid and count != elements
        seen.last.next = in_.last or count == elements - 1

    return counter, look


@block
def catch_word(clk, in_: Stream, count, word, *, slot: int):
    """``word`` is the latest element at position ``slot``, from the next clock on."""

    @always(clk.posedge)
    def keep():
        if in_.valid and count == slot:
            word.next = in_.data

    return keep


@block
def catch(clk, rst, in_: Stream, words, *, first: int, slots: int):
    """``words[i]`` is the latest element at position ``first + i``, for i below ``slots``."""
    stop = first + slots
    count = unsigned(stop.bit_length())
    counter = position(clk, rst, in_, count, stop=stop)
    keepers = [catch_word(clk, in_, count, words[i], slot=first + i) for i in range(slots)]
    return counter, keepers
