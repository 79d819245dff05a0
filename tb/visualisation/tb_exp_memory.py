"""exp_memory against its twin.

Sweeps: every address.
Drives: each address once, then 200 in random order, then those that the recorded frames bring, one
in each clock.
Checks: the word bit for bit, and the clock in which it appears.
Does not prove: that the contents are the right ones (tests/test_visualisation.py does).
"""

import cocotb

from tb.common.bench import Bench
from tb.common.case_library import DRAWN
from tb.common.memory import check_memory
from tb.common.recorded_frames import recorded_inputs

CASES = DRAWN


@cocotb.test()
async def every_address(dut):
    bench = Bench(dut)
    await check_memory(bench, *recorded_inputs(bench))
