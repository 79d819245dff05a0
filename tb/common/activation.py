"""What the benches of all activations that take a code a clock do.

The tests themselves stand in each bench, because the seed of a test follows from its module.
"""

import numpy as np

from tb.common.stimulus import all_codes
from tb.common.stream import check_gaps_and_resets, check_stream


def codes(bench, *more):
    """Codes over the whole range and about each border, and some more."""
    twin = bench.twin
    return np.concatenate([all_codes(twin.in_fmt, twin.border_codes, bench.rng), *more])


async def sweep(bench, *more, at_least=16384):
    await check_stream(bench, {"in_data": codes(bench, *more)})
    bench.finish(at_least)


async def gaps_and_resets(bench, *more):
    await check_gaps_and_resets(bench, {"in_data": codes(bench, *more)})
