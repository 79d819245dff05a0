"""instrument against its twin: from the converter's codes to everything that is shown.

Codes are those of recorded frames, of the highest and the deepest profile, and random ones with
resets. Frames of wrong lengths, which the sequencer does not make, are a matter of tb_readout.
"""

import cocotb
import numpy as np

from tb.common import readout
from tb.common.bench import RESET_CLOCKS, Bench, test_of
from tb.common.case_library import cases
from tb.common.framing import Scans, check_outputs
from tb.common.network import recorded_frames
from tb.common.properties import Property
from tb.common.stimulus import resets_before
from tb.common.watch import sent

CASES = cases("drawn", "instruments", "winner-instrument")

CLOCKS = 10_000
WATCH = ["address", "out_valid", "out_data", "out_last"]


def scans_that_fit(bench):
    return bench.twin.past + max(2, CLOCKS // bench.twin.interval)


def random_codes(bench, clocks):
    """Random codes, of which one in eight is an end of the range."""
    fmt, rng = bench.twin.scan_sequencer.fmt, bench.rng
    codes = rng.integers(fmt.low, fmt.high + 1, clocks)
    return np.where(rng.random(clocks) < 1 / 8, rng.choice([fmt.low, fmt.high], clocks), codes)


async def check(bench, codes, resets=None):
    """Play the codes of the converter, and return the recording and the frames."""
    scan, shown = bench.twin.scan_sequencer, bench.twin.readout
    drawing = shown.load_profile.interval if shown.load_profile else 0
    tail = random_codes(bench, bench.twin.output_clocks[-1] + bench.twin.outputs + 2 * drawing + 5)
    drive = {"adc": np.concatenate([codes, tail])}
    if resets:
        # A complete scan follows the last reset.
        last = scan.scan_clocks + len(tail)
        drive["rst"] = resets_before(bench.rng, len(drive["adc"]), resets, last)
    recording = await bench.play(drive, WATCH + readout.ports(shown))

    scans = Scans(recording, scan.scan_clocks)
    final = scan.sample_clocks[-1]
    ends = scans.rows[(scans.count == final) & ~np.isin(scans.rows, scans.marks)]
    starts = ends - final
    taken = starts[:, np.newaxis] + scan.sample_clocks[: scan.inputs]
    frames = recording.signed("adc", taken.ravel()).reshape(taken.shape)
    # The address changes one clock after the slot begins. In the first clock after a reset it is
    # still the old one.
    steady = (scans.since >= 1) & ~np.isin(scans.rows, scans.marks)
    rows = scans.rows[steady]
    expected = scan.address_at(scans.count[steady] - 1)
    bench.compare("address", recording.unsigned("address", rows), expected, clock=rows)
    check_outputs(bench, recording, (bench.twin, starts, ends, frames))
    readout.check_shown(bench, recording, shown)
    return recording, frames


def codes_of(bench, frames):
    """The codes of the converter: those of the frames when they are taken, else random ones."""
    scan = bench.twin.scan_sequencer
    codes = random_codes(bench, len(frames) * scan.scan_clocks)
    at = np.arange(len(frames))[:, np.newaxis] * scan.scan_clocks + scan.sample_clocks
    codes[at] = frames[:, np.array(scan.addresses[: scan.slots])]
    return codes


@cocotb.test()
async def recorded(dut):
    """Play recorded frames and count the clocks of a frame."""
    bench = Bench(dut)
    frames, past = recorded_frames(bench)[: scans_that_fit(bench)], bench.twin.past
    recording, seen = await check(bench, codes_of(bench, frames))
    # The clocks at the end may hold another scan.
    bench.compare("frames", seen[: len(frames)], frames)
    first = RESET_CLOCKS + past * bench.twin.interval
    ends = recording.rows("out_last")
    bench.measured(recording, len(frames), first, ends[0], ends)
    bench.finish(at_least=(len(frames) - past) * bench.twin.outputs)


@test_of(lambda twin: bool(twin.readout.load_profile))
async def highest_and_deepest(dut):
    """Play the frames with the highest and the deepest profile."""
    bench = Bench(dut)
    shown = bench.twin.readout
    during = shown.load_profile.interval // bench.twin.interval
    await check(bench, codes_of(bench, readout.extremes(bench, shown, times=1 + during)))
    bench.finish(at_least=bench.twin.outputs)


@cocotb.test()
async def random_and_resets(dut):
    """Play random codes with resets, some of them in mid-scan."""
    bench = Bench(dut)
    scan = bench.twin.interval
    await check(
        bench, random_codes(bench, scans_that_fit(bench) * scan), resets=max(100, scan // 2)
    )
    bench.finish(at_least=bench.twin.outputs)


def properties(twin):
    """Proved properties: its scans are frames that its network takes."""
    scan, network = twin.scan_sequencer, twin.readout.network
    clocks = scan.scan_clocks
    taken = [n * scan.slot_clocks + scan.sample_clock for n in range(scan.slots)]
    judged, states, spacing = sent(network, f"u_readout_0.u_{network.entity}_0")
    at = " || ".join(f"clock_of_scan == {n}" for n in taken)
    arrived = " + ".join(f"(clock_of_scan > {n + 1})" for n in taken)
    # This counts the clocks since the last sample of the previous scan was judged.
    since = f"((clock_of_scan + {clocks - taken[-1] - 2}) % {clocks})"
    return [
        Property(
            name="right frames",
            sentence=f"Its network never sees a wrong frame: each scan of {clocks} clocks is a "
            f"frame of {scan.slots} samples, far enough behind the one before, from every reset "
            "on.",
            states=states,
            watch=judged
            + f"""
                reg [31:0] clock_of_scan = 0;
                reg sampled = 0, ended = 0;
                always @(posedge clk) begin
                    clock_of_scan <= rst || clock_of_scan == {clocks - 1} ? 0 : clock_of_scan + 1;
                    sampled <= !rst && ({at});
                    ended <= !rst && clock_of_scan == {taken[-1]};
                end
            """,
            helps=(
                f"clock_of_scan < {clocks}",
                "u_scan_sequencer_0.count == clock_of_scan",
                "valid == sampled && last == ended",
                f"!sampled || {' || '.join(f'clock_of_scan == {n + 1}' for n in taken)}",
                f"ended == (sampled && clock_of_scan == {taken[-1] + 1})",
                f"sampled || !({' || '.join(f'clock_of_scan == {n + 1}' for n in taken)})",
                f"sent_place == ({arrived}) % {scan.slots}",
                "!sent_skipping",
                f"sent_closed == 0 || sent_closed + {since} < {spacing}",
            ),
            reached=("last",),
            refuted_by=(
                (r"slot == 1\)\)", "slot == 0))"),
                (r"count == 63", "count == 30"),
                (r"\.in_last\(last\)", ".in_last(valid)"),
            ),
            clocks=clocks + 8,
        )
    ]
