"""abs_unit against its twin: codes and those of recorded frames, with gaps and resets."""

from tb.common.case_library import cases
from tb.common.recorded_frames import recorded_test
from tb.common.stimulus import all_codes
from tb.common.stream import suite
from tb.common.watch import pipeline

CASES = cases("rails")


def codes(bench):
    return {"in_data": all_codes(bench.twin.fmt, [], bench.rng)}


sweep, gaps_and_resets = suite(__name__, codes)
what_recorded_frames_bring = recorded_test(__name__)


def properties(twin):
    broken = (
        (r"out_valid <= in_valid", "out_valid <= (in_valid || out_valid)"),
        (r"rst == 1", "0"),
    )
    return [pipeline(twin, broken)]
