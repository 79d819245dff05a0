"""gradient, assembled, against its twin: codes and those of recorded frames, with gaps and resets.

How close the schemes are to tanh, here and in the other benches, is tested over all codes in
tests/.
"""

from tb.common.case_library import cases
from tb.common.recorded_frames import recorded_test
from tb.common.stimulus import activation_codes
from tb.common.stream import suite
from tb.common.watch import pipeline

CASES = cases("rails")

sweep, gaps_and_resets = suite(__name__, activation_codes)
what_recorded_frames_bring = recorded_test(__name__)


def properties(twin):
    broken = (
        (r"\.in_valid\(sum_valid\)", ".in_valid(addr_valid)"),
        (r"\.in_valid\(mag_valid\)", ".in_valid(mag_valid && !negative)"),
    )
    return [pipeline(twin, broken)]
