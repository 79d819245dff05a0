"""lut against its twin: codes about every step of the table, back to back, with gaps and resets."""

from tb.common.case_library import cases
from tb.common.stimulus import activation_codes
from tb.common.stream import suite
from tb.common.watch import pipeline

CASES = cases("rails-lut", "lut-thesis", "lut-short")

sweep, gaps_and_resets = suite(__name__, activation_codes)


def properties(twin):
    broken = ((r"word_valid <= segment_valid", "word_valid <= mag_valid"), (r"rst == 1", "0"))
    return [pipeline(twin, broken)]
