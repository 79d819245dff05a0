"""polynomial against its twin: codes back to back, with gaps and resets.

Among them are those whose exact result lies closest to the border of the next result.
"""

import numpy as np

from tb.common.case_library import cases
from tb.common.stimulus import activation_codes
from tb.common.stream import suite
from tb.common.watch import pipeline

CASES = cases("rails-polynomial", "polynomial-thesis", "polynomial-short")

# The closest of 57344 magnitudes lie within a two-thousandth of the last bit of a border.
CLOSEST = 32


def close(bench):
    magnitudes = bench.twin.closest_to_rounding(CLOSEST)
    return np.concatenate([magnitudes, -magnitudes])


sweep, gaps_and_resets = suite(__name__, lambda bench: activation_codes(bench, close(bench)))


def properties(twin):
    broken = (
        (r"result_valid <= delay2_taps\[\(1 - 1\)\]", "result_valid <= segment_valid"),
        (r"rst == 1", "0"),
    )
    return [pipeline(twin, broken)]
