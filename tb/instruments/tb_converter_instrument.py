"""converter_instrument against its twin: from the sensors' voltages to everything that is shown.

The converter answers recorded and random voltages, with wrong transfers and resets. Each bit that
shows its presence is a matter of tb_converter_reader, frames of wrong lengths one of tb_readout.
"""

import cocotb
import numpy as np

from tb.common import readout
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import cases
from tb.common.framing import check_outputs
from tb.common.network import recorded_frames
from tb.common.properties import Property
from tb.common.stimulus import resets_before
from tb.common.watch import sent
from tb.sensing.spi_converter import PINS, Timeline, Voltages, check_error, listen, random_voltages
from tb.sensing.tb_converter_reader import turns, verdict_clock

CASES = cases("converters", "winner-converter")

CLOCKS = 1_500
WATCH = [*PINS, "converter_error", "out_valid", "out_data", "out_last"]


def scans_that_fit(bench):
    return bench.twin.past + max(4, CLOCKS // bench.twin.interval)


async def check(bench, frames, column, fault=lambda number: None):
    """Play voltages, one frame in each scan, and return the recording and the sent frames."""
    twin, shown = bench.twin, bench.twin.readout
    reader = twin.converter_reader
    given = Voltages(reader, frames)
    watch = WATCH + readout.ports(shown)
    recording, transfers = await listen(bench, reader, column, watch, given.convert, fault)
    timeline = Timeline(reader, recording)
    right = timeline.right.all(axis=1)
    read = timeline.read[right]
    seen = given.given(transfers, read)
    check_outputs(bench, recording, (twin, timeline.starts[right], read[:, -1, -1], seen))
    check_error(bench, reader, recording, timeline)
    readout.check_shown(bench, recording, shown)
    return recording, seen


def column_for(bench, scans):
    """Columns for so many scans, and for the outputs of the last of them."""
    twin = bench.twin
    return np.zeros(
        scans * twin.interval + twin.output_clocks[-1] + twin.outputs + 5, dtype=np.int64
    )


@cocotb.test()
async def recorded(dut):
    """Play recorded frames and count the clocks of a frame."""
    bench = Bench(dut)
    frames, past = recorded_frames(bench)[: scans_that_fit(bench)], bench.twin.past
    recording, seen = await check(bench, frames, column_for(bench, len(frames)))
    # The clocks at the end may hold another scan.
    bench.compare("frames", seen[: len(frames)], frames)
    first = RESET_CLOCKS + past * bench.twin.interval
    ends = recording.rows("out_last")
    bench.measured(recording, len(frames), first, ends[0], ends)
    bench.finish(at_least=(len(frames) - past) * bench.twin.outputs)


@cocotb.test()
async def random_faults_and_resets(dut):
    """Play random voltages with a wrong transfer in a third of the scans, then with resets."""
    bench = Bench(dut)
    twin, scans = bench.twin, scans_that_fit(bench)
    frames, faults = random_voltages(bench, scans)
    column = column_for(bench, scans)
    await check(bench, frames, column, faults.get)
    # A complete scan follows the last reset.
    tail = twin.interval + twin.output_clocks[-1] + twin.outputs + 5
    await check(bench, frames, resets_before(bench.rng, len(column), 3 * twin.interval, tail))
    bench.finish(at_least=twin.outputs)


def properties(twin):
    """Proved properties: its frames are those that its network takes."""
    reader, network = twin.converter_reader, twin.readout.network
    at = "u_converter_reader_0."
    slots, scan, verdict = reader.slots, reader.scan_clocks, verdict_clock(reader)
    # The clock of a scan behind the one in which its last transfer is judged.
    begin = (reader.inputs - 1) * reader.slot_clocks + verdict + 1
    judged, states, spacing = sent(network, f"u_readout_0.u_{network.entity}_0")
    return [
        Property(
            name="right frames",
            sentence=f"Its network never sees a wrong frame: all frames have {slots} samples, one "
            "per clock, and come far enough apart, whatever the converter sends and from every "
            "reset on.",
            states=states,
            assumes={
                f"A scan takes {scan} clocks, and its transfers end in the clocks that are proved "
                "of converter_reader.": (
                    f"any_clock < {scan} && {at}done == (sensor && into == {verdict}) "
                    f"&& (!{at}done || {at}slot == turn_of_scan)"
                )
            },
            # A reset may come in any clock of a scan, so what is reached is reached soon.
            watch=f"""
                (* anyseq *) reg [31:0] any_clock;
                {turns(reader, "any_clock")}
                // Clocks since the last transfer of the scan was judged.
                wire [31:0] since = clock_of_scan >= {begin} ? clock_of_scan - {begin}
                    : clock_of_scan + {scan - begin};
                // Clocks since a frame has ended, if the scan before gave one.
                wire [31:0] ended = since > {slots} ? since - {slots} : since + {scan - slots};
            """
            + judged,
            helps=(
                f"clock_of_scan < {scan}",
                f"!{at}sending || (since < {slots} && {at}place == since)",
                f"!valid || (since >= 1 && since <= {slots})",
                f"last == (valid && since == {slots})",
                f"since < 1 || since >= {slots} || {at}sending == valid",
                "sent_place == (valid ? since - 1 : 0) && !sent_skipping",
                f"sent_closed == 0 || sent_closed + ended == {spacing}",
            ),
            free=(f"{at}done", f"{at}slot", f"{at}wrong"),
            reached=("last",),
            refuted_by=(
                (r"place == 3\)", "place == 2)"),
                (r"out_last <= closing", "out_last <= sending"),
                (r"\.in_last\(last\)", ".in_last(valid)"),
                (r"sending <= 0;", ""),
            ),
            clocks=slots + 6,
        )
    ]
