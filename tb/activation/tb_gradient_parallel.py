"""gradient_parallel against its twin: codes back to back, with gaps and resets."""

from tb.common.case_library import cases
from tb.common.stimulus import activation_codes
from tb.common.stream import suite
from tb.common.watch import pipeline

CASES = cases("rails-gradient_parallel", "gradient_parallel-thesis")

sweep, gaps_and_resets = suite(__name__, activation_codes)


def properties(twin):
    broken = (
        (r"\.in_valid\(valid_0\)", ".in_valid(valid_0 && !negative_late)"),
        (r"\.in_valid\(mag_valid\)", ".in_valid(in_valid)"),
    )
    return [pipeline(twin, broken)]
