"""load_profile, assembled, against its twin: outputs of recorded frames, extremes, random ones.

Frames come with the last point of the frame before, at random distances with and without resets,
and before a reset at each clock up to the first point. tests/test_visualisation.py bounds how far
the points are from equation 3.18.
"""

from itertools import product

import cocotb
import numpy as np

from golden.visualisation.load_profile import POWER_FRAC
from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.profile import check_profile
from tb.common.properties import Property
from tb.common.stimulus import random_resets, spread

CASES = cases("profiles")
# A shipped scene that the runner gives to the bench.
SCENES = ("digit-single",)

INPUTS = ["in_load", "in_position", "in_width", "in_shape"]
OUTPUTS = ["out_valid", "out_x", "out_y", "out_last"]
# How many frames are played at a time, so that the recording stays small.
CHUNK = 48
# Between these exponents a fiftieth to a four hundredth of the load is left.
FAR, LOST = 4 << POWER_FRAC, 6 << POWER_FRAC


def recorded(bench):
    """The outputs of a network for every third recorded frame. Those between differ little."""
    (digit,) = bench.given.shipped
    return digit.design.process(digit.codes[::3])


def extremes(bench):
    """Every pair of extremes of two results. The other results are a wide load on the ramp."""
    fmt, threshold = bench.twin.fmt, bench.twin.shape_threshold
    positions = bench.twin.ramp.process()
    middle, first, last = (int(positions[n]) for n in (len(positions) // 2, 0, -1))
    before, behind = max(fmt.low, first - 1), min(fmt.high, last + 1)
    values = [
        [fmt.low, -1, 0, 1, fmt.high],
        [fmt.low, before, first, middle, last, behind, fmt.high],
        [fmt.low, -1, 0, 1, 2, 40, fmt.high],
        [fmt.low, threshold, threshold + 1, fmt.high],
    ]
    frames = []
    for first, second in ((0, 2), (1, 2), (1, 3), (2, 3)):
        for pair in product(values[first], values[second]):
            frame = [fmt.high, middle, fmt.high, fmt.low]
            frame[first], frame[second] = pair
            frames.append(frame)
    return np.array(frames, dtype=np.int64)


def one_bit_off(bench):
    """Shapes that differ in one bit from the last rectangle or from the first triangle."""
    twin = bench.twin
    fmt, middle = twin.fmt, int(np.median(twin.ramp.process()))
    borders = np.array([twin.shape_threshold, twin.shape_threshold + 1])
    shapes = (borders[:, np.newaxis] ^ (1 << np.arange(fmt.width - 1))).ravel()
    return np.array([[fmt.high, middle, fmt.high, shape] for shape in shapes], dtype=np.int64)


def far_down(bench, count):
    """Of many large loads, those with the most points at which little of the load is left.

    There a small error of the exponent shows in one point of ten.
    """
    fmt, power_fold = bench.twin.fmt, bench.twin.power_fold
    frames = bench.rng.integers(0, fmt.high + 1, (4096, 4))
    frames[:, 0] = fmt.high
    exponent = np.asarray(power_fold.process(*bench.twin.fall(frames)))
    points = (exponent >= FAR) & (exponent < LOST)
    return frames[np.argsort(-points.sum(axis=-1), kind="stable")[:count]]


def random_frames(bench, count):
    fmt = bench.twin.fmt
    frames = bench.rng.integers(fmt.low, fmt.high + 1, (count, 4))
    # Half of the loads lie within the ramp and have a visible width.
    frames[::2, 1:3] = bench.rng.integers(0, fmt.high + 1, (len(frames[::2]), 2))
    return frames


async def check(bench, frames, pause, resets=None):
    """Play frames with ``pause`` idle clocks before each, and return the numbers of those drawn.

    ``resets`` holds the clocks of resets, or the average number of clocks between random resets.
    """
    items = dict(zip(INPUTS, frames.T, strict=True))
    ramp = bench.twin.interval
    drive = spread(bench.rng, items, "in_valid", 0.0, tail=2 * ramp + 4, pause=pause)
    if isinstance(resets, np.ndarray):
        drive["rst"] = np.zeros(len(drive["in_valid"]), dtype=np.int64)
        drive["rst"][resets] = 1
    elif resets:
        drive["rst"] = random_resets(bench.rng, len(drive["in_valid"]), resets)
    recording = await bench.play(drive, OUTPUTS)
    entered = recording.rows("in_valid")
    seen = np.stack([recording.signed(name, entered) for name in INPUTS], axis=-1)
    drawn = check_profile(bench, recording, "out", entered, seen, bench.latency, bench.twin.process)
    for name, codes in zip(("load", "position", "width", "shape"), seen[drawn].T, strict=True):
        bench.meet(name, codes)
    # The points of a frame come in their order.
    index = np.arange(len(drawn))
    opens = np.diff(drawn, prepend=-1) != 0
    bench.visit("point", index - np.maximum.accumulate(np.where(opens, index, 0)))
    return drawn


async def check_each(bench, frames):
    """Play frames so that the next comes with the last point, and check that each is drawn."""
    ramp = bench.twin.interval
    for start in range(0, len(frames), CHUNK):
        part = frames[start : start + CHUNK]
        drawn = await check(bench, part, pause=ramp - 1)
        assert set(drawn) == set(range(len(part))), "a frame was not drawn"
    bench.finish(at_least=len(frames) * bench.twin.ramp.points)


@cocotb.test()
async def recorded_frames(dut):
    bench = Bench(dut)
    await check_each(bench, recorded(bench))


@cocotb.test()
async def extremes_and_random(dut):
    bench = Bench(dut)
    frames = [extremes(bench), one_bit_off(bench), far_down(bench, 24), random_frames(bench, 20)]
    await check_each(bench, np.concatenate(frames))


@cocotb.test()
async def during_a_ramp(dut):
    """Play frames at all distances, so that sometimes several come during a ramp."""
    bench = Bench(dut)
    ramp = bench.twin.interval
    frames = random_frames(bench, 30)
    pause = bench.rng.integers(0, ramp, len(frames))
    pause[::5] = 0
    drawn = await check(bench, frames, pause)
    assert len(set(drawn)) < len(frames), "no frame came too early"
    # These come around the last point of a ramp after which no result waits.
    for late in range(-3, 4):
        await check(bench, frames[:3], np.array([0, ramp - 1 + late, 2 * ramp]))
    bench.finish(at_least=10 * bench.twin.ramp.points)


@cocotb.test()
async def resets(dut):
    bench = Bench(dut)
    ramp = bench.twin.interval
    frames = random_frames(bench, 30)
    for every in (ramp, ramp // 5):
        await check(bench, frames, bench.rng.integers(0, ramp, len(frames)), resets=every)
    # The frames are so far apart that a remainder of an earlier frame would show before the next.
    at = np.arange(bench.latency + 3)
    apart = 3 * bench.latency
    await check(
        bench, random_frames(bench, len(at)), pause=apart - 1, resets=apart * (at + 1) - 1 + at
    )
    bench.finish(at_least=10 * bench.twin.ramp.points)


# For each result, the register that holds it while it is drawn.
DRAWN = {"load": "load", "position": "centre", "width": "width", "shape": "shape"}


def properties(twin):
    bits = twin.fmt.width
    newest = "\n".join(f"reg [{bits - 1}:0] newest_{n}, shown_{n};" for n in DRAWN)
    taken = "\n".join(f"if (in_valid) newest_{n} <= in_{n};" for n in DRAWN)
    shown = "\n".join(f"if (begins) shown_{n} <= newest_{n};" for n in DRAWN)
    return [
        Property(
            name="newest frame",
            sentence="A ramp begins with the newest results that came since the ramp before it "
            "began, as soon as that one has given its last point. It keeps these results to its "
            "end, whatever comes meanwhile. A reset ends it.",
            states=(
                "restart == begins",
                *(f"!drawing || {place} == shown_{n}" for n, place in DRAWN.items()),
            ),
            watch=f"""
                reg came = 0, drawing = 0, known = 0;
                wire begins = came && !drawing;
                {newest}
                always @(posedge clk) begin
                    came <= in_valid || came && !begins;
                    drawing <= begins || drawing && !(out_valid && out_last);
                    known <= known || in_valid;
                    {taken}
                    {shown}
                    if (rst) begin
                        came <= 0;
                        drawing <= 0;
                    end
                end
            """,
            helps=(
                "waiting == came && busy == drawing",
                "!came || known",
                *(f"!known || results0_{n}_held == newest_{n}" for n in DRAWN),
            ),
            free=("point_valid", "point_last"),
            reached=("drawing && came", "begins && in_valid"),
            refuted_by=(
                (r"waiting && \(!busy\)", "waiting"),
                (r"\(point_valid && point_last\)", "point_valid"),
                (r"waiting <= 1'b0", "waiting <= 1'b1"),
                (r"centre <= results0_position_held", "centre <= in_position"),
                (r"busy <= 0;", ""),
            ),
            clocks=6,
        )
    ]


def exp_memory(twin):
    lines = "\n".join(f"{n}: twin = {twin.width}'d{word};" for n, word in enumerate(twin.words))
    return [
        Property(
            name="words",
            sentence=f"Each of the {1 << twin.addr_width} addresses gives the twin's word, 1 clock "
            "later.",
            states=("!after_reset || word == twin(asked)",),
            # Behind the last word it is the last word.
            watch=f"""
                function [{twin.width - 1}:0] twin(input [31:0] n);
                    case (n)
                        {lines}
                        default: twin = {twin.width}'d{twin.words[-1]};
                    endcase
                endfunction
                reg [{twin.addr_width - 1}:0] asked;
                always @(posedge clk) asked <= addr;
            """,
            reached=(f"after_reset && asked == {len(twin.words) - 1}",),
            refuted_by=((r"0: word <= ", "0: word <= 1 + "),),
            clocks=3,
            induction=2,
            whole=True,
        )
    ]


OF_PARTS = {"exp_memory": exp_memory}
