"""i_memory: a ROM with the intercept i_n of every segment."""

from golden.activation.rom import Rom


class IMemory(Rom):
    """ROM of the intercept i_n by segment address (thesis section 5.4.5.2); see ``segments``."""

    block = "i_memory"
    section = "5.4.5.2"
    port_meanings = ("segment number less one", "intercept i_n of the segment")
