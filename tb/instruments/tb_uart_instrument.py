"""uart_instrument against its twin: from the sensors' voltages to the bits on the line.

The converter answers recorded and random voltages, with wrong transfers and resets, while noise,
bytes without a stop bit, images or lessons come on the line. Everything that is shown is compared
in its clocks, and a receiver reads the packets from ``tx``. That bytes of every speed are received
is proved, and so is that the points of a profile are given one after the other. Images of other
sizes are a matter of tb_engine.
"""

from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import cocotb
import numpy as np

from golden.learning import timeline as learning
from golden.link.packets import IMAGE, SYNC, image_packet, kind_byte, lesson_packet
from golden.link.uart import UartReceiver, bits_of
from tb.common import readout
from tb.common.bench import RESET_CLOCKS, Bench, test_of
from tb.common.case_library import cases
from tb.common.framing import check_outputs
from tb.common.loading import computed
from tb.common.network import recorded_frames
from tb.sensing.spi_converter import PINS, Timeline, Voltages, check_error, listen, random_voltages

CASES = cases("uarts", "winner-uart")
# An instrument that learns takes lessons from the line.
COMPARED = ("learn-uart",)

# How many scans with results are played with traffic on the line, and after an image.
SCANS = 12
# How many scans it takes at most until a step would leave the range.
REFUSED = 60
STREAM = "valid", "data", "last"


@dataclass
class Played:
    """What was played and checked.

    runs: For each network that ran, it and the numbers of its frames.
    ends: The clocks of the last samples.
    frames: The contents of the twin's packets.
    met: How often each thing happened to an engine that learns.
    """

    recording: Any
    timeline: Any
    runs: list
    ends: np.ndarray
    frames: list
    met: Counter = field(default_factory=Counter)

    @property
    def flags(self):
        return {name for frame in self.frames for name in frame.flags}


class Sender:
    """Makes the levels of ``rx`` of bytes that are sent one after the other."""

    def __init__(self, bench):
        self.bit, self.rng = bench.twin.divisor, bench.rng
        self._levels = [np.ones(30, dtype=np.int64)]

    def send(self, data, broken=False):
        for byte in data:
            bits = (*bits_of(byte)[:-1], 0, 1) if broken else bits_of(byte)
            self._levels.append(np.repeat(bits, self.bit))
            if self.rng.random() < 1 / 16:
                self.idle(int(self.rng.integers(1, 6 * self.bit)))

    def noise(self):
        self.send(self.rng.integers(0, 256, 4).tolist())
        self.send([int(self.rng.integers(0, 256))], broken=True)

    def rest(self, bytes_):
        self.idle(int(bytes_ * 10 * self.bit))

    def idle(self, clocks):
        self._levels.append(np.ones(clocks, dtype=np.int64))

    @property
    def levels(self):
        return np.concatenate(self._levels)


def noise_and_image(bench):
    """Levels of ``rx``: the image behind noise, wrong bytes and a packet that is cut off."""
    rng, line = bench.rng, Sender(bench)
    line.noise()
    line.send([SYNC, SYNC, kind_byte(IMAGE), 2, 0, *rng.integers(0, 256, 7).tolist()])
    line.rest(25)
    line.send(image_packet(bench.twin.core.image))
    line.rest(rng.integers(1, 5))
    return line.levels


def noise_and_lessons(bench, count):
    """Levels of ``rx``: lessons with noise, and with wrong and cut ones between them."""
    twin, rng, line = bench.twin, bench.rng, Sender(bench)
    for n in range(count):
        known = rng.integers(-8192, 8192, twin.outputs)
        ends = rng.random(twin.outputs) < n % 2 / 2
        known = np.where(ends, rng.choice([-8192, 8191], twin.outputs), known).tolist()
        given, what = (known if n % 4 else []), "known"
        if n % 6 == 3:
            given, what = rng.integers(-8192, 8192, twin.elements).tolist(), "theta"
        packet = lesson_packet(twin.lesson_receiver.codes, n % 5 != 4, given, what)
        if n % 3 == 0:
            line.noise()
            line.rest(25)
            line.send([*packet[:-1], packet[-1] ^ 1])
            line.send(packet[: int(rng.integers(2, len(packet)))])
            line.rest(25)
        line.send(packet)
        line.idle(int(rng.integers(0, 4) * twin.interval))
    return line.levels


def samples_of(bench, recording, timeline, transfers, voltages):
    """The columns valid, data and last of the stream into the network, and its frames."""
    reader = bench.twin.converter_reader
    count = recording.clocks - RESET_CLOCKS
    whole = timeline.right.all(axis=1)
    read = timeline.read[whole]
    frames = reader.process(timeline.codes[whole])
    sent = reader.process(reader.converted(voltages.given(transfers, read)))
    bench.compare("what the converter was given", frames, sent)
    at = read[:, -1, -1:] + reader.latency + np.arange(reader.slots) - RESET_CLOCKS
    begun = np.repeat(timeline.starts[whole], reader.slots)
    alive = recording.undisturbed(begun, at.ravel() - 1 + RESET_CLOCKS) & (at.ravel() < count)
    valid, data, last = (np.zeros(count, dtype=np.int64) for _ in range(3))
    valid[at.ravel()[alive]] = 1
    data[at.ravel()[alive]] = frames[:, np.arange(reader.slots) % reader.inputs].ravel()[alive]
    ends = at[:, -1][alive.reshape(at.shape)[:, -1]]
    last[ends] = 1
    return (valid, data, last), frames[alive.reshape(at.shape)[:, -1]], ends


def loaded(bench, recording, samples, ends):
    """What the twins compute from ``rx`` and the frames: flags, and the frames of each good image.

    The loader waits while a frame is computed, and no frame is taken while it loads. As each
    depends on the other, both are computed again until nothing changes.
    """
    twin, rows = bench.twin, np.arange(RESET_CLOCKS, recording.clocks)
    clears = recording.unsigned("rst", rows)
    heard = twin.uart_receiver.process(recording.unsigned("rx", rows), clears)
    last_out = np.isin(rows, recording.rows("out_last"))
    busy, settled = np.zeros(len(rows), dtype=bool), False
    while not settled:
        received = heard["out_valid"], heard["out_data"], ~busy, clears
        load = tuple(twin.image_receiver.process(*received).values())
        valid, _, last = samples
        loading, guarded, runs = computed(twin.core, valid, last, load, busy, last_out, clears)
        settled, busy = (guarded.busy == busy).all(), guarded.busy
    flags = {
        "frame_error": guarded.frame_error,
        "image_error": loading.image_error,
        "line_error": heard["line_error"],
    }
    return flags, [(network, np.flatnonzero(np.isin(ends, done))) for network, done in runs]


def taught(bench, recording, samples):
    """Compare outputs with what the twins compute from ``rx`` and the frames.

    Returns the columns that the packets carry, and how often each thing happened to the engine.

    Known outputs are offered when a frame ends, and are taken when the engine is ready. As each
    depends on the other, both are computed again until nothing changes.
    """
    twin, rows = bench.twin, np.arange(RESET_CLOCKS, recording.clocks)
    clears = recording.unsigned("rst", rows)
    heard = twin.uart_receiver.process(recording.unsigned("rx", rows), clears)
    ready, ends = (np.zeros(len(rows), dtype=np.int64) for _ in range(2))
    names = ("in_valid", "in_data", "in_last")
    while True:
        received = heard["out_valid"], heard["out_data"], ends, ready, clears
        lesson = twin.lesson_receiver.process(*received)
        told = {name: lesson[name] for name in learning.INPUTS if name in lesson}
        engine = learning.Timeline(twin.core.program)
        found = engine.play(dict(zip(names, samples, strict=True)) | told | {"rst": clears})
        if (found["target_ready"] == ready).all() and (found["out_last"] == ends).all():
            break
        ready, ends = found["target_ready"], found["out_last"]
    columns = {
        "line_error": heard["line_error"],
        "lesson_error": lesson["lesson_error"] | (found["target_error"] == 1),
        "learn_error": found["learn_error"],
        "learning": lesson["learn"],
        **{name: found[name] for name in ("theta_valid", "theta_data")},
    }
    left = np.flatnonzero(found["out_valid"])
    last = found["out_last"][left] == 1
    codes = found["out_data"][left]
    bench.compare_stream(recording, left + RESET_CLOCKS, codes, last, clock=left)
    return columns, engine.met


def check_shown(bench, recording):
    """Check what is shown of the outputs, and the held ones in one clock in seven as well.

    Returns the columns of winner and profile, which the packets carry too.
    """
    twin, shown = bench.twin, bench.twin.readout
    if shown.decides:
        readout.check_winner(bench, recording, shown)
    left = recording.rows("out_valid")
    place = readout.places(recording, left, recording.rows("out_last"))
    codes = recording.signed("out_data", left)
    clocks = np.arange(RESET_CLOCKS, recording.clocks)
    newest = [np.searchsorted(left[place == i], clocks) - 1 for i in range(twin.outputs)]
    known = np.all(np.array(newest) >= 0, axis=0) & ((clocks % 7 == 0) | np.isin(clocks, left))
    rows = clocks[known]
    for i, at in enumerate(newest):
        held = codes[place == i][at[known]]
        bench.compare(f"held_{i}", recording.signed(f"held_{i}", rows), held, clock=rows)
    told = readout.columns(bench, recording, readout.WINNER) if shown.decides else {}
    if shown.load_profile:
        readout.check_drawn(bench, recording, shown)
        told |= readout.columns(bench, recording, readout.PROFILE)
    return told


def check_line(bench, recording, columns):
    """Check the bits of ``tx`` and what a receiver reads from them, and return the packets."""
    twin, rows = bench.twin, np.arange(RESET_CLOCKS, recording.clocks)
    clears = recording.unsigned("rst", rows)
    valid, sent, frames = twin.packet_sender.process(
        columns, clears, twin.uart_transmitter.interval
    )
    _, tx = twin.uart_transmitter.process(valid, sent, clears)
    bench.compare("tx", recording.unsigned("tx", rows), tx, clock=rows)
    if not clears.any():
        heard = UartReceiver(twin.divisor).process(recording.unsigned("tx", rows), clears)
        data = b"".join(twin.packet_sender.layout.to_bytes(frame) for frame in frames)
        got = heard["out_data"][heard["out_valid"] == 1]
        bench.compare("bytes", got, np.frombuffer(data, np.uint8)[: len(got)])
        assert len(got) >= len(data) - twin.packet_sender.layout.packet_bytes, "bytes are missing"
    return frames


async def check(bench, frames, resets, rx=None, fault=lambda number: None):
    """Play voltages, one frame in each scan, and compare everything that is shown."""
    twin, shown = bench.twin, bench.twin.readout
    reader, voltages = twin.converter_reader, Voltages(twin.converter_reader, frames)
    dac = ["dac_x", "dac_y"] if twin.analogue else []
    watch = [*PINS, "tx", *dac, "converter_error", "out_valid", "out_data", "out_last"]
    watch += readout.ports(shown)
    recording, transfers = await listen(bench, reader, resets, watch, voltages.convert, fault, rx)
    timeline = Timeline(reader, recording)
    check_error(bench, reader, recording, timeline)
    samples, seen, ends = samples_of(bench, recording, timeline, transfers, voltages)
    flags, runs, met = {}, [(shown, np.arange(len(ends)))], Counter()
    if twin.learns:
        flags, met = taught(bench, recording, samples)
    else:
        if rx is not None:
            flags, runs = loaded(bench, recording, samples, ends)
        rows = ends + RESET_CLOCKS
        due = [(network, rows[n], rows[n], seen[n]) for network, n in runs if len(n)]
        check_outputs(bench, recording, *due)
    told = check_shown(bench, recording)
    rows = np.arange(RESET_CLOCKS, recording.clocks)
    given = twin.dac(told, recording.unsigned("rst", rows)) if dac else ()
    for port, bits in zip(dac, given, strict=True):
        bench.compare(port, recording.unsigned(port, rows), bits, clock=rows)
    columns = {f"sample_{name}": column for name, column in zip(STREAM, samples, strict=True)}
    results = readout.columns(bench, recording, [f"out_{name}" for name in STREAM])
    columns |= {name.replace("out", "result"): column for name, column in results.items()}
    columns |= {"converter_error": recording.unsigned("converter_error", rows)} | flags | told
    return Played(recording, timeline, runs, ends, check_line(bench, recording, columns), met)


@cocotb.test()
async def recorded(dut):
    """Play recorded frames while the image is loaded and after it, and count the clocks."""
    bench = Bench(dut)
    twin = bench.twin
    scans = twin.past + SCANS
    frames = recorded_frames(bench)[:scans]
    rx = None
    if twin.image:
        rx = noise_and_image(bench)
    elif twin.learns:
        rx = noise_and_lessons(bench, SCANS)
    length = scans * twin.interval + twin.output_clocks[-1] + twin.outputs + 5
    column = np.zeros(length + (0 if rx is None else len(rx)), dtype=np.int64)
    if rx is not None:
        rx = np.concatenate([rx, np.ones(length, dtype=np.int64)])
    played = await check(bench, frames, column, rx)
    recording, runs = played.recording, played.runs
    counts = [len(numbers) for _, numbers in runs]
    assert len(counts) == 1, f"got {len(counts)} good images"
    assert counts[0] >= scans - 1, f"got {counts[0]} frames"
    told = played.flags
    if twin.image:
        assert told == {"frame_error", "image_error", "line_error"}, f"got the flags {told}"
    if twin.learns:
        # Whether a step is refused depends on the networks, and tx shows that it is reported.
        due = {"line_error", "lesson_error", "learning"}
        due |= told & ({"learn_error"} if played.met["steps refused"] else set())
        assert told == due, f"got the flags {told}"
        for name in ("placements", "steps taken", "corrected frames", "theta put in"):
            assert played.met[name], f"{name}: none, expected some; {played.met}"
    # The next scan begins before the samples of this scan have left.
    first = runs[0][1][twin.past]
    last_bit = played.ends[first] + RESET_CLOCKS - twin.burst
    started = played.timeline.starts[played.timeline.starts < last_bit][-1]
    ends = recording.rows("out_last")
    bench.measured(recording, len(runs[0][1]), started, ends[0], ends)
    bench.finish(at_least=(SCANS - 1) * twin.outputs)


@cocotb.test()
async def random_faults_and_resets(dut):
    """Play random voltages with wrong transfers, and with resets in mid-scan and mid-packet."""
    bench = Bench(dut)
    twin, rng = bench.twin, bench.rng
    scans = 2 * SCANS
    frames, faults = random_voltages(bench, scans)
    # So many wrong transfers come in a row that a packet reports them.
    row = np.arange(scans // 3, scans // 3 + 2 + 2 * twin.packet_scans)
    faults |= dict.fromkeys((row * twin.inputs).tolist(), 1)
    length = scans * twin.interval
    rx = None
    if twin.image:
        lasting = rng.integers(1, 3 * twin.divisor, length)
        rx = np.repeat(rng.integers(0, 2, length), lasting)[:length]
    elif twin.learns:
        rx = noise_and_lessons(bench, scans)[:length]
        rx = np.concatenate([rx, np.ones(length - len(rx), dtype=np.int64)])
    resets = np.zeros(length, dtype=np.int64)
    resets[np.sort(rng.integers(twin.interval, length - 3 * twin.interval, 3))] = 1
    played = await check(bench, frames, resets, rx, faults.get)
    assert "converter_error" in played.flags, "no packet told of the converter"
    bench.finish(at_least=scans)


@test_of(lambda t: t.learns)
async def steps_refused(dut):
    """Show what no gain and no offset gives, until packets report a step that is not taken."""
    bench = Bench(dut)
    twin, line = bench.twin, Sender(bench)
    frames = recorded_frames(bench)[:1]
    known = np.where(twin.readout.process(frames)[0] < 0, 8191, -8192)
    line.send(lesson_packet(twin.lesson_receiver.codes, True, known.tolist()))
    line.idle(REFUSED * twin.interval)
    rx = line.levels
    played = await check(bench, frames, np.zeros(len(rx), dtype=np.int64), rx)
    assert played.met["steps refused"], f"none, expected some; {played.met}"
    assert played.flags == {"learn_error", "learning"}, f"got the flags {played.flags}"
    bench.finish(at_least=REFUSED * twin.outputs)
