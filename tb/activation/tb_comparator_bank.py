"""comparator_bank against its twin: magnitudes and those of recorded frames, with gaps and resets.

That the thresholds are the right ones is tested in tests/test_schemes.py.
"""

import numpy as np

from golden.numbers.fixed import Fix
from tb.common.case_library import cases
from tb.common.recorded_frames import recorded_test
from tb.common.stimulus import all_codes
from tb.common.stream import suite
from tb.common.watch import pipeline

CASES = cases("rails")


def magnitudes(bench):
    twin = bench.twin
    codes = all_codes(Fix(twin.mag_width + 1, 0), np.array(twin.thresholds), bench.rng)
    return {"in_mag": codes[codes >= 0]}


def expected(twin):
    return lambda mag: (twin.process(mag), mag)


sweep, gaps_and_resets = suite(__name__, magnitudes, expected)
what_recorded_frames_bring = recorded_test(__name__, expected)


def properties(twin):
    broken = (
        (r"out_valid <= in_valid", "out_valid <= (in_valid && (addr == 0))"),
        (r"rst == 1", "0"),
    )
    return [pipeline(twin, broken)]
