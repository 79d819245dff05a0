"""bipartite against its twin: codes over the whole range, back to back, with gaps and resets.

For each bit of every word of both tables there is a code of either sign whose result it changes.
"""

from tb.common.case_library import cases
from tb.common.stimulus import activation_codes
from tb.common.stream import suite
from tb.common.watch import pipeline

CASES = cases("bipartite")

sweep, gaps_and_resets = suite(
    __name__, lambda bench: activation_codes(bench, bench.twin.word_codes)
)


# In one copy the valid flag skips its last register, in the other a register has no reset.
LATE = (
    (r"out_valid <= (\w+)\[\(3 - 1\)\]", r"out_valid <= \1[1]"),
    (r"(delay\d+_taps\[2\]) <= 0;", ""),
)


def properties(twin):
    return [pipeline(twin, LATE)]
