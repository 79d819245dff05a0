"""lane_memory: holds the weights of one lane and, where they are needed, tables of functions."""

from myhdl import always, always_comb, block, concat

from golden.engine.formats import HIDDEN, WIDTH
from golden.engine.lane_memory import LaneMemory
from hdl.common.delay import connect
from hdl.common.rom import Constants
from hdl.common.signals import flag, unsigned


@block
def lane_memory(
    clk,
    *,
    place,
    coeff,
    word=None,
    kind=None,
    write=None,
    write_addr=None,
    data=None,
    spec: LaneMemory,
):
    """One word of 18 bits a clock: the weight at a place, or a word of the table.

    The table lies in the lower half of the memory, and the weights in the upper one.
    """
    address = unsigned(spec.addr_width)
    if spec.written:
        memory = [unsigned(WIDTH) for _ in spec.contents]

        @always(clk.posedge)
        def keep():
            if write:
                memory[write_addr].next = data

        kept = keep
    else:
        memory = Constants(spec.contents, WIDTH, spec.meanings)
        kept = ()

    @always(clk.posedge)
    def read():
        coeff.next = memory[address]

    if not spec.table:
        return kept, read, connect(place, address)

    sign, low, bits = HIDDEN.width - 1, spec.segment_width, spec.segment_bits
    # One bit says whether the word is a slope, and those above the segment's are 0.
    looks, part, segment = flag(), unsigned(sign - low), unsigned(sign - low)
    looked, placed = unsigned(spec.half_width), unsigned(spec.half_width)

    @always_comb
    def look():
        looks.next = kind == 1 or kind == 2

    @always_comb
    def cut():
        part.next = word[sign:low]

    @always_comb
    def complement():
        if word[sign]:
            segment.next = ~part
        else:
            segment.next = part

    named = ()
    if spec.blocks > 1:
        chosen, upper = flag(), spec.block_width + 1

        # The number of a block that has another one behind it is even.
        @always_comb
        def pick():
            chosen.next = place[1] or (place[0] and word[sign])

        named = pick
        if upper > 2:

            @always_comb
            def find():
                looked.next = concat(kind[1], place[upper:2], chosen, segment[bits:])

        else:

            @always_comb
            def find():
                looked.next = concat(kind[1], chosen, segment[bits:])

    elif bits:

        @always_comb
        def find():
            looked.next = concat(kind[1], segment[bits:])

    else:

        @always_comb
        def find():
            looked.next = kind[1]

        word.read, cut, complement = True, (), ()  # MyHDL refuses a port that nothing reads.

    @always_comb
    def widen():
        placed.next = place

    @always_comb
    def choose():
        if looks:
            address.next = looked
        else:
            address.next = concat(True, placed)

    return kept, read, look, cut, complement, named, find, widen, choose
