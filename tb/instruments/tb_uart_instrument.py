"""uart_instrument against its twin: from the sensors' voltages to the bits on the line.

The converter answers recorded and random voltages, with wrong transfers and resets, while noise,
bytes without a stop bit, images or lessons come on the line. Everything that is shown is compared
in its clocks, and a receiver reads the packets from ``tx``. That bytes of every speed are received
is proved.
"""

from dataclasses import dataclass, field, replace
from typing import Any

import cocotb
import numpy as np

from golden.common.border import State
from golden.engine.image import Image
from golden.learning import timeline as learning
from golden.link.packets import IMAGE, SYNC, image_packet, kind_byte, lesson_packet
from golden.link.uart import BYTE_BITS, UartReceiver, bits_of
from golden.trained.dense import mlp_of
from tb.common import readout
from tb.common.bench import RESET_CLOCKS, Bench, test_of
from tb.common.case_library import cases
from tb.common.framing import yielding
from tb.common.images import longest_image
from tb.common.network import recorded_frames
from tb.common.profile import check_profile
from tb.sensing.spi_converter import Converter
from tb.sensing.spi_play import PINS, Timeline, check_error

CASES = cases("uarts", "winner-uart")

# How many scans are played with traffic on the line, and after an image.
SCANS = 12
# How many scans it takes at most until a step would leave the range.
REFUSED = 60
# Other images than its own are loaded into a memory of this size, which takes long.
ROOMY = 1024
# An image that takes more clocks on the line is not loaded for its far-reaching profiles.
SHORT = 50_000


@dataclass
class Played:
    """What was played and checked.

    runs: For each network that ran, it and the numbers of its frames.
    ends: The clocks of the last samples.
    told: The columns of winner and profile.
    sending: The packets of the twin.
    met: How often each thing happened to an engine that learns.
    """

    recording: Any
    timeline: Any
    runs: list
    ends: np.ndarray
    told: dict
    sending: Any
    met: dict = field(default_factory=dict)


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


def noise_and_images(bench, images):
    """Levels of ``rx``: images one after another, with noise and wrong bytes before each."""
    rng, line = bench.rng, Sender(bench)
    for image in images:
        line.noise()
        line.send([SYNC, SYNC, kind_byte(IMAGE), 2, 0, *rng.integers(0, 256, 7).tolist()])
        line.rest(25)
        line.send(image_packet(image))
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


async def answered(bench, reader, resets, rx, watch, convert, fault):
    """Play the block once, with a converter that sees the same wires in each scan."""
    scan = reader.scan_clocks
    short = np.zeros(2 * scan, dtype=np.int64)
    drive = {"miso": short, "rst": short} | ({} if rx is None else {"rx": 1 - short})
    asked = await bench.play(drive, PINS)
    # These are the wires of the second scan, which all later scans repeat.
    rows = np.arange(RESET_CLOCKS + scan, asked.clocks)
    tile = {name: np.array([int(b == "1") for b in asked.columns[name]])[rows] for name in PINS}
    marks = np.concatenate([np.ones(RESET_CLOCKS, dtype=bool), np.asarray(resets) == 1])
    at = np.arange(len(marks))
    before = np.maximum.accumulate(np.where(marks, at, 0))
    before = np.concatenate([[0], before[:-1]])
    wires = {name: tile[name][(at - before - 1) % scan] for name in PINS}
    converter = Converter(reader.part.name, reader.clock_mhz, bench.rng)
    miso, transfers = converter.answer(wires, marks, RESET_CLOCKS, convert, fault)
    assert converter.checked, "no limit was looked at"
    drive = {"rst": resets, "miso": miso[RESET_CLOCKS:]} | ({} if rx is None else {"rx": rx})
    recording = await bench.play(drive, watch)
    every = at[RESET_CLOCKS:]
    for name in PINS:
        rows = every if name != "mosi" else every[wires["cs_n"][every] == 0]
        got = recording.unsigned(name, rows)
        bench.compare(name, got, wires[name][rows], clock=rows)
    return recording, transfers


def samples_of(bench, recording, timeline, frames_of):
    """The columns valid, data and last of the stream into the network, and its frames."""
    reader = bench.twin.converter_reader
    count = recording.clocks - RESET_CLOCKS
    read = timeline.starts[:, np.newaxis, np.newaxis] + reader.read_clocks
    bits = recording.unsigned("miso", read.ravel()).reshape(read.shape)
    codes, right = reader.received(bits)
    whole = right.all(axis=1)
    frames = reader.process(codes[whole])
    sent = reader.process(reader.converted(frames_of(read[whole])))
    bench.compare("what the converter was given", frames, sent)
    at = read[whole, -1, -1:] + reader.latency + np.arange(reader.slots) - RESET_CLOCKS
    begun = np.repeat(timeline.starts[whole], reader.slots)
    alive = recording.undisturbed(begun, at.ravel() - 1 + RESET_CLOCKS) & (at.ravel() < count)
    valid, data, last = (np.zeros(count, dtype=np.int64) for _ in range(3))
    valid[at.ravel()[alive]] = 1
    data[at.ravel()[alive]] = frames[:, np.arange(reader.slots) % reader.inputs].ravel()[alive]
    ends = at[:, -1][alive.reshape(at.shape)[:, -1]]
    last[ends] = 1
    return valid, data, last, frames[alive.reshape(at.shape)[:, -1]], ends


def loaded(bench, recording, valid, last, ends):
    """What the twins compute from ``rx`` and the frames: flags, and the frames of each good image.

    The loader waits while a frame is computed, and no frame is taken while it loads. As each
    depends on the other, both are computed again until nothing changes.
    """
    twin, rows = bench.twin, np.arange(RESET_CLOCKS, recording.clocks)
    clears = recording.unsigned("rst", rows)
    engine = twin.core
    heard = twin.uart_receiver.process(recording.unsigned("rx", rows), clears)
    last_out = np.isin(rows, recording.rows("out_last"))
    busy = np.zeros(len(rows), dtype=bool)
    while True:
        bytes_ = twin.image_receiver.process(heard.out_valid, heard.out_data, ~busy, clears)
        loading = engine.image_loader.process(
            bytes_.load_valid, bytes_.load_data, bytes_.load_last, busy, clears
        )
        since = np.array([clock for clock, _, _ in loading.good], dtype=np.int64)
        place = np.searchsorted(since, np.arange(len(rows))) - 1
        before_last = np.array([0, *(before for _, before, _ in loading.good)])[place + 1]
        guarded = engine.frame_guard.process(
            valid, last, loading.halt, before_last, 0 * valid, last_out, clears
        )
        if (guarded.busy == busy).all():
            break
        busy = guarded.busy
    sizes = engine.loaded.sizes
    images = [
        Image(sizes, (before + 2) % sizes.operand_words, tuple(words))
        for _, before, words in loading.good
    ]
    done = np.flatnonzero(guarded.done)
    # For each image the numbers of the frames that are computed with it.
    runs = [
        (engine.running(image), np.flatnonzero(np.isin(ends, done[place[done] == number])))
        for number, image in enumerate(images)
    ]
    flags = {
        "frame_error": guarded.frame_error,
        "image_error": loading.image_error,
        "line_error": heard.line_error,
    }
    return flags, runs


def taught(bench, recording, samples):
    """What the twins compute from ``rx`` and the frames: columns, outputs, and the engine.

    Known outputs are offered when a frame ends, and are taken when the engine is ready. As each
    depends on the other, both are computed again until nothing changes.
    """
    twin, rows = bench.twin, np.arange(RESET_CLOCKS, recording.clocks)
    clears = recording.unsigned("rst", rows)
    heard = twin.uart_receiver.process(recording.unsigned("rx", rows), clears)
    ready, ends = (np.zeros(len(rows), dtype=np.int64) for _ in range(2))
    names = ("in_valid", "in_data", "in_last")
    while True:
        lesson = twin.lesson_receiver.process(heard.out_valid, heard.out_data, ends, ready, clears)
        told = {name: getattr(lesson, name) for name in learning.INPUTS if hasattr(lesson, name)}
        engine = learning.Timeline(twin.core.program)
        found = engine.play(dict(zip(names, samples, strict=True)) | told | {"rst": clears})
        if (found["target_ready"] == ready).all() and (found["out_last"] == ends).all():
            break
        ready, ends = found["target_ready"], found["out_last"]
    columns = {
        "line_error": heard.line_error,
        "lesson_error": lesson.lesson_error | (found["target_error"] == 1),
        "learn_error": found["learn_error"],
        "learning": lesson.learn,
        **{name: found[name] for name in ("theta_valid", "theta_data")},
    }
    return (
        columns,
        np.array([found[name] for name in ("out_valid", "out_data", "out_last")]),
        engine,
    )


def check_taught(bench, recording, result):
    """Check outputs, ``out_last`` and their clocks against the columns of an engine that learns."""
    left = np.flatnonzero(result[0])
    last = result[2, left] == 1
    bench.compare_stream(recording, left + RESET_CLOCKS, result[1, left], last, clock=left)


def check_results(bench, recording, runs, frames, ends):
    """Check outputs, ``out_last`` and their clocks, and return the columns of the stream."""
    due = [np.empty((0, 3), dtype=np.int64)]
    for network, numbers in runs:
        # A frame with another number of samples has no results, and would have the wrong shape.
        if not len(numbers):
            continue
        ended = ends[numbers] + RESET_CLOCKS
        kept, results = yielding(recording, ended, frames[numbers], network.past, network.process)
        leave = ended[kept, np.newaxis] + np.array(network.output_clocks)
        final = np.zeros_like(leave)
        final[:, -1] = 1
        begun = np.repeat(ended[kept], leave.shape[1])
        alive = recording.undisturbed(begun, leave.ravel() - 1) & (leave.ravel() < recording.clocks)
        found = np.stack([leave.ravel(), results.ravel(), final.ravel()], axis=1)
        due.append(found[alive])
    expected = np.concatenate(due)
    left, codes, last = expected.T
    bench.compare_stream(recording, left, codes, last == 1, clock=left)
    columns = np.zeros((3, recording.clocks - RESET_CLOCKS), dtype=np.int64)
    columns[:, left - RESET_CLOCKS] = np.ones_like(left), codes, last
    return columns


def check_shown(bench, recording, result):
    """Check the held outputs at the end of each frame, and winner and profile of every frame.

    Returns the columns of winner and profile, which the packets carry too.
    """
    twin, shown = bench.twin, bench.twin.readout
    if shown.decides:
        readout.check_winner(bench, recording, shown)
    winner = readout.winner_columns(recording, RESET_CLOCKS) if shown.decides else {}
    held = np.zeros((recording.clocks, twin.outputs), dtype=np.int64)
    known, place, words = np.zeros(recording.clocks, dtype=bool), 0, [None] * twin.outputs
    clears = set(recording.resets().tolist())
    for t in range(result.shape[1]):
        row = t + RESET_CLOCKS
        known[row] = None not in words
        held[row] = words if known[row] else 0
        if result[0, t] and place < twin.outputs:
            words[place] = int(result[1, t])
        place = 0 if row in clears or (result[0, t] and result[2, t]) else place + result[0, t]
    rows = np.flatnonzero(known)
    # Compared are one clock in seven, and every clock in which an output comes.
    rows = rows[(rows % 7 == 0) | result[0, rows - RESET_CLOCKS].astype(bool)]
    for i in range(twin.outputs):
        bench.compare(f"held_{i}", recording.signed(f"held_{i}", rows), held[rows, i], clock=rows)
    if shown.load_profile is None:
        return winner
    ends = np.flatnonzero(result[2]) + RESET_CLOCKS
    ends = ends[(ends + 1 < recording.clocks) & recording.undisturbed(ends, ends)]
    assert known[ends + 1].all(), "a profile is drawn of outputs that never came"
    latency = shown.load_profile.latency
    entered = held[ends + 1]
    check_profile(bench, recording, "profile", ends + 1, entered, latency, shown.profile)
    columns = {name: np.zeros(result.shape[1], dtype=np.int64) for name in readout.PROFILE}
    points = recording.rows("profile_valid")
    columns["profile_valid"][points - RESET_CLOCKS] = 1
    for name in ("profile_x", "profile_y"):
        columns[name][points - RESET_CLOCKS] = recording.signed(name, points)
    columns["profile_last"][recording.rows("profile_last") - RESET_CLOCKS] = 1
    return winner | columns


def check_line(bench, recording, columns):
    """Check the bits of ``tx`` and what a receiver reads from them, and return the packets."""
    twin, rows = bench.twin, np.arange(RESET_CLOCKS, recording.clocks)
    clears = recording.unsigned("rst", rows)
    sending = twin.packet_sender.process(columns, clears, twin.uart_transmitter.interval)
    _, tx = twin.uart_transmitter.process(sending.out_valid, sending.out_data, clears)
    bench.compare("tx", recording.unsigned("tx", rows), tx, clock=rows)
    if not clears.any():
        heard = UartReceiver(twin.divisor).process(recording.unsigned("tx", rows), clears)
        data = b"".join(twin.packet_sender.layout.to_bytes(frame) for frame in sending.frames)
        got = heard.out_data[heard.out_valid]
        bench.compare("bytes", got, np.frombuffer(data, np.uint8)[: len(got)])
        assert len(got) >= len(data) - twin.packet_sender.layout.packet_bytes, "bytes are missing"
    return sending


async def check(bench, frames, resets, rx=None, fault=lambda number: None):
    """Play voltages, one frame in each scan, and compare everything that is shown."""
    twin, shown = bench.twin, bench.twin.readout
    reader = twin.converter_reader
    codes = Converter(reader.part.name, reader.clock_mhz, bench.rng).sheet.ideal(frames)
    used = {}

    def convert(channel, number):
        used[number] = number // reader.inputs % len(frames)
        return int(codes[used[number], channel])

    dac = ["dac_x", "dac_y"] if twin.analogue else []
    watch = [*PINS, "tx", *dac, "converter_error", "out_valid", "out_data", "out_last"]
    watch += readout.ports(shown)
    recording, transfers = await answered(bench, reader, resets, rx, watch, convert, fault)
    timeline = Timeline(reader, recording)
    numbers = {transfer.rows.start: n for n, transfer in enumerate(transfers)}

    def frames_of(read):
        of = [[used[numbers[int(row) + 1]] for row in scan[:, 0]] for scan in read]
        return frames[
            np.array(of, dtype=np.int64).reshape(-1, reader.inputs), np.arange(reader.inputs)
        ]

    check_error(bench, reader, recording, timeline)
    valid, data, last, seen, ends = samples_of(bench, recording, timeline, frames_of)
    flags, runs, met = {}, [(shown, np.arange(len(ends)))], {}
    if twin.learns:
        flags, result, engine = taught(bench, recording, (valid, data, last))
        check_taught(bench, recording, result)
        met = engine.met
    else:
        if rx is not None:
            flags, runs = loaded(bench, recording, valid, last, ends)
        result = check_results(bench, recording, runs, seen, ends)
    told = check_shown(bench, recording, result)
    rows = np.arange(RESET_CLOCKS, recording.clocks)
    given = twin.dac(told, recording.unsigned("rst", rows)) if dac else ()
    for port, bits in zip(dac, given, strict=True):
        bench.compare(port, recording.unsigned(port, rows), bits, clock=rows)
    columns = dict(
        zip(("sample_valid", "sample_data", "sample_last"), (valid, data, last), strict=True)
    )
    columns |= dict(zip(("result_valid", "result_data", "result_last"), result, strict=True))
    columns |= {"converter_error": recording.unsigned("converter_error", rows)} | flags | told
    sending = check_line(bench, recording, columns)
    return Played(recording, timeline, runs, ends, told, sending, met)


@cocotb.test()
async def recorded(dut):
    """Play recorded frames while the image is loaded and after it, and count the clocks."""
    bench = Bench(dut)
    twin = bench.twin
    frames = recorded_frames(bench)[:SCANS]
    rx = None
    if twin.image:
        rx = noise_and_images(bench, [twin.core.image])
    elif twin.learns:
        rx = noise_and_lessons(bench, SCANS)
    length = SCANS * twin.interval + twin.output_clocks[-1] + twin.outputs + 5
    column = np.zeros(length + (0 if rx is None else len(rx)), dtype=np.int64)
    if rx is not None:
        rx = np.concatenate([rx, np.ones(length, dtype=np.int64)])
    played = await check(bench, frames, column, rx)
    recording, runs = played.recording, played.runs
    counts = [len(numbers) for _, numbers in runs]
    assert len(counts) == 1, f"got {len(counts)} good images"
    assert counts[0] >= SCANS - 1, f"got {counts[0]} frames"
    told = {name for frame in played.sending.frames for name in frame.flags}
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
    frames = rng.integers(-8192, 8192, (scans, twin.inputs))
    frames = np.where(rng.random(frames.shape) < 1 / 8, -8192, frames)
    frames = np.where(rng.random(frames.shape) < 1 / 8, 8191, frames)
    faults = {
        int(scan * twin.inputs + rng.integers(0, twin.inputs)): int(rng.integers(0, 2))
        for scan in range(1, 2 * scans, 3)
    }
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
    told = {name for frame in played.sending.frames for name in frame.flags}
    assert "converter_error" in told, "no packet told of the converter"
    bench.finish(at_least=scans)


def far_reaching(twin):
    """An image whose load, width and shape take either sign, with the position on the ramp."""
    w1, b1 = np.zeros((3, twin.inputs)), np.zeros(3)
    w1[:, :2] = (3, 0), (0, 3), (3, 3)
    w2, b2 = np.full((twin.outputs, 3), 0.3), np.zeros(twin.outputs)
    for output, weights, bias in zip(
        twin.readout.results,
        ((1.1, 0.02, 0.01), (0.01, 0.45, 0.02), (0.02, 0.03, 0.6), (-0.6, 0.7, 0.01)),
        (0, 0.45, 0.5, 0.3),
        strict=True,
    ):
        w2[output], b2[output] = weights, bias
    return twin.core.image_for([mlp_of(w1, b1, w2, b2)])


def until_a_profile_ends(twin, network, packet, profiles):
    """Levels of ``rx`` with a packet, and the clocks from a reset until a profile after it ends.

    The packet ends in mid-scan, so that it is certain which frame is the first after it.
    """
    reader, drawing = twin.converter_reader, twin.readout.load_profile
    bits = [np.repeat(bits_of(byte), twin.divisor) for byte in packet]
    levels = np.concatenate([np.ones(0, dtype=np.int64), *bits])
    if packet:
        idle = (twin.interval // 2 - len(levels)) % twin.interval
        levels = np.concatenate([np.ones(idle, dtype=np.int64), levels])
    # If a profile takes longer than a scan, it is certain that the first one is drawn.
    before = len(levels) // twin.interval + twin.past
    before += profiles - 1 if drawing.interval <= twin.interval else 0
    last_sample = reader.read_clocks[-1, -1] + reader.latency + reader.slots - 1
    drawn = network.output_clocks[-1] + 1 + drawing.interval
    return levels, before * twin.interval + int(last_sample) + drawn


@test_of(lambda t: t.analogue and len(t.image) * BYTE_BITS * t.divisor <= SHORT)
async def drawn_slowly(dut):
    """Draw every point of the highest and the deepest profile, with resets when a profile ends."""
    bench = Bench(dut)
    twin, shown = bench.twin, bench.twin.readout
    points, network, packet = twin.packet_sender.points, shown, b""
    if twin.image:
        image = far_reaching(twin)
        network, packet = twin.core.running(image), image_packet(image.to_bytes())
    ends = readout.extremes(bench, replace(shown, network=network), times=points + 1)
    random = bench.rng.integers(-8192, 8192, (2 * points, twin.inputs))
    frames = np.concatenate([ends, random])
    # The clocks from the end of a profile to a reset. An image follows each, which takes long.
    after = (0,) if twin.image else (0, 1)
    rx, resets = [], []
    for n, late in enumerate(after):
        levels, clocks = until_a_profile_ends(twin, network, packet, n + 2)
        resets.append(np.zeros(clocks + late + 1, dtype=np.int64))
        resets[-1][-1] = 1
        rx.append(np.concatenate([levels, np.ones(len(resets[-1]) - len(levels), dtype=np.int64)]))
    levels, clocks = until_a_profile_ends(twin, network, packet, len(frames) + 1)
    resets.append(np.zeros(clocks, dtype=np.int64))
    rx.append(np.concatenate([levels, np.ones(clocks - len(levels), dtype=np.int64)]))
    line = np.concatenate(rx) if twin.hears else None
    played = await check(bench, frames, np.concatenate(resets), line)
    recording, profile = played.recording, played.told
    rows = recording.resets() - RESET_CLOCKS
    state = State("clocks from the end of a profile to a reset", range(len(after)))
    ended = np.flatnonzero(profile["profile_last"])
    bench.visit(state, rows - ended[np.searchsorted(ended, rows, side="right") - 1])
    cleared = recording.unsigned("rst", np.arange(RESET_CLOCKS, recording.clocks))
    number, _, heights = twin.slow_profile(profile, cleared)
    bench.visit(State("point that is given slowly", range(points)), number)
    if twin.image:
        assert heights.max() > 7000, f"the highest point has {heights.max()}"
        assert heights.min() < -7000, f"the deepest point has {heights.min()}"
    bench.finish(at_least=len(frames) * twin.outputs)


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
    told = {name for frame in played.sending.frames for name in frame.flags}
    assert told == {"learn_error", "learning"}, f"got the flags {told}"
    bench.finish(at_least=REFUSED * twin.outputs)


@test_of(lambda t: bool(t.image) and t.core.loaded.sizes.program_words >= ROOMY)
async def other_images(dut):
    """Load images with other numbers of samples and outputs, and one longer than a scan."""
    bench = Bench(dut)
    twin = bench.twin
    inputs, outputs = twin.inputs, twin.outputs
    shapes = [
        (inputs, 2, outputs + 2),
        (inputs, 40, outputs),
        (inputs + 1, 2, outputs),
        (inputs, 3, max(1, outputs - 2)),
    ]
    images = [longest_image(twin.core, *shape, n).to_bytes() for n, shape in enumerate(shapes)]
    rx = noise_and_images(bench, [twin.core.image, *images, twin.core.image])
    rx = np.concatenate([rx, np.ones(SCANS * twin.interval, dtype=np.int64)])
    frames = bench.rng.integers(-8192, 8192, (64, inputs))
    played = await check(bench, frames, np.zeros(len(rx), dtype=np.int64), rx)
    counts = [len(numbers) for _, numbers in played.runs]
    assert len(counts) == len(shapes) + 2, f"got {len(counts)} good images"
    assert counts[3] == 0, f"got {counts[3]} frames of another number of samples"
    assert min(counts[:3] + counts[4:]) > 0, f"got frames by image {counts}"
    bench.finish(at_least=len(played.sending.frames))
