"""stream_multiplexer against its twin: frames of random length and results at random clocks.

What a slot carries before the first result after a reset is left out: the cascade's delays prevent
it.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.properties import Property
from tb.common.stimulus import random_resets, spread
from tb.common.watch import pipeline

CASES = cases("chain", "slow-cascade")


async def check(bench, gap, resets):
    twin, rng = bench.twin, bench.rng
    fmt = twin.fmt
    count = 3000
    last = (rng.random(count) < 1 / (twin.slot + 2)).astype(np.int64)
    items = {"in_data": rng.integers(fmt.low, fmt.high + 1, count), "in_last": last}
    items["in_data"][::97], items["in_data"][1::97] = fmt.low, fmt.high
    drive = spread(rng, items, "in_valid", gap, tail=4)
    length = len(drive["in_valid"])
    drive["result_valid"] = (rng.random(length) < 0.2).astype(np.int64)
    drive["result"] = rng.integers(fmt.low, fmt.high + 1, length)
    drive["result"][::97], drive["result"][1::97] = fmt.low, fmt.high
    # The first clock has a result and no element.
    drive = {name: np.concatenate([[0], column]) for name, column in drive.items()}
    drive["result_valid"][0] = 1
    if resets:
        drive["rst"] = random_resets(rng, length + 1, every=40)
        drive["result_valid"][1:][np.diff(drive["rst"]) < 0] = 1
    recording = await bench.play(drive, ["out_valid", "out_data", "out_last"])

    rows = np.setdiff1d(recording.rows("in_valid"), recording.resets())
    data = recording.signed("in_data", rows)
    ends = np.isin(rows, recording.rows("in_last"))
    given = recording.rows("result_valid")
    results = recording.signed("result", given)
    since, given_since = (np.searchsorted(recording.resets(), at) for at in (rows, given))
    expected = np.concatenate(
        [
            twin.process(
                *(column[since == epoch] for column in (data, ends, rows)),
                *(column[given_since == epoch] for column in (results, given)),
            )
            for epoch in np.unique(since)
        ]
    )
    # A frame begins after a reset, or after the last element of the frame before.
    new = np.concatenate([[True], ends[:-1] | (np.diff(since) > 0)])
    index = np.arange(len(rows))
    position = index - np.maximum.accumulate(np.where(new, index, 0))
    (state,) = twin.states
    bench.visit(state, np.minimum(position, twin.slot + 1))
    left = recording.rows("out_valid")
    bench.compare("clocks of out_valid", left, rows + 1)
    bench.compare("out_data", recording.signed("out_data", left), expected, in_data=data)
    closed = np.intersect1d(left, recording.rows("out_last"))
    bench.compare("clocks of out_last", closed, rows[ends] + 1)
    replaced = int((expected != data).sum())
    assert replaced > 100, f"{replaced} elements were replaced"
    bench.finish(at_least=2000)


@cocotb.test()
async def back_to_back(dut):
    await check(Bench(dut), gap=0.0, resets=False)


@cocotb.test()
async def gaps(dut):
    await check(Bench(dut), gap=0.4, resets=False)


@cocotb.test()
async def resets(dut):
    await check(Bench(dut), gap=0.2, resets=True)


def properties(twin):
    width = twin.fmt.width
    return [
        pipeline(
            twin,
            (
                (r"out_valid <= in_valid", "out_valid <= (in_valid && !result_valid)"),
                (r"rst == 1\) begin\s+out_last", "0) begin out_last"),
            ),
            last="in_last",
        ),
        Property(
            name="only the slot",
            sentence=f"Element {twin.slot} of each frame is the result that came last, and all "
            "other elements are those that came in.",
            states=("!out_valid || out_data == expected",),
            watch=f"""
                reg [31:0] place = 0;
                reg signed [{width - 1}:0] newest;
                reg signed [{width - 1}:0] expected;
                always @(posedge clk) begin
                    if (result_valid) newest <= result;
                    expected <= place == {twin.slot} ? newest : in_data;
                    if (in_valid) place <= in_last ? 0 : place == 32'hffffffff ? place : place + 1;
                    if (rst) place <= 0;
                end
            """,
            helps=(
                f"count == (place > {twin.slot + 1} ? {twin.slot + 1} : place)",
                "newest == held",
                "!out_valid || expected == out_data",
            ),
            # Both may be anything, but the same.
            assumes={
                "Before the first result, the held result and its copy in the proof are equal.": (
                    "after_reset || newest == held"
                )
            },
            reached=(f"out_valid && place == {twin.slot + 1}",),
            refuted_by=(
                (r"count == 2", "count == 1"),
                (r"count != 3", "1"),
                (r"if \(result_valid\)", "if (1)"),
            ),
        ),
    ]
