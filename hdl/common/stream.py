"""Parts that delay a stream of frames, or find its elements by their position."""

from myhdl import always, always_comb, always_seq, block

from hdl.common.delay import delay
from hdl.common.signals import unsigned


@block
def late_stream(clk, rst, valid, data, last, late_valid, late_data, late_last, *, clocks: int):
    """A stream ``clocks`` clocks later."""
    return (
        delay(clk, rst, valid, late_valid, clocks=clocks),
        delay(clk, None, data, late_data, clocks=clocks),
        delay(clk, rst, last, late_last, clocks=clocks),
    )


@block
def position(clk, rst, valid, last, count, *, stop: int):
    """``count`` is the element's position in its frame; beyond ``stop`` it stays there."""

    @always_seq(clk.posedge, reset=rst)
    def step():
        if valid:
            if last:
                count.next = 0
            elif count != stop:
                count.next = count + 1

    return step


@block
def window(clk, rst, valid, last, seen_valid, seen_last, *, elements: int):
    """The first ``elements`` of every frame as a frame of its own, in the same clock.

    A frame that is shorter keeps its own ``last``.
    """
    count = unsigned(elements.bit_length())
    counter = position(clk, rst, valid, last, count, stop=elements)

    @always_comb
    def look():
        seen_valid.next = valid and count != elements
        seen_last.next = last or count == elements - 1

    return counter, look


@block
def catch_word(clk, valid, count, data, word, *, slot: int):
    """``word`` is the latest element at position ``slot``, from the next clock on."""

    @always(clk.posedge)
    def keep():
        if valid and count == slot:
            word.next = data

    return keep


@block
def catch(clk, rst, valid, data, last, words, *, first: int, slots: int):
    """``words[i]`` is the latest element at position ``first + i``, for i below ``slots``."""
    stop = first + slots
    count = unsigned(stop.bit_length())
    counter = position(clk, rst, valid, last, count, stop=stop)
    keepers = [catch_word(clk, valid, count, data, words[i], slot=first + i) for i in range(slots)]
    return counter, keepers
