"""AXI4-Stream around a network, so that whatever stands before or behind it can make it wait."""

from myhdl import always, always_comb, always_seq, block, concat, instances

from golden.networks.axis_network import TUSER_HALF, AxisNetwork
from golden.numbers.precision import SIGNAL
from hdl.common import ops
from hdl.common.delay import connect, delay
from hdl.common.lookup import hardware
from hdl.common.signals import Stream, fixed, flag, unsigned
from hdl.common.stream import fifo, past_whole, position, turn
from hdl.layers.argmax import argmax


@block
def gate(
    clk,
    rst,
    s_axis: Stream,
    out: Stream,
    *,
    done,
    full,
    inputs: int,
    slots: int,
    spacing: int,
    whole: bool,
):
    """Passes samples to the network, sends the slots behind them, and decides when samples wait.

    ``done`` comes with the last sample of a good frame. That sample waits while ``full`` is high,
    and until ``spacing`` clocks after the last sample of the good frame before. With ``whole``
    every sample waits for these clocks.
    """
    final_place = inputs - 1
    bits = SIGNAL.width
    place = unsigned(max(1, final_place.bit_length()))
    final, held, dropping, shut = flag(), flag(), flag(), flag()
    ready, accept, good = flag(), flag(), flag()
    parts = []

    @always_comb
    def judge():
        accept.next = s_axis.tvalid and ready
        good.next = s_axis.tvalid and ready and final and s_axis.tlast and not dropping

    @always_comb
    def show():
        s_axis.tready.next = ready
        done.next = good
        out.data.next = s_axis.tdata[bits:].signed()

    @always_seq(clk.posedge, reset=rst)
    def step():
        if accept:
            if dropping:
                dropping.next = not s_axis.tlast
            elif final or s_axis.tlast:
                place.next = 0
                dropping.next = not s_axis.tlast
            else:
                place.next = place + 1

    if spacing:
        remaining = unsigned((spacing - 1).bit_length())

        @always_comb
        def hold():
            held.next = full or remaining != 0

        @always_seq(clk.posedge, reset=rst)
        def tick():
            if good:
                remaining.next = spacing - 1
            elif remaining != 0:
                remaining.next = remaining - 1

        parts += [hold, tick]
    else:
        parts.append(connect(full, held))

    if whole:

        @always_comb
        def close():
            shut.next = remaining != 0 or (final and held)

    else:
        close = ops.both(final, held, shut)

    parts.append(close)

    if slots:
        empty = unsigned(slots.bit_length())

        @always_comb
        def look():
            ready.next = dropping or (empty == 0 and not shut)

        @always_seq(clk.posedge, reset=rst)
        def count():
            if good:
                empty.next = slots
            elif empty != 0:
                empty.next = empty - 1

        # The network refuses a frame that ends before its slots. So both kinds of wrong frame are
        # ended there; the elements that are dropped do not reach the network.
        @always_comb
        def send():
            out.valid.next = empty != 0 or (accept and not dropping)
            if empty != 0:
                out.last.next = empty == 1
            else:
                out.last.next = s_axis.tlast != final

        parts += [look, count, send]
    else:

        @always_comb
        def look():
            ready.next = dropping or not shut

        # The network itself drops the same elements that are dropped here.
        parts += [look, connect(accept, out.valid), connect(s_axis.tlast, out.last)]

    return ops.equal(place, final_place, final), judge, show, step, parts


@block
def credit(clk, rst, done, left, full, *, frames: int):
    """``full`` is high while ``frames`` frames are under way; each is from ``done`` to ``left``."""
    used = unsigned(frames.bit_length())

    @always_seq(clk.posedge, reset=rst)
    def count():
        if done and not left:
            used.next = used + 1
        elif left and not done:
            used.next = used - 1

    return count, ops.equal(used, frames, full)


@block
def tell_winner(clk, rst, results: Stream, later: Stream, left, tuser, *, design: AxisNetwork):
    """``tuser`` is the winner of the frame whose last output was fetched most recently.

    ``later`` are the results a clock later, in which the winner of a frame comes with its last
    output. So both are in their memories in the same clock, and ``left``, in which the last output
    is fetched, fetches the winner too. There is a word for each frame under way.
    """
    index_fmt, margin_fmt = design.argmax.index_fmt, design.argmax.margin_fmt
    index_width, width = index_fmt.width, index_fmt.width + margin_fmt.width
    margin_end = TUSER_HALF + margin_fmt.width
    last_addr = design.frames_under_way - 1
    decided, index, margin = flag(), unsigned(index_width), unsigned(margin_fmt.width)
    winners = [unsigned(width) for _ in range(design.frames_under_way)]
    told = unsigned(width)
    write_addr, read_addr = (unsigned(max(1, last_addr.bit_length())) for _ in range(2))

    decide = argmax(
        clk, rst, results, Stream(valid=decided, index=index, margin=margin), spec=design.argmax
    )
    wait = delay(clk, rst, results.valid, later.valid, clocks=1)

    @always(clk.posedge)
    def wait_for_winner():
        later.data.next = results.data

    @always(clk.posedge)
    def write():
        if decided:
            winners[write_addr].next = concat(margin, index)

    # A receiver reads it with every output, also with those before the first winner.
    @always_seq(clk.posedge, reset=rst)
    def read():
        if left:
            told.next = winners[read_addr]

    @always_comb
    def show():
        tuser.next = 0
        tuser.next[index_width:] = told[index_width:]
        tuser.next[margin_end:TUSER_HALF] = told[width:index_width]

    count_writes = turn(clk, rst, decided, write_addr, stop=last_addr)
    count_reads = turn(clk, rst, left, read_addr, stop=last_addr)

    return instances()


@block
def axis_network(clk, rst, s_axis: Stream, m_axis: Stream, *, frame_error, spec: AxisNetwork):
    """A packet of samples in, a packet of outputs out, either side may wait.

    The network cannot wait, so its results go into a memory, and a frame is completed only when
    the memory has room for all of them. Let F be ``spec.frames_under_way``, L the outputs and the
    memory F L words deep. A frame takes a credit with its last sample, which waits while F credits
    are taken, and gives it back in the clock in which its last output is fetched from the memory.
    A word in the memory belongs to a frame that holds a credit, because frames are fetched in
    order; there are F such frames at most, and each has L words at most. So the memory never holds
    more than F L words, and no result is ever lost, whatever waits. A wrong frame takes no credit:
    it yields no result.

    Samples before the last are taken at once: they rest in the network's sums. Ready does not
    depend on any input of the same clock, nor does any output.

    Latency from the last sample to the first output, where nobody waits:
    ``spec.latency`` clocks; a frame every ``spec.interval`` clocks. Reset clears
    every flag and counter and empties the memory.
    """
    frames = spec.frames_under_way
    outputs = spec.outputs
    final_place = outputs - 1
    valid, data, last = flag(), fixed(SIGNAL), flag()
    samples = Stream(valid=valid, data=data, last=last)
    done, left, full = flag(), flag(), flag()
    result_valid, result = flag(), fixed(SIGNAL)
    # Only argmax needs this, because the outputs of a frame are counted where they leave.
    result_last = flag()
    results = Stream(valid=result_valid, data=result, last=result_last)
    fetch, word = flag(), fixed(SIGNAL)
    fetched = Stream(valid=m_axis.tvalid, data=word, ready=m_axis.tready)
    stored, told = results, []
    if spec.argmax is not None:
        stored = Stream(valid=flag(), data=fixed(SIGNAL))
        told = tell_winner(clk, rst, results, stored, left, m_axis.tuser, design=spec)
    place = unsigned(outputs.bit_length())
    closing = flag()
    # The first frames only serve later ones as past frames, so nothing leaves for them.
    yields = flag() if spec.past else done
    past = [past_whole(clk, rst, done, yields, past=spec.past)] if spec.past else []

    @always_comb
    def look():
        left.next = fetch and place == final_place

    @always_seq(clk.posedge, reset=rst)
    def close():
        if fetch:
            closing.next = left

    @always_comb
    def show():
        m_axis.tdata.next = word
        m_axis.tlast.next = closing

    return (
        gate(
            clk,
            rst,
            s_axis,
            samples,
            done=done,
            full=full,
            inputs=spec.inputs,
            slots=spec.slots,
            spacing=spec.spacing,
            whole=spec.network.busy > 0,
        ),
        hardware(spec.network)(
            clk, rst, samples, results, frame_error=frame_error, spec=spec.network
        ),
        fifo(clk, rst, stored, fetched, fetch=fetch, depth=frames * outputs),
        look,
        position(clk, rst, Stream(valid=fetch, last=left), place, stop=outputs),
        close,
        show,
        credit(clk, rst, yields, left, full, frames=frames),
        past,
        told,
    )
