"""The memory of an engine with a single lane: the program, the weights and the table."""

from myhdl import Signal, always, always_comb, always_seq, block, concat, modbv

from golden.engine.formats import WIDTH
from golden.networks.engine import Engine
from hdl.common import ops
from hdl.common.delay import connect, delay
from hdl.common.rom import Constants
from hdl.common.signals import flag, unsigned
from hdl.engine.lane_memory import row_of


@block
def lane_alone(clk, rst, *, start, run, finish, word, place, kind, read, coeff, design: Engine):
    """Two words of 18 bits a clock: that of a counter, and what the lane multiplies by.

    start, run, finish: The counter steps; it returns to the first word of the program.
    word: That of the counter, which steps through the program.
    place: Where it has bits, the block in which a function is looked up.
    kind, read: What is made of the word that was read. It says whether the table is looked up.
    coeff: The weight beside a word of the program, or the intercept or slope of a segment.

    One memory with two read ports: a block RAM of 1024 words. No address needs an addition. Reset
    puts the counter to the program's first word.
    """
    program = design.program
    begin, bits, top = program.begin, program.row_bits, program.counter_width
    memory = Constants(program.contents, WIDTH, program.meanings)
    counter = Signal(modbv(begin, min=0, max=1 << top))
    stands = flag()
    counted, step_addr, addr = unsigned(bits), unsigned(bits + 1), unsigned(bits + 1)
    fetched = unsigned(WIDTH)

    @always_comb
    def decide():
        stands.next = finish or not (start or run)

    @always_seq(clk.posedge, reset=rst)
    def step():
        if stands:
            counter.next = begin
        else:
            counter.next = counter + 1

    widen = ops.widen(counter, counted)
    join = ops.join(counted, False, step_addr)

    @always(clk.posedge)
    def fetch():
        fetched.next = memory[step_addr]

    @always(clk.posedge)
    def find():
        coeff.next = memory[addr]

    registers = program.pipeline.memory_registers
    late = delay(clk, None, fetched, word, clocks=1) if registers else connect(fetched, word)
    common = decide, step, widen, join, fetch, find, late
    if not design.looks_up:
        weigh = ops.join(counted, True, addr)

        kind.read = read.read = True  # The lane's accumulator alone reads these.
        return common, weigh

    looks, row, wide = flag(), unsigned(program.row_width), unsigned(bits)

    @always_comb
    def look():
        looks.next = kind == 1 or kind == 2

    if begin:
        put_below = ops.widen(row, wide)

        put = put_below
    else:
        put_above = ops.join(True, row, wide)

        put = put_above

    @always_comb
    def choose():
        if looks:
            addr.next = concat(wide, kind[1])
        else:
            addr.next = concat(counted, True)

    return (
        common,
        look,
        put,
        choose,
        row_of(read, place, row, low=program.segment_width, bits=program.segment_bits),
    )
