"""output_controller against its twin: frames as close as allowed, with gaps and resets.

What an ``in_valid`` does while rows are stepped through is left out: CONTROLLER 1 prevents it.
"""

import cocotb
import numpy as np

from golden.common.border import State
from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.properties import Property
from tb.common.recorded_frames import recorded_frames
from tb.common.stimulus import LONG_IDLE, random_resets

CASES = cases("rails")

RECORDED = 1000


async def check(bench, gap, resets):
    outputs = bench.twin.outputs
    length = 1
    starts = []
    for _ in range(500):
        starts.append(length)
        length += outputs + (int(bench.rng.geometric(1 - gap)) - 1 if gap else 0)
    valid = np.zeros(length + LONG_IDLE, dtype=np.int64)
    valid[starts] = 1
    drive = {"in_valid": valid}
    if resets:
        drive["rst"] = random_resets(bench.rng, len(valid), every=40)
        # No frame enters during a reset, because the flag that drives ``in_valid`` is cleared.
        drive["in_valid"] = valid & ~drive["rst"] & 1
    await check_frames(bench, drive, resets)
    bench.finish(at_least=500)


async def check_frames(bench, drive, resets=False):
    outputs = bench.twin.outputs
    recording = await bench.play(drive, ["addr", "out_valid", "out_last"])
    entered = recording.rows("in_valid")
    rows = entered[:, np.newaxis] + np.arange(outputs)
    # Row t + 1 follows row t, unless there is a reset in row t.
    alive = recording.undisturbed(np.repeat(entered, outputs), (rows - 1).ravel())
    expected_rows = rows.ravel()[alive]
    addr = bench.twin.process(len(entered)).ravel()[alive]
    bench.compare("clocks of out_valid", recording.rows("out_valid"), expected_rows)
    bench.compare("addr", recording.unsigned("addr", expected_rows), addr, clock=expected_rows)
    if resets:
        met = np.isin(expected_rows, recording.resets())
        bench.visit(State("reset in a row", range(1, outputs)), addr[met])
    last = expected_rows[addr == outputs - 1]
    bench.compare("clocks of out_last", recording.rows("out_last"), last)


@cocotb.test()
async def back_to_back(dut):
    await check(Bench(dut), gap=0.0, resets=False)


@cocotb.test()
async def recorded(dut):
    """Play the recorded frames as close as the design takes them."""
    bench = Bench(dut)
    count, interval = len(recorded_frames(bench, most=RECORDED)), bench.given.design.core.interval
    valid = np.zeros(count * interval + LONG_IDLE, dtype=np.int64)
    valid[1 + interval * np.arange(count)] = 1
    await check_frames(bench, {"in_valid": valid})
    bench.facts["recorded"] = count
    # The address and the clock of each row are compared, and the clock of each ``last``.
    bench.finish(at_least=count * (2 * bench.twin.outputs + 1))


@cocotb.test()
async def gaps(dut):
    await check(Bench(dut), gap=0.5, resets=False)


@cocotb.test()
async def resets(dut):
    await check(Bench(dut), gap=0.2, resets=True)


def properties(twin):
    outputs = twin.outputs
    watch = f"""
        // Clocks since the in_valid that was the cause, as many as there are outputs, or none.
        reg [15:0] due = 0;
        wire [15:0] left = in_valid && due == 0 ? {outputs} : due;
        always @(posedge clk) due <= rst || left == 0 ? 0 : left - 1;
    """
    return [
        Property(
            name="rows in order",
            sentence="Rows are valid in the clocks that follow an in_valid, one for each output, "
            "and in no others; a reset ends them. One row after the other is asked for. The first "
            "one comes with in_valid, and out_last marks the last one and no other.",
            states=(
                "out_valid == (left != 0)",
                f"!out_valid || addr == {outputs} - left",
                "out_last == (left == 1)",
            ),
            watch=watch,
            helps=(f"due <= {outputs - 1}", f"count == (due == 0 ? 0 : {outputs} - due)"),
            reached=("out_last", "!out_valid"),
            refuted_by=(
                (r"out_valid = \(in_valid \|\| \(count != 0\)\)", "out_valid = (count != 0)"),
                (r"rst == 1", "0"),
                (r"\((\d+) - 1\)", r"(\1)"),
                (r"count \+ 1", "count + 2"),
            ),
        )
    ]
