"""axis_network, a network behind AXI4-Stream, against its twin.

Frames of all lengths come as fast as it takes them, with pauses on either side, with the output
blocked, with resets, and from the source to the sink of cocotbext-axi. Every transfer is compared.
"""

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, Timer, with_timeout
from cocotbext.axi import AxiStreamBus, AxiStreamFrame, AxiStreamSink, AxiStreamSource

from golden.networks.axis_network import TDATA
from golden.numbers.precision import SIGNAL
from tb.common.bench import Bench, Offer
from tb.common.case_library import cases
from tb.common.framing import random_lengths, whole
from tb.common.network import recorded_frames
from tb.common.properties import Property
from tb.common.stimulus import corner_frames, random_resets
from tb.common.watch import ago, frames

CASES = cases("axis")
# The largest output has memories of its own.
ALSO = ("winner-axis",)
# Cases with a least distance of frames, without slots and with them.
PROVED = ("axis", "slow-axis-cascade")


# Where the largest output is told, with the last one of a frame.
TUSER = "m_axis_tuser"


def transfers(recording, side):
    """The rows in which an element is transferred on side ``s`` or ``m``."""
    ready = recording.rows(f"{side}_axis_tready")
    return np.intersect1d(recording.rows(f"{side}_axis_tvalid"), ready)


def check_kept(bench, recording):
    """Check that an offered result stays until it is taken or a reset comes."""
    offered = recording.rows("m_axis_tvalid")
    waits = np.setdiff1d(offered, transfers(recording, "m"))
    waits = np.setdiff1d(waits, recording.resets())
    waits = waits[waits + 1 < recording.clocks]
    bench.compare("m_axis_tvalid kept", np.isin(waits + 1, offered), np.ones(len(waits), bool))
    closing = np.isin(waits, recording.rows("m_axis_tlast"))
    if TUSER in recording.columns:
        rows = waits[closing]
        now, then = (recording.unsigned(TUSER, rows + late) for late in (0, 1))
        bench.compare(f"{TUSER} kept", then, now)
    for port in ("m_axis_tdata", "m_axis_tlast"):
        now, then = recording.unsigned(port, waits), recording.unsigned(port, waits + 1)
        bench.compare(f"{port} kept", then, now)


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
    offered = rng.random(len(taken)) < offer
    told = [TUSER] * twin.decides
    recording = await bench.play(
        {"rst": cleared, "m_axis_tready": taken},
        ["m_axis_tvalid", "m_axis_tdata", "m_axis_tlast", *told, "frame_error"],
        Offer("s_axis_t", {"data": data, "last": last}, lambda clock, _: offered[clock]),
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
            told = recording.unsigned(TUSER, closing)
            bench.compare(TUSER, told, twin.winners(frames.reshape(-1, twin.outputs)))
        bench.compare("m_axis_tlast", np.isin(out, recording.rows("m_axis_tlast")), closes)
        errors += list(rows[twin.input_controller.process(ended, rows).error] + 1)
    bench.compare("clocks of frame_error", recording.rows("frame_error"), np.array(errors))
    check_kept(bench, recording)
    if not resets:
        assert len(entered) == len(data), f"{len(entered)} of {len(data)} elements were taken"
    return recording, entered, left


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


def properties(twin):
    """Whatever either side does, with the network inside cut off.

    Its results may have any value and come in any clock, as long as there are no more results than
    good frames have been sent. This condition is proved of hybrid, in its own cases, but not of
    cascade.
    """
    outputs, slots, inputs = twin.outputs, twin.slots, twin.inputs
    under_way = twin.frames_under_way
    room = under_way * outputs
    cut = ("result_valid", "result", "frame_error")
    # With the largest output, a result comes to the memory one clock after the network gave it.
    comes, value, delayed, most = "result_valid", "result", "", "two"
    if twin.decides:
        comes, value, delayed, most = "stored_valid", "stored_data", " + stored_valid", "three"
    # The first frames only serve later ones as past samples.
    yields, whole = ("yields", " with a whole past") if twin.past else ("done", "")
    # Proved below, as "no word lost".
    leaving = {"Only frames that are under way leave.": "!left || credit0_used != 0"}
    items = [
        Property(
            name="ready",
            sentence="Once s_axis_tready is high it stays so until a sample is taken.",
            states=("!offered || s_axis_tready",),
            assumes=leaving,
            watch="""
                reg offered = 0;
                always @(posedge clk) offered <= !rst && s_axis_tready && !s_axis_tvalid;
            """,
            helps=(f"credit0_used <= {under_way}",),
            free=("left",),
            reached=("offered", "!s_axis_tready"),
            refuted_by=(
                (
                    r"assign s_axis_tready = gate0_ready",
                    "assign s_axis_tready = gate0_ready && m_axis_tready",
                ),
                (r"assign full = .*;", "assign full = left;"),
            ),
        ),
        Property(
            name="no word lost",
            sentence="The outputs leave in the order in which they came from the network, each "
            f"once and no others. Each is offered at most {most} clocks after it came, or as soon "
            f"as those before it have left. m_axis_tlast comes with the last of each {outputs}. "
            f"The memory never holds more than its {room} words, so no result is written over one "
            "that waits. Only frames that are under way leave.",
            states=(
                f"!{comes} || fifo0_stored < {room}",
                "!left || credit0_used != 0",
                "!m_axis_tvalid || waiting != 0",
                "!waits || m_axis_tvalid",
                "!m_axis_tvalid || !tracked || ahead != 0 || m_axis_tdata == {{2{kept[13]}}, kept}",
                f"!m_axis_tvalid || m_axis_tlast == (number == {outputs - 1})",
            ),
            assumes={
                f"The network yields {outputs} outputs for each good frame{whole} sent to it, some "
                "time after it, and no others.": "!result_valid || owed != 0"
            },
            # ``owed`` counts the outputs that are still to come for the frames that the network
            # got. For any one word ``ahead`` counts how many words must leave before it.
            watch=f"""
                reg [15:0] owed = 0;
                (* anyseq *) reg pick;
                reg tracked = 0, waits = 0;
                reg [15:0] waiting = 0, number = 0, ahead = 0;
                reg [13:0] kept;
                wire leaves = m_axis_tvalid && m_axis_tready;
                wire [15:0] home = fifo0_read_addr + ahead - fifo0_full;
                always @(posedge clk) begin
                    owed <= rst ? 0 : owed + ({yields} ? {outputs} : 0) - (result_valid ? 1 : 0);
                    waiting <= waiting + {comes} - leaves;
                    waits <= waiting != leaves;
                    if (leaves) begin
                        number <= number == {outputs - 1} ? 0 : number + 1;
                        ahead <= ahead - 1;
                        if (ahead == 0) tracked <= 0;
                    end
                    if ({comes} && pick && !tracked) begin
                        tracked <= 1;
                        ahead <= waiting - leaves;
                        kept <= {value};
                    end
                    if (rst) begin
                        waiting <= 0;
                        waits <= 0;
                        number <= 0;
                        tracked <= 0;
                    end
                end
            """,
            helps=(
                f"credit0_used <= {under_way}",
                f"place < {outputs}",
                # The outputs of every credit are still to come, in the memory, or fetched.
                f"credit0_used * {outputs} == owed + fifo0_stored + place{delayed}",
                f"fifo0_read_addr < {room} && fifo0_write_addr < {room} && fifo0_stored <= {room}",
                f"fifo0_write_addr + {room} * (fifo0_read_addr + fifo0_stored >= {room}) "
                "== fifo0_read_addr + fifo0_stored",
                "waiting == fifo0_stored + fifo0_full",
                f"number == (!fifo0_full ? place : place == 0 ? {outputs - 1} : place - 1)",
                "!fifo0_full || closing == (place == 0)",
                "!tracked || ahead < waiting",
                "!tracked || (fifo0_full && ahead == 0 ? word "
                f": fifo0_memory[home >= {room} ? home - {room} : home]) == kept",
            ),
            free=cut,
            reached=(
                *("tracked && ahead == 0 && leaves", "tracked && ahead == 1"),
                *("left", "fifo0_stored == 2"),
            ),
            refuted_by=(
                (r"place == \d+\)\);", "place == 0));"),
                (r"if \(\(done && \(!left\)\)\)", "if ((done && (!left) && (!result_valid)))"),
                (r"fifo0_stored - 1", "fifo0_stored"),
                (r"fifo0_write_addr \+ 1", "fifo0_write_addr + 2"),
                (r"memory\[fifo0_write_addr\]", "memory[0]"),
                (r"if \(\(result_valid && \(!fifo0_take\)\)\)", "if (result_valid)"),
                (r"else if \(\(fifo0_take && \(!result_valid\)\)\)", "else if (fifo0_take)"),
                (r"closing <= left", "closing <= (place == 0)"),
            ),
            clocks=24,
        ),
    ]
    inner = twin.network.input_controller
    accepted = "(s_axis_tvalid && s_axis_tready)"
    watch = frames(inputs, 0, accepted, "s_axis_tlast", "asked_")
    watch += frames(inner.inputs, twin.spacing, "valid", "last", "sent_")
    # A network that computes takes not even the first sample of another frame.
    computes = ("!(valid && sent_closed != 0)",) if twin.network.busy else ()
    helps = [
        "asked_place == gate0_place && asked_skipping == gate0_dropping && asked_closed == 0",
        f"asked_place < {inputs} && (!asked_skipping || asked_place == 0)",
        f"sent_place < {inner.inputs}",
    ]
    if slots:
        watch += ago("done_ago", "done", slots)
        helps += [
            "!sent_skipping",
            f"gate0_empty <= {slots}",
            "gate0_empty == 0 || (asked_place == 0 && !asked_skipping)",
            f"sent_place == (gate0_empty == 0 ? asked_place : {inner.inputs} - gate0_empty)",
            f"done_ago == (gate0_empty == 0 ? 0 : 1 << ({slots} - gate0_empty))",
        ]
        if twin.spacing:
            helps += [
                f"gate0_empty != 0 || sent_closed <= gate0_remaining + {slots}",
                "gate0_empty == 0 || sent_closed < gate0_empty",
                f"gate0_empty == 0 || gate0_remaining == {twin.spacing - 1 - slots} + gate0_empty",
            ]
        else:
            helps.append("sent_closed == 0")
    else:
        helps.append("sent_place == asked_place && sent_skipping == asked_skipping")
        helps.append(f"sent_closed == {'gate0_remaining' if twin.spacing else '0'}")
    if computes:
        helps.append("gate0_remaining == 0 || (asked_place == 0 && !asked_skipping)")
    with_slots = "with its slots behind its samples" if slots else "as it came"
    return [
        *items,
        Property(
            name="frames sent on",
            sentence=f"Each good frame is sent to the network once, {with_slots}, and never too "
            "close behind another. One wrong frame is sent for each wrong one. A reset ends what "
            "is under way.",
            states=(
                "done == asked_good",
                f"sent_good == {f'done_ago[{slots - 1}]' if slots else 'done'}",
                "sent_wrong == asked_wrong",
                *computes,
            ),
            watch=watch,
            helps=tuple(helps),
            free=cut,
            reached=("sent_good", "sent_wrong", "asked_skipping"),
            refuted_by=(
                (r"gate0_dropping <= \(!s_axis_tlast\)", "gate0_dropping <= s_axis_tlast"),
                (r"gate0_final && s_axis_tlast", "s_axis_tlast"),
                (r"gate0_final && gate0_held", "0")
                if twin.spacing
                else (r"gate0_empty <= 2", "gate0_empty <= 1"),
            ),
            clocks=20,
        ),
    ]
