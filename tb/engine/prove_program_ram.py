"""What is proved of program_ram, whatever steers it.

What its words hold is left to the bench: of a memory of this size no solver has answered in minutes.
"""

from tb.engine.prove_program_memory import counted


def properties(twin):
    return [counted(twin, 1 << twin.addr_width)]
