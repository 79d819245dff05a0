"""program_ram: as program_memory, but the words of the program can be written."""

from myhdl import Signal, always, always_comb, always_seq, block, modbv

from golden.engine.formats import WORD_WIDTH
from golden.engine.memories import ProgramRam
from hdl.common.delay import connect, delay
from hdl.common.signals import flag, unsigned


@block
def program_ram(clk, rst, *, start, run, finish, write, write_addr, data, word, spec: ProgramRam):
    """Words of 36 bits, of which a counter reads one in each clock, and which can be written.

    What is written takes the counter's port. Nothing is read in the clock of a write, because what
    a block RAM then gives differs between devices. Reset puts the counter to the first word.
    """
    memory = [unsigned(WORD_WIDTH) for _ in range(1 << spec.addr_width)]
    counter = Signal(modbv(0, min=0, max=1 << spec.addr_width))
    addr = unsigned(spec.addr_width)
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

    @always_comb
    def choose():
        if write:
            addr.next = write_addr
        else:
            addr.next = counter

    @always(clk.posedge)
    def fetch():
        if write:
            memory[addr].next = data
        else:
            fetched.next = memory[addr]

    common = decide, step, choose, fetch
    if spec.registers:
        return common, delay(clk, None, fetched, word, clocks=spec.registers)
    return common, connect(fetched, word)
