"""grad_eqn against its twin: magnitudes of each segment, and those of recorded frames.

Magnitudes on either side of places at which the result changes are among them.
"""

import numpy as np

from golden.activation.gradient import Gradient
from tb.common.case_library import cases
from tb.common.recorded_frames import recorded_test
from tb.common.stream import suite
from tb.common.watch import pipeline

CASES = cases("rails")

STEPS = 100


def operands(bench):
    """Magnitudes of each segment, with the constants of the segment."""
    table = bench.around(Gradient)[0].table
    ends = [-1, *table.thresholds, (1 << bench.twin.mag_width) - 1]
    columns = {name: [] for name in ("in_mag", "in_coeff", "in_intercept")}
    for n, (coeff, intercept) in enumerate(zip(table.coeffs, table.intercepts, strict=True)):
        low, high = ends[n] + 1, ends[n + 1]
        mags = np.concatenate([[low, high], bench.rng.integers(low, high + 1, 1000)])
        every = np.arange(low, high + 1)
        steps = every[:-1][np.diff(bench.twin.process(every, coeff, intercept)) != 0]
        steps = bench.rng.permutation(steps)[:STEPS]
        mags = np.concatenate([mags, steps, steps + 1])
        columns["in_mag"].append(mags)
        columns["in_coeff"].append(np.full(len(mags), coeff))
        columns["in_intercept"].append(np.full(len(mags), intercept))
    return {name: np.concatenate(values) for name, values in columns.items()}


segments, gaps_and_resets = suite(__name__, operands, swept="segments")
what_recorded_frames_bring = recorded_test(__name__)


def properties(twin):
    broken = (
        (r"delay0_taps\[0\] <= in_valid", "delay0_taps[0] <= (in_valid || delay0_taps[0])"),
        (r"out_valid <= delay0_taps\[\(2 - 1\)\]", "out_valid <= delay0_taps[0]"),
        (r"delay0_taps\[1\] <= 0;", ""),
    )
    return [pipeline(twin, broken)]
