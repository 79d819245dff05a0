"""replay_memory: the words of table and program, read again for every bit plane of the operands."""

from myhdl import Signal, always, always_comb, always_seq, block, concat, intbv, modbv

from golden.engine.formats import SAMPLE_SHIFT, WIDTH
from golden.engine.program import WORD_WIDTH
from golden.engine.replay import CLEAR, ONE_PLANE
from golden.engine.replay_memory import ReplayMemory
from golden.engine.serial_program import END_ALL, END_DEEP, END_WIDE
from hdl.common.rom import constants
from hdl.common.signals import flag, unsigned


@block
def replay_memory(
    clk,
    rst,
    run,
    finish,
    segment,
    look_up,
    word,
    plane,
    first,
    table_word,
    *,
    spec: ReplayMemory,
):
    """Words of 36 bits, read neuron by neuron and pass by pass, and the table beside them.

    Parameters
    ----------
    run, finish : bool
        Words are read while ``run``; otherwise, and from the clock after ``finish`` on, the
        program's first one in the first plane.
    segment : unsigned ``spec.segment_addr_width`` bits
    look_up : bool
        Without it ``table_word`` is 0.
    word : unsigned 36 bits
    plane : unsigned 19 bits
        One bit: the plane of ``word``; the highest one clears.
    first : bool
        ``word`` is the first of its pass.
    table_word : unsigned 18 bits
        ``spec.latency`` clocks later.
    spec : ReplayMemory

    Notes
    -----
    Whether a pass ends is seen in the word itself, and chooses the next address in the same clock.
    One memory with two read ports. Reset goes to the program's first word, which stands two clocks
    later.
    """
    begin = spec.begin
    memory = constants(spec.contents, WORD_WIDTH)
    span = 1 << spec.addr_width
    # Where the next pass begins, and the next neuron.
    base = Signal(intbv(begin, min=0, max=span))
    following = unsigned(spec.addr_width)
    address = unsigned(spec.addr_width)
    # The word behind that of this clock.
    counter = Signal(modbv(0, min=0, max=span))
    top = 1 << CLEAR
    place = Signal(intbv(top, min=0, max=2 * top))
    low_planes = unsigned(SAMPLE_SHIFT)
    low, stands, ends = flag(), flag(), flag()
    fetched, found = unsigned(WORD_WIDTH), unsigned(WORD_WIDTH)
    end_all, end_wide, end_deep = END_ALL[0], END_WIDE[0], END_DEEP[0]
    last = CLEAR + 1

    @always_comb
    def look():
        low_planes.next = place[SAMPLE_SHIFT:]

    @always_comb
    def compare():
        low.next = low_planes != 0

    @always_comb
    def decide():
        ends.next = (
            place[CLEAR]
            or fetched[end_all]
            or (fetched[end_wide] and not place[ONE_PLANE])
            or (fetched[end_deep] and low)
        )

    @always_comb
    def halt():
        stands.next = finish or not run

    @always_comb
    def choose():
        if ends:
            address.next = base
        else:
            address.next = counter

    @always(clk.posedge)
    def step():
        counter.next = address + 1
        first.next = ends
        if ends and place[ONE_PLANE]:
            following.next = counter

    @always_seq(clk.posedge, reset=rst)
    def keep():
        if stands:
            base.next = begin
            place.next = top
        elif ends:
            place.next = concat(place[0], place[last:1])
            if place[1]:
                base.next = following

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

    return look, compare, decide, halt, choose, step, keep, fetch, read_table, show
