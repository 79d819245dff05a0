"""replay_memory: reads the words of table and program again for every bit plane of the operands."""

from myhdl import Signal, always, always_comb, always_seq, block, concat, intbv, modbv

from golden.engine.formats import SAMPLE_SHIFT, WIDTH
from golden.engine.program import WORD_WIDTH
from golden.engine.replay import CLEAR, ONE_PLANE
from golden.engine.replay_memory import ReplayMemory
from golden.engine.serial_program import ALL, END
from hdl.common.rom import Constants
from hdl.common.signals import flag, unsigned


@block
def replay_memory(
    clk, rst, *, run, finish, segment, look_up, word, plane, first, table_word, spec: ReplayMemory
):
    """Words of 36 bits, read neuron by neuron and pass by pass, and the table beside them.

    Whether a pass ends is seen in the word itself, and chooses the next address in the same clock.
    One memory with two read ports. Reset goes to the program's first word, which stands two clocks
    later.
    """
    begin = spec.begin
    memory = Constants(spec.contents, WORD_WIDTH, spec.meanings)
    span = 1 << spec.addr_width
    # The addresses at which the next pass and the next neuron begin, and those of the words behind
    # these. They are kept, so that no address need be added up behind the memory.
    base = Signal(intbv(begin, min=0, max=span))
    second = Signal(intbv(begin + 1, min=0, max=span))
    following, beside = unsigned(spec.addr_width), unsigned(spec.addr_width)
    address = unsigned(spec.addr_width)
    # The address of the word behind that of this clock, and the one after it.
    counter = unsigned(spec.addr_width)
    further = Signal(modbv(0, min=0, max=span))
    second_begin = begin + 1
    top = 1 << CLEAR
    place = Signal(intbv(top, min=0, max=2 * top))
    # Which word ends a pass: with 3 any word, with 2 any end, with 1 the end of all words, with 0
    # the end of the wide ones or of all.
    sort = Signal(intbv(3, min=0, max=4))
    low_planes = unsigned(SAMPLE_SHIFT + 1)
    low, one, stands, ends = flag(), flag(), flag(), flag()
    end_field = unsigned(END[1])
    fetched, found = unsigned(WORD_WIDTH), unsigned(WORD_WIDTH)
    end_low, end_top = END[0], sum(END)
    above_one, above_low = ONE_PLANE + 1, SAMPLE_SHIFT + 1
    last = CLEAR + 1

    # These look at the plane that follows; behind plane 0 it is the one that clears.
    @always_comb
    def look():
        low_planes.next = place[above_low:]
        end_field.next = fetched[end_top:end_low]

    @always_comb
    def compare():
        low.next = low_planes != 0
        one.next = place[above_one] or place[0]

    @always_comb
    def decide():
        if sort == 3:
            ends.next = True
        elif sort == 2:
            ends.next = end_field != 0
        elif sort == 1:
            ends.next = end_field == ALL
        else:
            ends.next = end_field[1]

    @always_comb
    def halt():
        stands.next = finish or not run

    @always_comb
    def choose():
        if ends:
            address.next = base
        else:
            address.next = counter

    @always_comb
    def add():
        further.next = counter + 1

    @always(clk.posedge)
    def step():
        first.next = ends
        if ends:
            counter.next = second
        else:
            counter.next = further
        if ends and place[ONE_PLANE]:
            following.next = counter
            beside.next = further

    @always_seq(clk.posedge, reset=rst)
    def keep():
        if stands:
            base.next = begin
            second.next = second_begin
            place.next = top
            sort.next = 3
        elif ends:
            place.next = concat(place[0], place[last:1])
            sort.next = concat(low, one)
            if place[1]:
                base.next = following
                second.next = beside

    @always(clk.posedge)
    def fetch():
        fetched.next = memory[address]

    @always(clk.posedge)
    def read_table():
        if look_up:
            found.next = memory[segment]
        else:
            found.next = 0

    @always_comb
    def show():
        word.next = fetched
        plane.next = place
        table_word.next = found[WIDTH:]

    return look, compare, decide, halt, choose, add, step, keep, fetch, read_table, show
