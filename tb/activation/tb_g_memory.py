"""g_memory against its twin: every address, also beyond the last word, in the same clock."""

from tb.common.case_library import cases
from tb.common.memory import memory_test

CASES = cases("rails")

every_address = memory_test(__name__)
