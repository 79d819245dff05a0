"""sign_retriever against its twin: all inputs and those of recorded frames."""

import numpy as np

from tb.common.case_library import cases
from tb.common.recorded_frames import recorded_test
from tb.common.stream import suite
from tb.common.watch import pipeline

CASES = cases("rails")


def operands(bench):
    mags = np.arange(bench.twin.fmt.high + 1)
    return {"in_mag": np.tile(mags, 2), "in_negative": np.repeat([0, 1], len(mags))}


sweep, gaps_and_resets = suite(__name__, operands)
what_recorded_frames_bring = recorded_test(__name__)


def properties(twin):
    broken = (
        (r"out_valid <= in_valid", "out_valid <= (in_valid && !in_negative)"),
        (r"rst == 1", "0"),
    )
    return [pipeline(twin, broken)]
