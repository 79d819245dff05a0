"""ramp against its twin.

Sweeps: every position, several times over.
Drives: requests for positions in the clocks in which the profile asks for those of the recorded
frames; then back to back, with gaps, and with resets.
Checks: position and ``out_last`` bit for bit, and their clock; that they stay until the next
position; that a reset leads back to the first position.
Does not prove: that the positions are the nearest codes (tests/test_visualisation.py does).
"""

import cocotb
import numpy as np

from golden.visualisation.load_profile import LoadProfile
from tb.common.bench import Bench
from tb.common.case_library import OTHER_PROFILES
from tb.common.recorded_frames import MOST_SEEN, recorded_frames
from tb.common.stimulus import LONG_IDLE, random_resets

CASES = OTHER_PROFILES


async def check(bench, chance, resets=False):
    """Request a position in ``chance`` of the clocks, and compare."""
    length = 4 * bench.twin.points + 200 + LONG_IDLE
    drive = {"in_valid": (bench.rng.random(length) < chance).astype(np.int64)}
    drive["in_valid"][-LONG_IDLE:] = 0
    if resets:
        drive["rst"] = random_resets(bench.rng, length, max(4, bench.twin.points // 2))
    await check_requests(bench, drive)


async def check_requests(bench, drive):
    recording = await bench.play(drive, ["out_valid", "out_data", "out_last"])
    asked = recording.rows("in_valid")
    asked = asked[recording.undisturbed(asked, asked)]
    since = np.searchsorted(recording.resets(), asked)
    first = np.searchsorted(since, since)
    number = (np.arange(len(asked)) - first) % bench.twin.points
    expected, last = bench.twin.process()[number], number == bench.twin.points - 1

    bench.visit("position", number)
    left = recording.rows("out_valid")
    bench.compare("clocks of the positions", left, asked + bench.latency)
    # A position that is requested in the clock of a reset is not valid, but it changes the data.
    stays = np.flatnonzero(recording.undisturbed(left[:-1], left[1:] - 1))
    for rows, n in ((left, np.arange(len(left))), (left[stays + 1] - 1, stays)):
        bench.compare("out_data", recording.signed("out_data", rows), expected[n], number=number[n])
        bench.compare("out_last", recording.unsigned("out_last", rows), last[n], number=number[n])


@cocotb.test()
async def what_recorded_frames_bring(dut):
    """Draw the ramp for each recorded frame, a position whenever the point before is there."""
    bench = Bench(dut)
    (profile,) = bench.around(LoadProfile)
    count = len(recorded_frames(bench, most=MOST_SEEN // bench.twin.points)) * bench.twin.points
    clocks = np.arange(count * profile.latency)
    await check_requests(bench, {"in_valid": (clocks % profile.latency == 0).astype(np.int64)})
    bench.facts["recorded"] = count
    bench.finish(at_least=5 * count - 2)


@cocotb.test()
async def back_to_back(dut):
    bench = Bench(dut)
    await check(bench, 1.0)
    bench.finish(at_least=4 * bench.twin.points)


@cocotb.test()
async def gaps(dut):
    bench = Bench(dut)
    await check(bench, 0.4)
    bench.finish(at_least=bench.twin.points)


@cocotb.test()
async def resets(dut):
    """Play resets, after each of which the first position comes."""
    bench = Bench(dut)
    for chance in (1.0, 0.5):
        await check(bench, chance, resets=True)
    bench.finish(at_least=bench.twin.points)
