"""axis_network, a network behind AXI4-Stream, against its twin.

Sweeps: all recorded frames of the scene; corner frames (rails, alternating rails, zeros, one sensor
at a rail); random frames with random bits above the sample; frames that are too short or too long
among good frames.
Drives: elements as fast as the block takes them; with random pauses on either side and on both;
with the output blocked until nothing more enters; with random resets; and from the AXI4-Stream
source to the sink of cocotbext-axi, which pause at random.
Checks: every transfer, its ``tlast``, the winner with it and ``frame_error`` bit for bit; that no
frame is lost or mixed with another; that an offered result stays until it is taken. The bench also
measures the clocks of a frame.
Does not prove: anything about the network inside, which has a bench of its own.
"""

from dataclasses import replace

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, Timer, with_timeout
from cocotbext.axi import AxiStreamBus, AxiStreamFrame, AxiStreamSink, AxiStreamSource

from golden.networks.axis_network import TDATA
from golden.numbers.precision import SIGNAL
from golden.trained.window import Window
from tb.common.bench import Bench
from tb.common.case_library import CASCADES, SLOW, SLOWER
from tb.common.cases import Case
from tb.common.framing import random_lengths
from tb.common.handshake import check_kept, exchange, transfers
from tb.common.network import recorded_frames
from tb.common.stimulus import corner_frames, random_resets

AXIS = Case([(2, 3, 5)], "exact", interface="axi_stream")
CASES = {
    "axis-chain": replace(CASCADES["chain"], interface="axi_stream"),
    "axis": AXIS,
    "least-axis": replace(AXIS, shapes=[(1, 2, 1)], precision="thesis"),
    "axis-cascade": replace(AXIS, shapes=[(2, 3, 1), (3, 2, 1), (4, 2, 1)], arrangement="cascade"),
    "slow-axis-cascade": replace(SLOW, interface="axi_stream", options=SLOWER),
    "axis-engine": replace(AXIS, shapes=[(2, 3, 3)], design="engine", activation="precise"),
    "axis-past": replace(
        AXIS,
        shapes=[(4, 2, 2)],
        design="engine",
        activation="precise",
        window=Window(((0, 1, 3), (0,))),
    ),
    # Frames that follow each other closely.
    "winner-axis": replace(AXIS, hardware="argmax = true", spread=4.0),
    "axis-multiple": replace(AXIS, shapes=[(2, 2, 1), (2, 4, 1)], arrangement="multiple"),
}
# The largest output has memories of its own.
ALSO = ("winner-axis",)


async def check(bench, data, last, offer=1.0, take=1.0, blocked=0, resets=0):
    """Play elements, and compare with what the twin computes from the recorded transfers.

    ``offer`` and ``take`` are the probabilities that an element is offered or taken in a clock. In
    the first ``blocked`` clocks nothing is taken. ``resets`` is the number of clocks between
    resets, or 0 for none.
    """
    twin, rng = bench.twin, bench.rng
    # The memory holds the frames of a latency and one more, and one output leaves per clock.
    under_way = (twin.output_clocks[-1] + 1) // twin.interval + 1
    tail = 2 * twin.output_clocks[-1] + under_way * twin.outputs + 8
    frames = np.count_nonzero(last) + 1
    clocks = blocked + int(
        len(data) / offer + frames * (twin.interval + twin.slots) + frames * twin.outputs / take
    )
    taken = np.concatenate([rng.random(clocks) < take, np.ones(tail, dtype=bool)])
    taken[:blocked] = False
    cleared = random_resets(rng, len(taken), resets) if resets else np.zeros(len(taken), dtype=int)
    if resets:
        cleared[-tail:] = 0
    recording = await exchange(
        bench, data, last, rng.random(len(taken)) < offer, taken, cleared.astype(bool)
    )
    entered, left = transfers(recording, "s"), transfers(recording, "m")
    entered = np.setdiff1d(entered, recording.resets())
    ends = np.append(recording.resets(), recording.clocks)
    # An output in the clock of a reset belongs to the time before the reset.
    epochs = np.searchsorted(ends, entered), np.searchsorted(ends, left)
    errors = []
    for epoch in np.unique(np.concatenate(epochs)):
        rows, out = entered[epochs[0] == epoch], left[epochs[1] == epoch]
        ended = np.isin(rows, recording.rows("s_axis_tlast"))
        values = recording.signed("s_axis_tdata", rows)
        results, closes, _ = twin.process_stream(values, ended)
        if epoch < len(ends) - 1:
            results, closes = results[: len(out)], closes[: len(out)]
        bench.compare("m_axis_tdata", recording.signed("m_axis_tdata", out), results)
        if twin.decides:
            frames = results[: len(results) // twin.outputs * twin.outputs]
            closing = out[: len(frames)][twin.outputs - 1 :: twin.outputs]
            told = recording.unsigned("m_axis_tuser", closing)
            bench.compare("m_axis_tuser", told, twin.winners(frames.reshape(-1, twin.outputs)))
        bench.compare("m_axis_tlast", np.isin(out, recording.rows("m_axis_tlast")), closes)
        errors += list(rows[twin.input_controller.process(ended, rows).error] + 1)
    bench.compare("clocks of frame_error", recording.rows("frame_error"), np.array(errors))
    check_kept(bench, recording)
    if not resets:
        assert len(entered) == len(data), f"{len(entered)} of {len(data)} elements were taken"
    return recording, entered, left


def whole(frames):
    """The elements and ``last`` flags of good frames."""
    last = np.zeros(frames.shape, dtype=np.int64)
    last[:, -1] = 1
    return frames.ravel(), last.ravel()


def random_data(bench, count):
    """Random codes, of which one in eight is an end of the range."""
    codes = bench.rng.integers(TDATA.low, TDATA.high + 1, count)
    ends = bench.rng.choice([TDATA.low, TDATA.high], count)
    return np.where(bench.rng.random(count) < 1 / 8, ends, codes)


def random_frames(bench, count):
    return random_data(bench, count * bench.twin.inputs).reshape(count, -1)


@cocotb.test()
async def recorded(dut):
    """Play all recorded frames as fast as possible, then with pauses, and count the clocks."""
    bench = Bench(dut)
    codes, past = recorded_frames(bench), bench.twin.past
    recording, entered, left = await check(bench, *whole(codes))
    inputs, outputs = bench.twin.inputs, bench.twin.outputs
    last_in, first_out = entered[inputs - 1 :: inputs], left[::outputs]
    # The first frames use up the credit of the memory. Later frames show the sustained rate.
    bench.facts = {
        "frames": len(codes),
        "seconds": recording.seconds,
        "clocks_per_frame": int(left[outputs - 1] - last_in[past] + inputs),
        "interval": int(np.diff(last_in).max()),
    }
    assert first_out[0] - last_in[past] == bench.latency, "not the published latency"
    assert bench.facts["interval"] == bench.twin.interval, "slower than the network"
    await check(bench, *whole(codes), offer=0.6, take=0.6)
    bench.finish(at_least=2 * (len(codes) - past) * outputs)


@cocotb.test()
async def corners_and_random(dut):
    """Play corner frames and random frames, with pauses on either side and on both."""
    bench = Bench(dut)
    corners = corner_frames(SIGNAL, bench.twin.inputs)
    frames = np.concatenate([corners, random_frames(bench, 40)])
    for offer, take in ((1.0, 0.5), (0.5, 1.0), (0.5, 0.5), (1.0, 0.1)):
        await check(bench, *whole(frames), offer, take)
    bench.finish(at_least=4 * (len(frames) - bench.twin.past) * bench.twin.outputs)


@cocotb.test()
async def blocked(dut):
    """Take nothing until no more elements enter, and then check that no frame is lost."""
    bench = Bench(dut)
    # More frames than fit: each takes an interval, and as many are under way as that allows.
    count = 2 * (bench.twin.output_clocks[-1] + 1) // bench.twin.interval + 4
    count += bench.twin.past
    clocks = 2 * count * (bench.twin.interval + bench.twin.inputs)
    frames = random_frames(bench, count)
    _, entered, _ = await check(bench, *whole(frames), blocked=clocks)
    early = np.count_nonzero(entered < clocks)
    assert early < len(entered), "the memory was never full"
    assert early >= bench.twin.inputs, "no frame entered"
    bench.finish(at_least=(count - bench.twin.past) * bench.twin.outputs)


@cocotb.test()
async def wrong_lengths(dut):
    """Play frames that are too short or too long among good frames."""
    bench = Bench(dut)
    for offer, take in ((1.0, 1.0), (0.6, 0.4)):
        last = random_lengths(bench.rng, bench.twin.inputs, 300)
        await check(bench, random_data(bench, len(last)), last, offer, take)
    bench.finish(at_least=20)


@cocotb.test()
async def resets(dut):
    """Play frames of all lengths with resets at random clocks."""
    bench = Bench(dut)
    last = random_lengths(bench.rng, bench.twin.inputs, 600)
    every = 2 * (bench.twin.inputs + bench.twin.output_clocks[-1])
    await check(bench, random_data(bench, len(last)), last, 0.8, 0.7, resets=every)
    bench.finish(at_least=10)


def pauses(rng, probability):
    """An endless sequence that says, for each clock, whether to pause."""
    while True:
        yield from [bool(rng.random() < probability)] * int(rng.integers(1, 9))


@cocotb.test()
async def axi_models(dut):
    """Play frames from the source to the sink of cocotbext-axi, which pause at random."""
    bench = Bench(dut)
    dut.clk.value = 0
    dut.rst.value = 1
    await Timer(1, "ns")
    Clock(dut.clk, 10, unit="ns").start(start_high=False)
    # There is one byte lane, so that each element of a frame is one code.
    ends = [
        model(AxiStreamBus.from_prefix(dut, prefix), dut.clk, byte_lanes=1)
        for model, prefix in ((AxiStreamSource, "s_axis"), (AxiStreamSink, "m_axis"))
    ]
    source, sink = ends
    await ClockCycles(dut.clk, 3)
    dut.rst.value = 0
    played, came = [np.zeros(0, dtype=np.int64)] * 2, 0
    for idle, blocked in ((0.0, 0.0), (0.5, 0.0), (0.0, 0.5), (0.5, 0.5), (0.1, 0.9)):
        for end, probability in zip(ends, (idle, blocked), strict=True):
            end.set_pause_generator(pauses(bench.rng, probability))
        last = random_lengths(bench.rng, bench.twin.inputs, 200)
        data = random_data(bench, len(last))
        frames = np.split(data, np.flatnonzero(last)[:-1] + 1)
        for frame in frames:
            source.send_nowait(AxiStreamFrame([int(code) for code in frame]))
        # There is no reset between the parts, so the frames of one are the past of the next.
        played = [np.concatenate(both) for both in zip(played, (data, last), strict=True)]
        results, _, _ = bench.twin.process_stream(*played)
        for expected in results.reshape(-1, bench.twin.outputs)[came:]:
            got = await with_timeout(sink.recv(), 100, "us")
            codes = np.array(got.tdata)
            bench.compare("frame", codes - ((codes >> 15) << 16), expected)
            if bench.twin.decides:
                # The sink gives one number if it is that of all outputs.
                told = np.atleast_1d(got.tuser)[-1:]
                bench.compare("m_axis_tuser", told, bench.twin.winners(expected[np.newaxis]))
            came += 1
        await with_timeout(source.wait(), 100, "us")
        await ClockCycles(dut.clk, bench.latency + 100)
        assert sink.empty(), "a frame came that nobody sent"
    bench.finish(at_least=50)
