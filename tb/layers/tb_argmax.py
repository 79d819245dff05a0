"""argmax against its twin: random outputs, close to each other and far apart.

Frames come back to back, with gaps and resets, and with fewer outputs. Of a frame of one output or
of too many, index and margin have no meaning.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.properties import Property
from tb.common.stimulus import random_resets, spread

CASES = cases("winners")

FRAMES = 400


def frames_of(bench):
    """Random frames, with ends of the range, and with outputs as far apart as any power of two."""
    twin, rng = bench.twin, bench.rng
    low, high = twin.fmt.low, twin.fmt.high
    wide = rng.integers(low, high + 1, (FRAMES, twin.outputs))
    wide = np.where(rng.random(wide.shape) < 1 / 8, rng.choice([low, high], wide.shape), wide)
    # Ties and neighbours, and differences in which each bit decides.
    apart = 1 << rng.integers(0, twin.fmt.width, (2 * FRAMES, 1))
    near = rng.integers(low, high + 1, (2 * FRAMES, 1)) + apart * rng.integers(
        -1, 2, (2 * FRAMES, twin.outputs)
    )
    near += rng.integers(-1, 2, near.shape) * (rng.random(near.shape) < 1 / 3)
    frames = np.concatenate([wide, np.clip(near, low, high)])
    return rng.permutation(frames)


async def check(bench, frames, gap, resets=False):
    """Play frames of any lengths, and compare with what the twin finds in the recorded ones."""
    twin = bench.twin
    last = np.concatenate([np.arange(len(frame)) == len(frame) - 1 for frame in frames])
    items = {"in_data": np.concatenate(frames), "in_last": last.astype(np.int64)}
    drive = spread(bench.rng, items, "in_valid", gap, tail=4)
    if resets:
        drive["rst"] = random_resets(bench.rng, len(drive["in_valid"]), every=8 * twin.outputs)
    recording = await bench.play(drive, ["out_valid", "out_index", "out_margin"])

    rows = np.setdiff1d(recording.rows("in_valid"), recording.resets())
    codes = recording.signed("in_data", rows)
    closes = np.isin(rows, recording.rows("in_last"))
    begun = np.searchsorted(recording.resets(), rows)
    place, start, ended = np.zeros(len(rows), dtype=np.int64), 0, []
    for k in range(len(rows)):
        if k and begun[k] != begun[k - 1]:
            start = k
        place[k] = k - start
        if closes[k]:
            ended.append((start, k + 1))
            start = k + 1
    bench.visit("outputs of the frame so far", np.minimum(place, twin.outputs - 1))
    due = rows[[stop - 1 for _, stop in ended]] + bench.latency
    bench.compare("clocks of out_valid", recording.rows("out_valid"), due)

    known = [2 <= stop - first <= twin.outputs for first, stop in ended]
    seen = [codes[first:stop] for (first, stop), meant in zip(ended, known, strict=True) if meant]
    expected = np.array([twin.process(frame) for frame in seen])
    at = due[np.array(known)]
    names = [str(frame.tolist()) for frame in seen]
    for n, port in enumerate(("out_index", "out_margin")):
        bench.compare(port, recording.unsigned(port, at), expected[:, n], clock=at, frame=names)
    for frame in seen:
        for quantity, values in twin.quantities(frame).items():
            bench.meet(quantity, values)


@cocotb.test()
async def back_to_back(dut):
    bench = Bench(dut)
    await check(bench, [*frames_of(bench)], gap=0.0)
    bench.finish(at_least=3 * FRAMES)


@cocotb.test()
async def gaps(dut):
    bench = Bench(dut)
    await check(bench, [*frames_of(bench)[:FRAMES]], gap=0.4)
    bench.finish(at_least=2 * FRAMES)


@cocotb.test()
async def other_lengths(dut):
    """Play frames of every length from one output to more than the network has."""
    bench = Bench(dut)
    outputs, rng = bench.twin.outputs, bench.rng
    kinds = frames_of(bench)
    longest = np.concatenate([kinds, rng.permutation(kinds)], axis=1)
    lengths = rng.integers(1, 2 * outputs + 1, len(longest))
    frames = [frame[:length] for frame, length in zip(longest, lengths, strict=True)]
    await check(bench, frames, gap=0.1)
    bench.finish(at_least=FRAMES)


@cocotb.test()
async def resets(dut):
    bench = Bench(dut)
    await check(bench, [*frames_of(bench)], gap=0.2, resets=True)
    bench.finish(at_least=FRAMES)


def properties(twin):
    outputs, width = twin.outputs, twin.fmt.width
    most = outputs - 1
    return [
        Property(
            name="winner",
            sentence="out_valid is high one clock after each in_last that comes with in_valid and "
            f"without rst, and at no other time. After a frame of 2 to {outputs} outputs out_index "
            "is then the number of its largest output, the first of equal ones, and out_margin the "
            "difference between this output and the largest of the others.",
            states=(
                "out_valid == was_last",
                f"!(out_valid && seen >= 2 && seen <= {outputs}) || out_index == at",
                f"!(out_valid && seen >= 2 && seen <= {outputs}) || out_margin == lead",
            ),
            watch=f"""
                // Outputs of this frame so far, and those of which the registers below know.
                reg [15:0] place = 0, seen = 0, at = 0;
                reg signed [{width - 1}:0] top, second;
                wire [{width}:0] lead = top - second;
                reg was_last = 0;
                always @(posedge clk) was_last <= !rst && in_valid && in_last;
                always @(posedge clk) begin
                    if (after_reset && in_valid) begin
                        place <= in_last ? 0 : place == 99 ? 99 : place + 1;
                        seen <= place + 1;
                        if (place == 0 || in_data > top) begin
                            top <= in_data;
                            second <= top;
                            at <= place;
                        end else if (place == 1 || in_data > second) second <= in_data;
                    end
                    if (rst) place <= 0;
                end
            """,
            helps=(
                "place <= 99",
                f"count == (place > {most} ? {most} : place)",
                "place == 0 || place == seen || (place == 99 && seen == 100)",
                "seen == 0 || largest == top",
                f"seen == 0 || out_index == (at > {most} ? {most} : at)",
                "seen == 0 || at < seen",
                "seen < 2 || second <= top",
                f"seen == 0 || out_margin == (seen == 1 ? {(1 << width) - 1} : lead)",
            ),
            reached=(f"out_valid && seen == {outputs} && out_index == {most}",),
            refuted_by=(
                (r"low < margin", "low > margin"),
                (r"first \|\| leads\)\)", "leads))"),
                (r"out_index <= count", "out_index <= count + 1"),
                (rf"margin <= {(1 << width) - 1}", f"margin <= {(1 << width) - 2}"),
                (r"folded = \(~low\)", "folded = low"),
                (r"in_valid && in_last", "in_last"),
                (r"rst == 1", "0"),
            ),
            clocks=outputs + 4,
        )
    ]
