"""i_memory: holds the intercept i_n of every segment."""

from myhdl import block

from golden.activation.i_memory import IMemory
from hdl.common.rom import rom


@block
def i_memory(addr, word, *, spec: IMemory):
    """The intercept i_n at addr, in the same clock (thesis section 5.4.5.2).

    Latency 0 clocks: a table of a few words is LUTs, and GRAD_EQN registers the product.
    """
    return rom(addr, word, words=spec.words, meanings=spec.meanings)
