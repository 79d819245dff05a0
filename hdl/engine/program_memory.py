"""program_memory: holds the words of a program, and steps through it."""

from myhdl import Signal, always, always_comb, always_seq, block, modbv

from golden.engine.formats import WORD_WIDTH
from golden.engine.memories import ProgramMemory
from hdl.common.delay import connect, delay
from hdl.common.rom import Constants
from hdl.common.signals import flag, unsigned


@block
def program_memory(clk, rst, *, start, run, finish, word, spec: ProgramMemory):
    """Words of 36 bits, of which a counter reads one in each clock.

    Reset puts the counter to the first word.
    """
    memory = Constants(spec.contents, WORD_WIDTH, spec.meanings)
    counter = Signal(modbv(0, min=0, max=1 << spec.addr_width))
    stands, fetched = flag(), unsigned(WORD_WIDTH)

    @always_comb
    def decide():
        stands.next = finish or not (start or run)

    @always_seq(clk.posedge, reset=rst)
    def step():
        if stands:
            counter.next = 0
        else:
            counter.next = counter + 1

    @always(clk.posedge)
    def fetch():
        fetched.next = memory[counter]

    if spec.registers:
        return decide, step, fetch, delay(clk, None, fetched, word, clocks=1)
    return decide, step, fetch, connect(fetched, word)
