"""What is proved of program_ram, whatever steers it.

What its words hold is left to the bench: of so large a memory z3 has not answered in minutes.
"""

from tb.engine.prove_program_memory import counted


def properties(twin):
    return [counted(twin, 1 << twin.addr_width)]
