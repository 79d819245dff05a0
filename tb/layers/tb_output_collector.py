"""output_collector against its twin.

Sweeps: 1000 frames of random results with the rails among them.
Drives: frames as close as the outputs allow and at random distances, with other words on the ports
in all other clocks; then the same with resets at random clocks, which end a frame.
Checks: data, valid and last in every clock.
Does not prove: what a frame does that comes while another is still leaving; the networks rule it
out.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import CASCADES, MULTIPLES
from tb.common.stimulus import random_resets, spread

CASES = {name: CASCADES[name] for name in ("chain", "slow-cascade")} | {"three": MULTIPLES["three"]}


async def check(bench, gap, resets):
    twin, rng = bench.twin, bench.rng
    fmt, outputs = twin.fmt, twin.outputs
    words = rng.integers(fmt.low, fmt.high + 1, (1000, outputs))
    words[::50], words[1::50] = fmt.low, fmt.high
    ports = [f"in_data_{i}" for i in range(outputs)]
    items = dict(zip(ports, words.T, strict=True))
    drive = spread(rng, items, "in_valid", gap, tail=outputs + 3, pause=outputs - 1)
    if resets:
        drive["rst"] = random_resets(rng, len(drive["in_valid"]), every=40)
    recording = await bench.play(drive, ["out_valid", "out_data", "out_last"])

    entered = recording.rows("in_valid")
    seen = np.stack([recording.signed(port, entered) for port in ports], axis=1)
    rows = entered[:, np.newaxis] + bench.latency + np.arange(outputs)
    alive = recording.undisturbed(np.repeat(entered, outputs), (rows - 1).ravel())
    expected_rows = rows.ravel()[alive]
    remaining = np.zeros(recording.clocks, dtype=np.int64)
    remaining[expected_rows] = np.tile(np.arange(outputs, 0, -1), len(entered))[alive]
    bench.visit("results still to leave", remaining)
    bench.compare("clocks of out_valid", recording.rows("out_valid"), expected_rows)
    got = recording.signed("out_data", expected_rows)
    bench.compare("out_data", got, twin.process(seen)[alive], clock=expected_rows)
    last = expected_rows[np.tile(np.arange(outputs) == outputs - 1, len(entered))[alive]]
    bench.compare("clocks of out_last", recording.rows("out_last"), last)
    bench.finish(at_least=1000)


@cocotb.test()
async def back_to_back(dut):
    await check(Bench(dut), gap=0.0, resets=False)


@cocotb.test()
async def gaps(dut):
    await check(Bench(dut), gap=0.5, resets=False)


@cocotb.test()
async def resets(dut):
    await check(Bench(dut), gap=0.2, resets=True)
