"""readout against its twin: the stream of the network, and what is held, decided and drawn.

Besides the tests of tb/common/network.py, frames come at all distances, so that many results come
while a ramp is drawn. An image comes first and after each reset, and a wrong one between good ones;
an engine that learns gets what tb_learning_engine shows.
"""

import cocotb
import numpy as np

from golden.numbers.precision import SIGNAL
from tb.common import readout
from tb.common.bench import Bench, test_of
from tb.common.case_library import cases
from tb.common.lessons import Player, refusals, traffic
from tb.common.loading import after_loading, check_images, loaded, untaught
from tb.common.network import TESTS, WATCH, random_elements, recorded_frames, whole_frames
from tb.common.properties import Property
from tb.common.stimulus import random_resets, spread

CASES = cases("profiles", "reload-uart", "learn-uart", "winner", "read-winners")
# It has the ports of the largest output too.
ALSO = ("winner",)

recorded, corners_and_random, wrong_lengths, resets_in_mid_frame, reset_at_every_clock = TESTS


async def check(bench, frames, resets=None):
    twin = bench.twin
    drawing = 0
    if twin.load_profile:
        drawing = twin.load_profile.interval
    elements, last = whole_frames(bench, frames)
    length = len(elements) // len(frames)
    pause = np.zeros((len(frames), length), dtype=np.int64)
    # Many frames come during a ramp, others when no ramp is drawn.
    longest = max(twin.interval + 1, drawing * 4 // 3)
    pause[:, 0] = bench.rng.integers(twin.interval, longest, len(frames))
    shortest = twin.interval + length
    # At the shortest distance of frames, the ramps fall behind the results a little more each time.
    # A result is skipped once the delay adds up to a ramp. Behind a slower network none is skipped.
    overtaken = len(frames) * (drawing - shortest) > 2 * drawing
    if overtaken and 2 * shortest >= drawing:
        # Too few random distances would be short enough.
        pause[:, 0] = twin.interval
    items = {"in_data": elements, "in_last": last}
    tail = twin.output_clocks[-1] + 2 * drawing + 9
    drive = spread(bench.rng, items, "in_valid", 0.0, tail=tail, pause=pause.ravel())
    if resets:
        drive["rst"] = random_resets(bench.rng, len(drive["in_valid"]), resets)
    drive = untaught(bench, drive)
    if twin.image:
        drive = after_loading(drive, twin.image)
    recording = await bench.play(drive, WATCH + readout.ports(twin))
    drawn = readout.check_shown(bench, recording, twin)
    if twin.load_profile and overtaken and not resets:
        assert len(set(drawn)) < len(frames), "no results came during a ramp"


def compared(twin):
    """How many results of a frame are compared: each held output twice, and the winner's three."""
    return 2 * twin.outputs * twin.holds + 3 * twin.decides


@cocotb.test()
async def shown(dut):
    """Play frames and compare held outputs, winners and profiles."""
    bench = Bench(dut)
    random = random_elements(bench, 16 * bench.twin.inputs).reshape(16, -1)
    frames = [recorded_frames(bench)[: bench.twin.past + 16], random]
    if bench.twin.load_profile:
        frames.append(readout.extremes(bench, bench.twin, times=4))
    played = np.concatenate(frames)
    await check(bench, played)
    bench.finish(at_least=(len(played) - bench.twin.past) * compared(bench.twin))


@cocotb.test()
async def shown_and_resets(dut):
    bench = Bench(dut)
    twin = bench.twin
    # Some frames of a slow network, or of one with a long past, end between resets, too.
    frames = random_elements(bench, (24 + 8 * twin.past) * twin.inputs).reshape(-1, twin.inputs)
    await check(bench, frames, resets=max(1000, (3 + 2 * twin.past) * twin.interval))
    bench.finish(at_least=3 * compared(bench.twin))


@test_of(loaded)
async def images(dut):
    """Load good and wrong images, through the ports of the engine inside."""
    bench = Bench(dut)
    bench.twin = bench.twin.core
    await check_images(bench, bench.twin.image, bench.twin.image)
    bench.finish(at_least=100)


@test_of(lambda t: bool(t.core.lesson_ports))
async def lessons(dut):
    """Show placements and learn from them, through the ports of the engine inside."""
    bench = Bench(dut)
    bench.twin = bench.twin.core
    player = Player(bench)
    refusals(player)
    traffic(player, 50)
    met = "frames refused", "targets refused", "placements", "steps taken", "steps refused"
    await player.check(*met, at_least=20)


def properties(twin):
    if not twin.holds:
        return []
    outputs, width = twin.outputs, SIGNAL.width
    stream = ("result_valid", "result", "result_last")
    words = "\n".join(
        f"""
            reg known_{n} = 0;
            reg [{width - 1}:0] newest_{n};
            always @(posedge clk) if (after_reset && result_valid && place == {n}) begin
                known_{n} <= 1;
                newest_{n} <= result;
            end
        """
        for n in range(outputs)
    )
    found = [
        Property(
            name="held outputs",
            sentence="Each output is held from the clock after it left until the next of its kind "
            "has left, whatever the network gives. A reset begins a new frame and changes no held "
            "output.",
            states=tuple(f"!known_{n} || held_{n} == newest_{n}" for n in range(outputs)),
            watch="""
                // Outputs of this frame so far.
                reg [15:0] place = 0;
                always @(posedge clk) begin
                    if (result_valid) place <= result_last ? 0 : place == 99 ? 99 : place + 1;
                    if (rst) place <= 0;
                end
            """
            + words,
            helps=(f"count == (place > {outputs} ? {outputs} : place)", "place <= 99"),
            free=stream,
            reached=tuple(f"known_{n}" for n in (0, outputs - 1)),
            refuted_by=(
                (r"result_valid && \(count == 1\)", "result_valid && (count <= 1)"),
                (r"if \(result_last\)", "if (0)"),
                (r"rst == 1", "0"),
                (r"assign held_0 = words_0", "assign held_0 = words_1"),
                (r"words_2 <= result", "words_2 <= -result"),
            ),
            clocks=outputs + 4,
        )
    ]
    if twin.load_profile is not None:
        names = ("load", "position", "width", "shape")
        drawn = " && ".join(
            f"u_load_profile_0.in_{name} == held_{k}"
            for name, k in zip(names, twin.results, strict=True)
        )
        found.append(
            Property(
                name="drawn frames",
                sentence="The profile takes the held outputs one clock after the last output of a "
                "frame, unless a reset came between, and at no other time.",
                states=("u_load_profile_0.in_valid == was_last", drawn),
                watch="""
                    reg was_last = 0;
                    always @(posedge clk) was_last <= !rst && result_valid && result_last;
                """,
                free=stream,
                reached=("was_last",),
                refuted_by=(
                    (r"\(result_valid && result_last\)", "result_last"),
                    (r"draw0_complete <= 0", "draw0_complete <= result_last"),
                    (r"\.in_load\(words_\d\)", ".in_load(result)"),
                ),
                clocks=4,
            )
        )
    return found
