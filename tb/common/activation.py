"""The codes that the benches of all activations play."""

import numpy as np

from tb.common.stimulus import all_codes


def codes(bench, *more):
    """Codes over the whole range and about each border, and some more."""
    twin = bench.twin
    return {
        "in_data": np.concatenate([all_codes(twin.in_fmt, twin.border_codes, bench.rng), *more])
    }
