"""Scan sequencer: reads the sensors in turn through an analogue multiplexer."""

import numpy as np
from myhdl import always, always_comb, always_seq, block, instances

from golden.sensing.scan_sequencer import ScanSequencer
from hdl.common.rom import rom
from hdl.common.signals import Stream, flag, unsigned


@block
def scan_sequencer(clk, rst, out: Stream, *, adc, address, spec: ScanSequencer):
    """The converter's codes, late in each slot, as a stream of frames (sections 5.4.4 and 5.5).

    Latency 1 clock, from the code to the sample. A frame every ``spec.scan_clocks`` clocks. Reset
    starts a scan.
    """
    top, width = spec.scan_clocks - 1, spec.counter_width
    low, full = width - spec.slot_width, top.bit_length()
    sample_clock, slots, final = spec.sample_clock, spec.slots, spec.slots - 1
    count = unsigned(full)
    slot = unsigned(spec.slot_width)
    clock = unsigned(low)
    selected = unsigned(spec.address_width)
    take = flag()

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

    if spec.pause:
        pausing, turn = flag(), unsigned(spec.address_width)

        @always_comb
        def compare():
            pausing.next = count[full:width] != 0

        @always_comb
        def decide():
            take.next = clock == sample_clock and slot < slots and not pausing

        @always_comb
        def choose():
            if pausing:
                selected.next = 0
            else:
                selected.next = turn
    else:
        turn = selected

        @always_comb
        def decide():
            take.next = clock == sample_clock and slot < slots

    @always_seq(clk.posedge, reset=rst)
    def strobe():
        out.valid.next = take
        out.last.next = take and slot == final

    @always(clk.posedge)
    def keep():
        address.next = selected
        if take:
            out.data.next = adc

    look_up = rom(
        slot,
        turn,
        words=np.array(spec.addresses),
        meanings=[str(address) for address in spec.addresses],
    )

    return instances()
