"""What is proved of program_ram, whatever steers it.

The contents of its words are left to the bench: for so large a memory z3 gave no answer in minutes.
"""

from tb.engine.prove_program_memory import counted


def properties(twin):
    return [counted(twin, 1 << twin.addr_width)]
