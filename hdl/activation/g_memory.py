"""g_memory: holds the gradient G_n of every segment."""

from myhdl import block

from golden.activation.g_memory import GMemory
from hdl.common.rom import rom


@block
def g_memory(addr, word, *, spec: GMemory):
    """The gradient G_n at addr, in the same clock (thesis section 5.4.5.2).

    Latency 0 clocks: a table of a few words is LUTs, and GRAD_EQN registers the product.
    """
    return rom(addr, word, words=spec.words, meanings=spec.meanings)
