"""Proved properties of program_ram, whatever controls it.

The contents of the words are left to the bench, because z3 gives no answer within minutes for so
large a memory.
"""

from tb.engine.prove_program_memory import counted


def properties(twin):
    return [counted(twin, 1 << twin.addr_width)]
