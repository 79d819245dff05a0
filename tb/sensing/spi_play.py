"""Plays a block with a converter on its wires, and checks how it reports the converter."""

import numpy as np

from tb.common.bench import RESET_CLOCKS
from tb.common.framing import Scans
from tb.sensing.spi_converter import SHEETS, Converter

PINS = ["cs_n", "sclk", "mosi"]


class Timeline(Scans):
    """The scans of a reader in a recording."""

    def __init__(self, reader, recording):
        super().__init__(recording, reader.scan_clocks)
        starts = self.rows[self.count == 0]
        ends = starts + reader.read_clocks[-1, -1]
        # The scans whose last bit is in the recording, and before any reset.
        kept = (ends < recording.clocks - 2) & ~np.isin(starts, self.marks)
        self.starts = starts[kept][recording.undisturbed(starts[kept], ends[kept])]
        # In which clocks these scans read miso, the codes of their transfers, and which are right.
        self.read = self.starts[:, np.newaxis, np.newaxis] + reader.read_clocks
        bits = recording.unsigned("miso", self.read.ravel()).reshape(self.read.shape)
        self.codes, self.right = reader.received(bits)


class Voltages:
    """Gives a converter one frame in each scan, and knows of which one each transfer was."""

    def __init__(self, reader, frames):
        self.frames, self.inputs = frames, reader.inputs
        self.codes, self.used = SHEETS[reader.part.name].ideal(frames), {}

    def convert(self, channel, number):
        self.used[number] = number // self.inputs % len(self.frames)
        return int(self.codes[self.used[number], channel])

    def given(self, transfers, read):
        """The samples of some scans, which read in these clocks.

        If a reset comes in a scan, its transfers may belong to one frame or to two.
        """
        numbers = {transfer.rows.start: n for n, transfer in enumerate(transfers)}
        of = [[self.used[numbers[int(row) + 1]] for row in scan[:, 0]] for scan in read]
        frames = np.array(of, dtype=np.int64).reshape(-1, self.inputs)
        return self.frames[frames, np.arange(self.inputs)]


def random_voltages(bench, scans):
    """Random frames with ends of the range, and a wrong transfer in a third of the scans."""
    rng, inputs = bench.rng, bench.twin.inputs
    frames = rng.integers(-8192, 8192, (scans, inputs))
    frames = np.where(rng.random(frames.shape) < 1 / 8, -8192, frames)
    frames = np.where(rng.random(frames.shape) < 1 / 8, 8191, frames)
    return frames, {
        int(scan * inputs + rng.integers(0, inputs)): int(rng.integers(0, 2))
        for scan in range(1, 2 * scans, 3)
    }


async def listen(bench, reader, resets, watch, convert, fault=lambda number: None, rx=None):
    """Play the block with a converter that sees the same wires in each scan, and check that it did.

    resets, rx: Columns. The second one is there where the block has such a port.
    convert, fault: Those of ``Converter.answer``.
    """
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


def check_error(bench, reader, recording, timeline):
    """Check ``converter_error`` in every clock, and return those in which outputs leave with it.

    A reader has no such clocks. A network after it may then send the outputs of an earlier scan.
    """
    read = reader.read_clocks
    ended = timeline.rows[np.isin(timeline.count, read[:, -1])]
    ended = ended[ended + 1 < recording.clocks]
    ended = ended[recording.undisturbed(ended, ended + 1)]
    turns = np.searchsorted(read[:, -1], timeline.count[ended - RESET_CLOCKS])
    at = ended[:, np.newaxis] - read[turns, -1:] + read[turns]
    _, right = reader.received(recording.unsigned("miso", at.ravel()).reshape(at.shape))
    # The rows from which on the flag has a value, which is two clocks after the last bit.
    changes, spoilt = {int(row) + 1: None for row in timeline.marks}, False
    told = dict(zip((ended + 2).tolist(), zip(turns, right, strict=True), strict=True))
    rows, levels, up = [0], [0], 0
    for row in sorted(changes | told):
        if row in changes:
            up, spoilt = 0, False
        if row in told:
            turn, good = told[row]
            spoilt = not good or (spoilt and turn > 0)
            up = 1 if spoilt else 0 if turn == reader.inputs - 1 else up
        rows.append(row)
        levels.append(up)
    expected = np.array(levels)[np.searchsorted(rows, timeline.rows, side="right") - 1]
    got = recording.unsigned("converter_error", timeline.rows)
    bench.compare("converter_error", got, expected, clock=timeline.rows)
    return np.intersect1d(recording.rows("out_valid"), recording.rows("converter_error"))
