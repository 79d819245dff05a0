"""pade against its twin: codes as close as it takes them, with gaps and resets, and closer.

A result stays until the next one, and a code that is followed too soon has none.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.properties import Property
from tb.common.stimulus import activation_codes, spread
from tb.common.stream import suite
from tb.common.watch import ago

CASES = cases("rails-pade", "pade-thesis")

sweep, gaps_and_resets = suite(__name__, activation_codes, at_once=2048)


@cocotb.test()
async def early_codes(dut):
    bench = Bench(dut)
    twin = bench.twin
    items = {"in_data": bench.rng.choice(activation_codes(bench)["in_data"], 500)}
    pause = bench.rng.integers(0, 2 * twin.interval, 500)
    drive = spread(bench.rng, items, "in_valid", 0.0, bench.latency + 4, pause)
    recording = await bench.play(drive, ["out_valid", "out_data"])
    entered = recording.rows("in_valid")
    # A code has a result if the next code does not come earlier than the block takes it.
    kept = entered[np.diff(entered, append=recording.clocks) >= twin.interval]
    left = recording.rows("out_valid")
    bench.compare("clocks of the results", left, kept + bench.latency)
    stays = np.diff(left, append=recording.clocks)
    expected = np.repeat(twin.process(recording.signed("in_data", kept)), stays)
    rows = np.arange(left[0], recording.clocks)
    bench.compare("out_data in every clock", recording.signed("out_data", rows), expected)
    bench.finish(at_least=500)


def properties(twin):
    late, least = twin.latency, twin.interval
    return [
        Property(
            name="one for each",
            sentence=f"An in_valid that no other follows within {least - 1} clocks yields one "
            f"out_valid {late} clocks later, unless a reset came between, and nothing else does.",
            states=(f"out_valid == (valid_ago[{late - 1}] && !crowded[{late - 1}])",),
            watch=ago("valid_ago", "in_valid", late)
            + f"""
                // Which of them another follows too early.
                reg [{late - 1}:0] crowded = 0;
                wire [{late - 1}:0] early = in_valid ? {(1 << (least - 1)) - 1} : 0;
                always @(posedge clk) crowded <= rst ? 0 : {{crowded | early, 1'b0}};
            """,
            reached=("out_valid",),
            refuted_by=(
                (r"remaining <= \(3 - 1\)", "remaining <= 3"),
                (r"active && \(remaining == 0\)", "(remaining == 0)"),
                (r"result_valid <= ready", "result_valid <= (ready || start)"),
            ),
            clocks=late + 4,
            induction=late + 3,
        )
    ]
