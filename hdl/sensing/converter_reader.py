"""Converter reader: makes frames from a converter with several channels on an SPI."""

import numpy as np
from myhdl import always, always_comb, always_seq, block, concat, instances

from golden.numbers.fixed import Rounding
from golden.sensing.converter_parts import STRAIGHT
from golden.sensing.converter_reader import ConverterReader
from hdl.common import ops
from hdl.common.requantise import requantise
from hdl.common.rom import rom
from hdl.common.signals import Stream, fixed, flag, signed, unsigned


@block
def scan(clk, rst, slot, starts, *, reader: ConverterReader):
    """Counts through a scan: ``slot`` is the turn of a sensor, ``starts`` begins its transfer."""
    top, width = reader.scan_clocks - 1, reader.counter_width
    low, full = width - reader.slot_width, top.bit_length()
    begin_clock, inputs = reader.begin_clock, reader.inputs
    count = unsigned(full)
    clock = unsigned(low)

    @always_seq(clk.posedge, reset=rst)
    def step():
        if count == top:
            count.next = 0
        else:
            count.next = count + 1

    @always_comb
    def slices():
        slot.next = count[width:low]
        clock.next = count[low:0]

    if reader.pause:
        pausing = flag()

        @always_comb
        def compare():
            pausing.next = count[full:width] != 0

        @always_comb
        def decide():
            starts.next = clock == begin_clock and slot < inputs and not pausing

    else:

        @always_comb
        def decide():
            starts.next = clock == begin_clock and slot < inputs

    return instances()


@block
def transfer(clk, rst, *, starts, running, half, read, turn, reader: ConverterReader):
    """Counts the half periods of a transfer: ``half`` is their number, from 0.

    ``sclk`` is low in the even ones and high in the odd ones, each one clock late, because it comes
    from a register. ``read`` is high in the first clock of each even one: at its end ``sclk``
    falls, or, in the first, has not risen yet. ``turn`` is high in the last clock of each odd one.
    """
    clocks = reader.half_clocks
    final, top = 2 * reader.part.clocks, clocks - 1
    whole = flag()

    @always_seq(clk.posedge, reset=rst)
    def run():
        if starts:
            running.next = True
        elif whole and half == final:
            running.next = False

    @always_seq(clk.posedge, reset=rst)
    def step():
        if whole:
            if half == final:
                half.next = 0
            else:
                half.next = half + 1

    @always_comb
    def mark():
        turn.next = whole and half[0]

    if clocks == 1:

        @always_comb
        def look():
            whole.next = running
            read.next = running and not half[0]

        return run, step, mark, look

    tick = unsigned(top.bit_length())

    @always_seq(clk.posedge, reset=rst)
    def divide():
        if whole:
            tick.next = 0
        elif running:
            tick.next = tick + 1

    @always_comb
    def look():
        whole.next = running and tick == top
        read.next = running and tick == 0 and not half[0]

    return run, step, mark, divide, look


@block
def judge(received, wrong, *, reader: ConverterReader):
    """``wrong`` tells that no converter can have sent the bits that were received."""
    part = reader.part
    top, low, bits = part.clocks, part.clocks - part.last, part.bits
    mask = sum(1 << (top - clock) for clock in part.zeros)
    driven = unsigned(len(received))
    other = flag()

    @always_comb
    def pick():
        driven.next = received & mask

    if part.mirrored:

        @always_comb
        def compare():
            other.next = False
            for i in range(1, bits):
                if received[low + i] != received[low - i]:
                    other.next = True

        @always_comb
        def decide():
            wrong.next = not received[top] or driven != 0 or other

        return pick, compare, decide

    @always_comb
    def decide():
        wrong.next = not received[top] or driven != 0

    return pick, decide


@block
def to_sample(received, sample, *, reader: ConverterReader):
    """``sample`` is the code among the received bits, in the format of a sample."""
    part = reader.part
    bits, half, pad = part.bits, 1 << (part.bits - 1), -reader.shift
    low = part.clocks - part.last
    above = low + bits
    code = unsigned(bits)
    exact = signed(bits + 1)

    cut = ops.bits(received, above, low, code)

    if part.coding == STRAIGHT:
        centre = ops.subtract(code, half, exact)

    else:

        @always_comb
        def centre():
            exact.next = code.signed()

    if pad <= 0:
        return cut, centre, requantise(exact, sample, shift=-pad, rounding=Rounding.ROUND)

    wide = signed(reader.fmt.width + 1)

    widen = ops.widen(exact, wide)
    align = ops.shift_left(wide, pad, sample)

    return cut, centre, widen, align


@block
def converter_reader(
    clk, rst, out: Stream, *, miso, sclk, cs_n, mosi, converter_error, spec: ConverterReader
):
    """Each sensor in turn through an SPI, and the frames of scans that went right.

    Latency 3 clocks, from the last bit of a scan to the first sample. ``miso`` is read in the clock
    at whose end ``sclk`` falls. A scan every ``spec.scan_clocks`` clocks. Reset starts a scan, in
    which ``cs_n`` is high as long as the part asks before the first transfer.
    """
    part, inputs = spec.part, spec.inputs
    last_bit, order_width = part.clocks, len(part.commands[0])
    final, last_slot, end = 2 * part.clocks, inputs - 1, spec.slots - 1
    head = order_width - 1
    slot = unsigned(spec.slot_width)
    half = unsigned(final.bit_length())
    starts, running, read, turn = (flag() for _ in range(4))
    command, order = unsigned(order_width), unsigned(order_width)
    received = unsigned(last_bit + 1)
    wrong, done, failed, spoilt, whole = (flag() for _ in range(5))
    sample, entering = fixed(spec.fmt), fixed(spec.fmt)
    ring = [fixed(spec.fmt) for _ in range(inputs)]
    sending, closing = flag(), flag()
    place = unsigned(max(1, end.bit_length()))

    count = scan(clk, rst, slot, starts, reader=spec)
    clock_bits = transfer(
        clk, rst, starts=starts, running=running, half=half, read=read, turn=turn, reader=spec
    )
    look_up = rom(
        slot,
        command,
        words=np.array([int(bits, 2) for bits in part.commands[:inputs]]),
        meanings=[f"channel {n}" for n in range(inputs)],
    )
    check = judge(received, wrong, reader=spec)
    convert = to_sample(received, sample, reader=spec)

    @always(clk.posedge)
    def drive():
        if rst:
            cs_n.next = True
            sclk.next = False
        else:
            cs_n.next = not running
            sclk.next = running and half[0]
        mosi.next = order[head]

    @always(clk.posedge)
    def ask():
        if starts:
            order.next = command
        elif turn:
            order.next = concat(order[head:0], False)

    @always(clk.posedge)
    def catch():
        if read:
            received.next = concat(received[last_bit:0], miso)

    @always_seq(clk.posedge, reset=rst)
    def end_transfer():
        done.next = read and half == final

    @always_comb
    def decide():
        spoilt.next = wrong or (failed and slot != 0)

    @always_comb
    def complete():
        whole.next = done and slot == last_slot and not spoilt

    @always_seq(clk.posedge, reset=rst)
    def remember():
        if done:
            failed.next = spoilt
            if spoilt:
                converter_error.next = True
        if whole:
            converter_error.next = False

    @always_seq(clk.posedge, reset=rst)
    def send():
        if whole:
            sending.next = True
            place.next = 0
        elif closing:
            sending.next = False
        elif sending:
            place.next = place + 1

    @always_comb
    def close():
        closing.next = sending and place == end

    @always_comb
    def enter():
        if sending:
            entering.next = ring[last_slot]
        else:
            entering.next = sample

    @always(clk.posedge)
    def keep():
        if done or sending:
            ring[0].next = entering
            for i in range(1, inputs):
                ring[i].next = ring[i - 1]
        if sending:
            out.data.next = ring[last_slot]

    @always_seq(clk.posedge, reset=rst)
    def strobe():
        out.valid.next = sending
        out.last.next = closing

    return instances()
