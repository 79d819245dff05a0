"""operand_memory: holds the samples, hidden sums, tanh and outputs of one frame."""

from myhdl import Signal, always, block, intbv

from golden.engine.formats import WORD
from golden.engine.memories import OperandMemory
from hdl.common.delay import connect, delay
from hdl.common.signals import fixed


@block
def operand_memory(clk, *, write, write_addr, data, read_addr, word, spec: OperandMemory):
    """Words of 18 bits, one written and one read a clock.

    A word that is read while it is written is the one before. No reset, so that it can be a block
    RAM.
    """
    memory = [
        Signal(intbv(0, min=WORD.low, max=WORD.high + 1)) for _ in range(1 << spec.addr_width)
    ]
    found = fixed(WORD)

    @always(clk.posedge)
    def keep():
        if write:
            memory[write_addr].next = data

    @always(clk.posedge)
    def read():
        found.next = memory[read_addr]

    if spec.registers:
        return keep, read, delay(clk, None, found, word, clocks=spec.registers)
    return keep, read, connect(found, word)
