"""lane_memory: holds the weights of one lane and, where they are needed, tables of functions."""

from myhdl import always, always_comb, block, concat, instances

from golden.engine.formats import HIDDEN, WIDTH
from golden.engine.memories import LaneMemory
from hdl.common import ops
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

        @always(clk.posedge)
        def read():
            if not write:
                coeff.next = memory[address]

    else:
        memory = Constants(spec.contents, WIDTH, spec.meanings)

        @always(clk.posedge)
        def read():
            coeff.next = memory[address]

    if not spec.table:
        find_place = connect(place, address)
        return instances()

    # One bit says whether the word is a slope, and those above the row's are 0.
    looks, row = flag(), unsigned(spec.row_width)
    looked, placed = unsigned(spec.half_width), unsigned(spec.half_width)

    @always_comb
    def look():
        looks.next = kind == 1 or kind == 2

    @always_comb
    def find():
        looked.next = concat(kind[1], row)

    widen = ops.widen(place, placed)

    @always_comb
    def choose():
        if looks:
            address.next = looked
        else:
            address.next = concat(True, placed)

    find_row = row_of(word, place, row, low=spec.segment_width, bits=spec.segment_bits)
    return instances()


@block
def row_of(word, place, row, *, low: int, bits: int):
    """The row of the table with the segment in which a hidden sum lies.

    word, signed 18 bits: The sum.
    place: Names a block of the table, which is the number above that of the segment, if ``row`` has
        more than ``bits`` bits.
    low: Bits of a sum within a segment.
    """
    sign, blocks = HIDDEN.width - 1, len(row) - bits
    part, segment = unsigned(sign - low), unsigned(sign - low)

    cut = ops.bits(word, sign, low, part)

    @always_comb
    def complement():
        if word[sign]:
            segment.next = ~part
        else:
            segment.next = part

    if not blocks:
        find = ops.bits(segment, bits, 0, row)

        return cut, complement, find

    if not bits:

        @always_comb
        def rest():
            row.next = 0

        word.read = True  # MyHDL refuses a port that nothing reads.
        return rest

    chosen, upper = flag(), blocks + 1

    # The number of a block that has another one behind it is even.
    @always_comb
    def pick():
        chosen.next = place[1] or (place[0] and word[sign])

    @always_comb
    def find():
        if upper > 2:
            row.next = concat(place[upper:2], chosen, segment[bits:])
        else:
            row.next = concat(chosen, segment[bits:])

    return cut, complement, pick, find
