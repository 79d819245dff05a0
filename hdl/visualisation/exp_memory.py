"""exp_memory: holds exp(-x) for the middle of every interval of x."""

from myhdl import block

from golden.visualisation.load_profile import ExpMemory
from hdl.common.rom import registered_rom


@block
def exp_memory(clk, addr, word, *, spec: ExpMemory):
    """exp(-x) by the upper bits of x, one clock later (thesis section 5.8, Figure 5.25).

    Latency 1 clock, one word a clock: a block RAM. There is nothing to reset.
    """
    return registered_rom(clk, addr, word, words=spec.words, meanings=spec.meanings)
