"""readout against its twin: the stream of the network, and what is held, decided and drawn.

Sweeps: all recorded frames, corner frames, frames that drive every hidden sum to both of its ends,
and random frames. For the held outputs, the winner and the profile there are recorded and random
frames, and of many random frames those with the greatest and the least height.
Drives: frames as close as the network takes them, with gaps, of wrong lengths, and with resets. For
the profile they come at all distances, so that many results come while a ramp is being drawn. If
the engine inside can be reloaded, its image comes first and after each reset, and a wrong image
comes between good ones. One that learns gets known outputs of the wrong length and, in a test of
its own, what tb_learning_engine shows.
Checks: outputs, ``frame_error``, held outputs, index and margin of the winner, and every point of
the profile bit for bit and in their clocks.
Does not prove: the extremes of the profile; and, if the network needs about as long for a frame as
the profile for a ramp, that the latest of two results during a ramp is drawn (tb_load_profile
drives the block by itself).
"""

import cocotb
import numpy as np

from tb.common import readout
from tb.common.bench import Bench, test_of
from tb.common.case_library import OTHER_PROFILES, READ_WINNERS, UART_INSTRUMENTS
from tb.common.lessons import Player, refusals, traffic
from tb.common.loading import Sent, after_loading, check_loading, exchange, loaded, untaught
from tb.common.network import (
    WATCH,
    corners_and_random,
    random_elements,
    recorded,
    recorded_frames,
    reset_at_every_clock,
    resets_in_mid_frame,
    whole_frames,
    wrong_lengths,
)
from tb.common.stimulus import random_resets, spread

LOADED = {name: UART_INSTRUMENTS[name] for name in ("reload-uart", "learn-uart")}
CASES = OTHER_PROFILES | LOADED | READ_WINNERS
# It has the ports of the largest output too.
ALSO = ("winner",)

__all__ = [
    "corners_and_random",
    "recorded",
    "reset_at_every_clock",
    "resets_in_mid_frame",
    "wrong_lengths",
]


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
    readout.check_values(bench, recording, twin)
    if twin.load_profile:
        drawn = readout.check_drawn(bench, recording, twin)
        if overtaken and not resets:
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
    """Load a wrong image between good ones, through the ports of the engine inside."""
    bench = Bench(dut)
    whole = bench.twin
    bench.twin = whole.core
    image = whole.image
    wrong = bytes([*image[:-1], image[-1] ^ 1])
    count = 24
    elements, last = whole_frames(
        bench, random_elements(bench, count * whole.inputs).reshape(count, -1)
    )
    pause = np.zeros((count, len(elements) // count), dtype=np.int64)
    pause[:, 0] = whole.interval + 4 * len(image) // count
    items = {"in_data": elements, "in_last": last}
    drive = spread(bench.rng, items, "in_valid", 0.0, tail=whole.interval, pause=pause.ravel())
    sent = [Sent(0, image), Sent(2 * len(image), wrong), Sent(3 * len(image), image)]
    counts = check_loading(bench, await exchange(bench, drive, sent))
    assert len(counts) == 2
    assert all(counts), f"frames of each good image: got {counts}, expected some of each"
    bench.twin = whole
    bench.finish(at_least=5 * whole.outputs)


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
