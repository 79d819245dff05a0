"""precise, assembled, against its twin: codes back to back, with gaps and resets."""

from tb.common.case_library import cases
from tb.common.stimulus import activation_codes
from tb.common.stream import suite
from tb.common.watch import pipeline

CASES = cases("rails-precise", "precise")

sweep, gaps_and_resets = suite(__name__, activation_codes)


def properties(twin):
    broken = (
        (r"sum_valid <= delay1_taps\[\(4 - 1\)\]", "sum_valid <= delay1_taps[2]"),
        (r"delay1_taps\[2\] <= 0;", ""),
    )
    return [pipeline(twin, broken)]
