"""g_memory: a ROM with the gradient G_n of every segment."""

from golden.activation.rom import Rom


class GMemory(Rom):
    """ROM of the gradient G_n by segment address (thesis section 5.4.5.2); see ``segments``."""

    block = "g_memory"
    section = "5.4.5.2"
    port_meanings = ("segment number less one", "gradient G_n of the segment")
