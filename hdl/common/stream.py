"""Parts that delay, hold or store a stream, or find its elements by their position."""

from myhdl import Signal, always, always_comb, always_seq, block, instances, intbv

from hdl.common import ops
from hdl.common.delay import delay
from hdl.common.signals import Stream, flag, unsigned


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


@block
def past_whole(clk, rst, good, yields, *, past: int):
    """``yields`` is ``good``, but stays low for the first ``past`` good frames after a reset.

    ``past`` is at least 1.
    """
    known = unsigned(past.bit_length())
    whole = flag()

    @always_seq(clk.posedge, reset=rst)
    def count():
        if good and not whole:
            known.next = known + 1

    return ops.equal(known, past, whole), ops.both(good, whole, yields), count


@block
def next_point(clk, rst, profile: Stream, *, shown, number, x, y, points: int):
    """``number``, ``x`` and ``y`` show one point of the newest profile.

    After a clock with ``shown`` they wait for the next point and change to it when it comes. Until
    then every new profile brings new values of the same point.
    """
    final = points - 1
    width = max(1, final.bit_length())
    place, wanted = unsigned(width), unsigned(width)

    @always_seq(clk.posedge, reset=rst)
    def count():
        if profile.valid:
            if profile.last:
                place.next = 0
            else:
                place.next = place + 1

    @always_seq(clk.posedge, reset=rst)
    def keep():
        if profile.valid and place == wanted:
            number.next = place
            x.next = profile.x
            y.next = profile.y

    @always_seq(clk.posedge, reset=rst)
    def ask():
        if shown:
            if number == final:
                wanted.next = 0
            else:
                wanted.next = number + 1

    return count, keep, ask


@block
def turn(clk, rst, step, addr, *, stop: int):
    """``addr`` counts the clocks of ``step`` from 0 to ``stop`` and then begins at 0 again."""

    @always_seq(clk.posedge, reset=rst)
    def count():
        if step:
            if addr == stop:
                addr.next = 0
            else:
                addr.next = addr + 1

    return count


@block
def fifo(clk, rst, in_: Stream, out: Stream, *, fetch, depth: int):
    """Words leave in the order in which they came; each stays until it is taken.

    in_: A word comes with ``in_.valid``; the memory must have room for it.
    out: A word leaves in a clock in which both flags are high, and stays until then.
    fetch: In this clock a word leaves the memory for ``out.data``.
    depth: How many words the memory holds, at least 1. The register ``out.data`` holds one more.

    The latency is 2 clocks, and one word can pass per clock. ``out.valid`` and ``out.data`` are
    registers. The memory is read at a clock edge, and never at the edge that writes the same word.
    Reset empties it.
    """
    memory = [Signal(intbv(0, min=in_.data.min, max=in_.data.max)) for _ in range(depth)]
    write_addr, read_addr = (unsigned(max(1, (depth - 1).bit_length())) for _ in range(2))
    stored = unsigned(depth.bit_length())
    full, take = flag(), flag()
    last_addr = depth - 1

    @always_comb
    def decide():
        take.next = stored != 0 and (out.ready or not full)

    @always(clk.posedge)
    def write():
        if in_.valid:
            memory[write_addr].next = in_.data

    @always(clk.posedge)
    def read():
        if take:
            out.data.next = memory[read_addr]

    @always_seq(clk.posedge, reset=rst)
    def count():
        if in_.valid and not take:
            stored.next = stored + 1
        elif take and not in_.valid:
            stored.next = stored - 1
        full.next = take or (full and not out.ready)

    @always_comb
    def show():
        out.valid.next = full
        fetch.next = take

    count_writes = turn(clk, rst, in_.valid, write_addr, stop=last_addr)
    count_reads = turn(clk, rst, take, read_addr, stop=last_addr)

    return instances()
