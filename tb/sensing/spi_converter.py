"""Models of converters, made from their data sheets, which answer a block and judge its timing.

The models are independent of the block and its twin: limits, commands and codes are taken from the
timing diagrams. A model reads the recorded columns of the wires as a whole, and gives the column of
``miso`` that the converter would have sent. At the end a block is played with one.
"""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np

from golden.sensing.converter_parts import PULL_UP_NS
from tb.common.bench import RESET_CLOCKS
from tb.common.framing import Scans

# The converter does not drive the wire.
RELEASED = 1


def mcp3208(asked: list[int]) -> tuple[int, list[int | str]]:
    """The channel, and the bits after the fall of ``cs_n`` and after each fall of ``sclk``.

    The command is a start bit, single-ended, D2, D1, D0. Then follow a clock to settle, a null bit,
    B11 to B0, B1 to B11, and zeros.
    """
    start = asked.index(1)
    single, *channel = asked[start + 1 : start + 5]
    assert single == 1, "mcp3208: asked for a difference"
    down = [f"B{n}" for n in range(11, -1, -1)]
    up = [f"B{n}" for n in range(1, 12)]
    sent = [RELEASED] * (start + 6) + [0, *down, *up]
    return int("".join(map(str, channel)), 2), sent


def ads8344(asked: list[int]) -> tuple[int, list[int | str]]:
    """The same for this part: start, A2, A1, A0, an unused bit, SGL/DIF, PD1, PD0; busy, B15 to B0.

    Zeros follow. The address of the multiplexer names a pair of channels, and which of the two.
    """
    start = asked.index(1)
    address, (single, *power) = asked[start + 1 : start + 4], asked[start + 5 : start + 8]
    assert single == 1, "ads8344: asked for a difference"
    assert power == [1, 1], "ads8344: asked to power down, or to take its own clock"
    odd, *pair = address
    sent = [0] * (start + 9) + [f"B{n}" for n in range(15, -1, -1)]
    return 2 * int("".join(map(str, pair)), 2) + odd, sent


@dataclass(frozen=True)
class Sheet:
    """The timing of a converter, in nanoseconds, and its codes.

    ``ideal`` gives the code for a sensor's voltage of -1 to 1 V after the analogue front end that
    the converter needs. As a code of Fix(14,13) it is at most half a step of the converter off.
    """

    diagram: Callable[[list[int]], tuple[int, list[int | str]]]
    bits: int
    period: Fraction
    longest: Fraction
    high: int
    low: int
    select: int
    deselect: int
    setup: int
    hold: int
    output: int
    enable: int
    disable: int
    signed: bool

    def ideal(self, voltages: np.ndarray) -> np.ndarray:
        """The codes for voltages, from 0 V to the reference or around the common voltage."""
        places = 1 << self.bits
        steps = (2 * (voltages + 8192) * places + 16384) // 32768
        steps = np.minimum(steps, places - 1)
        return (steps + places // 2) % places if self.signed else steps


# The values are from Microchip DS21298E at 2.7 V and at 5 V, and from Texas Instruments SBAS139E
# and SBAS177 at 2.7 V.
_MCP3208 = {
    "diagram": mcp3208,
    "bits": 12,
    "longest": Fraction(100_000),
    "high": 250,
    "low": 250,
    "select": 100,
    "deselect": 500,
    "setup": 50,
    "hold": 50,
    "output": 200,
    "enable": 200,
    "disable": 100,
    "signed": False,
}
_ADS8344 = {
    "diagram": ads8344,
    "bits": 16,
    "period": Fraction(1000, Fraction("2.4")),
    "longest": Fraction(1000, Fraction("0.024")),
    "high": 200,
    "low": 200,
    "select": 100,
    "deselect": 0,
    "setup": 100,
    "hold": 10,
    "output": 200,
    "enable": 200,
    "disable": 200,
}
SHEETS = {
    "mcp3208": Sheet(**_MCP3208, period=Fraction(1000)),
    "mcp3208-5v": Sheet(**_MCP3208, period=Fraction(500)),
    "ads8344": Sheet(**_ADS8344, signed=False),
    "ads8345": Sheet(**_ADS8344, signed=True),
}


@dataclass(frozen=True)
class Transfer:
    """One transfer: its rows, what was asked, and what was sent.

    In ``rows`` ``cs_n`` is low. At each of ``falls`` ``sclk`` becomes low again. ``cut`` says
    whether a reset ended the transfer.
    """

    rows: range
    falls: list[int]
    channel: int
    code: int
    cut: bool


class Converter:
    """A converter on the wires of a recording.

    clock_mhz: The clock of the block. A row is one clock.
    rng: Gives the values of the wire while the data sheet promises none.
    """

    def __init__(self, part: str, clock_mhz: float, rng: np.random.Generator):
        self.sheet = SHEETS[part]
        self.row_ns = 1000 / Fraction(str(clock_mhz))
        self.rng = rng
        self.checked = 0

    def answer(
        self,
        wires: dict[str, np.ndarray],
        resets: np.ndarray,
        first: int,
        convert: Callable[[int, int], int],
        fault: Callable[[int], dict[int, int] | int | None] = lambda number: None,
    ) -> tuple[np.ndarray, list[Transfer]]:
        """The column of ``miso``, and the transfers. A timing that the data sheet forbids fails.

        wires: The columns of ``cs_n``, ``sclk`` and ``mosi``.
        resets: A column. A transfer that a reset cuts only has to keep the limit of ``cs_n`` high.
        first: The first row in which the wires are defined.
        convert: Gives the code of a channel for the number of the transfer.
        fault: Gives, for the number of a transfer, what is wrong with it: 0 or 1 for a wire that is
            stuck from before the transfer on, or the bits to invert. A bit is counted by the falls
            of ``sclk`` before it: 1 is the bit of the first clock, 0 the line before the transfer.
        """
        sheet, selected = self.sheet, wires["cs_n"]
        length = len(selected)
        # Nobody drives the wire, so the pull-up raises it, which takes some time at first.
        miso = np.full(length, RELEASED)
        changes = np.flatnonzero(np.diff(selected[first:])) + first + 1
        falls = changes[selected[changes] == 0]
        number, found, high_since = 0, [], first
        for fall in falls:
            self._least("cs_n high", fall - high_since, sheet.deselect, fall)
            later = np.flatnonzero(selected[fall:] == 1)
            rise = int(fall + later[0]) if len(later) else length
            cut = rise == length or bool(resets[rise - 1])
            found.append(self._transfer(wires, range(int(fall), rise), cut, miso, convert, number))
            self._loose(miso, rise, sheet.disable + PULL_UP_NS)
            wrong = fault(number)
            if isinstance(wrong, dict):
                self._turn(miso, found[-1], wrong)
            elif wrong is not None:
                miso[high_since:rise] = wrong
            number, high_since = number + 1, rise
        return miso, found

    def _transfer(self, wires, rows, cut, miso, convert, number) -> Transfer:
        """Judge the timing of one transfer and put its answer into ``miso``."""
        sheet = self.sheet
        clock, data = (wires[name][rows.start : rows.stop] for name in ("sclk", "mosi"))
        assert clock[0] == 0, f"sclk is high in row {rows.start}, where cs_n falls"
        edges = np.flatnonzero(np.diff(clock)) + 1
        ups, downs = edges[clock[edges] == 1], edges[clock[edges] == 0]
        if not cut:
            self._least("cs_n low before sclk", ups[0], sheet.select, rows.start)
            for up, down in zip(ups, downs, strict=True):
                self._least("sclk high", down - up, sheet.high, rows.start + up)
            for down, up in zip(downs, ups[1:], strict=False):
                self._least("sclk low", up - down, sheet.low, rows.start + down)
            for one, other in pairwise(ups):
                self._least("period of sclk", other - one, sheet.period, rows.start + one)
                assert (other - one) * self.row_ns <= sheet.longest, "sclk is too slow"
            turns = np.concatenate([[0], np.flatnonzero(np.diff(data)) + 1, [len(data)]])
            for up in ups:
                place = np.searchsorted(turns, up, side="right")
                self._least("mosi before sclk", up - turns[place - 1], sheet.setup, rows.start + up)
                self._least("mosi after sclk", turns[place] - up, sheet.hold, rows.start + up)
        asked = [int(data[up]) for up in ups]
        if cut and (1 not in asked or len(asked) < asked.index(1) + 8):
            return Transfer(rows, [], -1, -1, cut)
        channel, sent = sheet.diagram(asked)
        code = convert(channel, number)
        at = [0, *(int(d) for d in downs)]
        for n, down in enumerate(at):
            stop = rows.start + (at[n + 1] if n + 1 < len(at) else len(clock))
            level = sent[n] if n < len(sent) else 0
            if isinstance(level, str):
                level = code >> int(level[1:]) & 1
            driven = rows.start + down
            miso[driven:stop] = level
            if n or level != RELEASED:
                self._loose(miso, driven, sheet.output if n else sheet.enable, stop)
        return Transfer(rows, [rows.start + int(d) for d in downs], channel, code, cut)

    def _loose(self, miso: np.ndarray, row: int, time: int, stop: int | None = None) -> None:
        """Put random values on the wire for a time after the edge that row ``row`` shows.

        The edge comes at the end of the row before. The value at the end of a row counts.
        """
        rows = -int(-Fraction(time) / self.row_ns // 1) - 1
        end = min(len(miso) if stop is None else stop, row + max(0, rows))
        miso[row:end] = self.rng.integers(0, 2, max(0, end - row))

    def _turn(self, miso: np.ndarray, transfer: Transfer, wrong: dict[int, int]) -> None:
        """Invert bits in the rows in which they are read."""
        for bit in wrong:
            row = transfer.rows.start - 1 if bit == 0 else transfer.falls[bit - 1] - 1
            miso[row] ^= 1

    def _least(self, what: str, rows: int, time: Fraction | int, at: int) -> None:
        self.checked += 1
        assert rows * self.row_ns >= time, (
            f"{what} for {float(rows * self.row_ns):g} ns about row {at}, "
            f"expected {float(time):g} or more"
        )


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
