"""i_memory against its twin.

Sweeps: every address that the port can carry, also beyond the last word.
Drives: each address once, then 200 addresses in random order, then those that the block gets while
the recorded frames run through the design.
Checks: the word bit for bit, in the same clock.
Does not prove: that the contents are the right ones (tests/test_gradient.py does).
"""

import cocotb

from tb.common.bench import Bench
from tb.common.case_library import PARTS
from tb.common.memory import check_memory
from tb.common.recorded_frames import recorded_inputs
from tb.common.watch import read_only

CASES = PARTS


@cocotb.test()
async def every_address(dut):
    bench = Bench(dut)
    await check_memory(bench, *recorded_inputs(bench))


def properties(twin):
    """Proved properties, at every address."""
    return [
        read_only(
            twin,
            (
                (r"0: word = ", "0: word = 1 + "),
                (r"default: word = ", "default: word = 1 + "),
            ),
        ),
    ]
