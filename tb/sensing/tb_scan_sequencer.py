"""scan_sequencer against its twin: another random code in every clock of whole scans, with resets.

Resets come in each clock about the one in which a code is taken. Of a scan of more than 400000
clocks the end is not played.
"""

import cocotb
import numpy as np

from golden.common.border import State
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import cases
from tb.common.framing import Scans
from tb.common.properties import Property
from tb.common.stimulus import random_resets

CASES = cases("past-instrument", "drawn", "instruments")

# The clocks from the one in which a code is taken to a reset.
ABOUT = range(-2, 4)
MOST_CLOCKS = 400_000
WATCH = ["address", "out_valid", "out_data", "out_last"]


async def check(bench, clocks, resets=None):
    """Play so many clocks, with a column of resets, and compare."""
    twin = bench.twin
    codes = bench.rng.integers(twin.fmt.low, twin.fmt.high + 1, clocks)
    # Both ends of the range are among the codes that are taken.
    rails = [twin.fmt.low, twin.fmt.high]
    codes = np.where(bench.rng.random(clocks) < 1 / 4, bench.rng.choice(rails, clocks), codes)
    drive = {"adc": codes}
    if resets is not None:
        drive["rst"] = resets
    recording = await bench.play(drive, WATCH)

    # A code that is taken in the clock of a reset is lost.
    scans = Scans(recording, twin.scan_clocks)
    rows, since, count = scans.rows, scans.since, scans.count
    sampled = np.isin(count, twin.sample_clocks) & ~np.isin(rows, scans.marks)
    taken = rows[sampled]
    taken = taken[taken + bench.latency < recording.clocks]
    left, adc = taken + bench.latency, recording.signed("adc", taken)
    final = count[taken - RESET_CLOCKS] == twin.sample_clocks[-1]
    bench.compare_stream(recording, left, adc, final, clock=taken)
    stays = np.flatnonzero(recording.undisturbed(left[:-1], left[1:] - 1))
    kept = recording.signed("out_data", left[stays + 1] - 1)
    bench.compare("kept data", kept, adc[stays], clock=left[stays])
    bench.visit("slot", count // twin.slot_clocks)
    steady = np.flatnonzero(since >= 1)
    expected = twin.address_at(count[steady] - 1)
    address = recording.unsigned("address", rows[steady])
    bench.compare("address", address, expected, clock=since[steady])
    return recording


@cocotb.test()
async def scans(dut):
    """Play complete scans, and check that the codes are those that the twin takes."""
    bench = Bench(dut)
    twin = bench.twin
    count = min(3, MOST_CLOCKS // twin.scan_clocks)
    again = twin.slots * twin.slot_clocks
    recording = await check(bench, count * twin.scan_clocks + again + 2)
    clocks = RESET_CLOCKS + np.arange(count * twin.scan_clocks)
    expected = twin.process(recording.signed("adc", clocks).reshape(count, -1))
    got = recording.signed("out_data", recording.rows("out_valid"))
    bench.compare("frames", got[: expected.size], expected.ravel())
    bench.finish(at_least=max(1, count) * twin.slots)


@cocotb.test()
async def resets(dut):
    """Play resets, after each of which the scan begins again."""
    bench = Bench(dut)
    scan = bench.twin.scan_clocks
    clocks = min(3 * scan, MOST_CLOCKS) + 200
    await check(bench, clocks, random_resets(bench.rng, clocks, min(scan, MOST_CLOCKS // 3)))
    bench.finish(at_least=bench.twin.slots)


@cocotb.test()
async def resets_about_a_sample(dut):
    """Play a reset in each clock around the taking of a code, in the first and the last slot."""
    bench = Bench(dut)
    twin = bench.twin
    at, clock = [], 0
    for sample in (twin.sample_clocks[0], twin.sample_clocks[-1]):
        for offset in ABOUT:
            # The scan begins in the clock after a reset.
            clock += 1 + int(sample) + offset
            at.append(clock)
    resets = np.zeros(clock + min(twin.scan_clocks, MOST_CLOCKS) + 2, dtype=np.int64)
    resets[at] = 1
    recording = await check(bench, len(resets), resets)
    found = recording.resets()
    since = np.diff(found, prepend=RESET_CLOCKS - 1) - 1
    for sample in (twin.sample_clocks[0], twin.sample_clocks[-1]):
        bench.visit(State("reset, in clocks from a sample", ABOUT), since - int(sample))
    bench.finish(at_least=twin.slots)


def properties(twin):
    slot = twin.slot_clocks
    taken = [n * slot + twin.sample_clock for n in range(twin.slots)]
    at = " || ".join(f"clock_of_scan == {n}" for n in taken)
    return [
        Property(
            name="one frame a scan",
            sentence=f"Each scan of {twin.scan_clocks} clocks sends {twin.slots} samples, each one "
            f"clock after clock {twin.sample_clock} of its slot, the last one with out_last. A "
            "reset begins a new scan and sends nothing of the old one. In the clock in which a "
            f"code is taken, the address has named its sensor for {twin.sample_clock} clocks, "
            "including that one.",
            states=(
                "out_valid == sampled",
                "out_last == ended",
                "!out_valid || out_data == code",
                f"!({at}) || (steady >= {twin.sample_clock - 1} && address == sensor)",
            ),
            watch=f"""
                reg [15:0] clock_of_scan = 0;
                reg sampled = 0, ended = 0;
                reg signed [{twin.fmt.width - 1}:0] code;
                // Clocks before this one in which the address was the same, and that of the slot.
                reg [15:0] steady = 0;
                reg [15:0] was = 0;
                always @(posedge clk) begin
                    clock_of_scan <= rst || clock_of_scan == {twin.scan_clocks - 1} ? 0
                        : clock_of_scan + 1;
                    sampled <= !rst && ({at});
                    ended <= !rst && clock_of_scan == {taken[-1]};
                    if ({at}) code <= adc;
                    was <= address;
                    steady <= rst ? 0 : address != was ? 1 : steady == 1000 ? 1000 : steady + 1;
                end
                // In what is left of the scan behind the slots, the first sensor's.
                wire [15:0] turn_of_scan = clock_of_scan / {slot};
                wire [15:0] sensor =
                    turn_of_scan < {twin.slots} ? turn_of_scan % {twin.inputs} : 0;
                wire [15:0] into = clock_of_scan % {slot};
            """,
            helps=(
                f"clock_of_scan < {twin.scan_clocks}",
                "count == clock_of_scan",
                "steady <= 1000",
                "into < 1 || address == sensor",
                "into < 2 || (was == address && steady >= into - 1)",
            ),
            reached=("out_last",),
            refuted_by=(
                (rf"clock == {twin.sample_clock}", f"clock == {twin.sample_clock - 1}"),
                (r"slot == 1\)\)", "slot == 0))"),
                (rf"count == {twin.scan_clocks - 1}", "count == 5"),
                (r"rst == 1\) begin\s+out_last", "0) begin out_last"),
                (r"0: turn = 0", "0: turn = 1"),
            ),
            clocks=twin.scan_clocks + 4,
        )
    ]
