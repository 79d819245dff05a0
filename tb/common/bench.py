"""What every bench does inside the simulator: play a timeline, record the ports, compare.

A bench prepares one value per clock for every input port and plays them. It gets back the values
that the watched ports had in every clock. Only then it feeds the recorded inputs to the twin and
compares the outputs, as whole arrays. Row t of a recording holds the ports just before the rising
edge of clock t: an input of row t and a registered output of row t + latency belong together.
"""

import hashlib
import json
import os
import pickle
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache
from itertools import chain, repeat
from pathlib import Path
from typing import Any, TypeVar

import cocotb
import numpy as np
from cocotb.handle import LogicObject, _GPISetAction
from cocotb.triggers import Timer

from golden.common.block import Block, around, walk
from golden.common.border import State
from tb.common.bench_input import BenchInput
from tb.common.coverage import Coverage

RESET_CLOCKS = 2
CONFIGURATION = "TACTUS_BENCH"
Kind = TypeVar("Kind", bound=Block)
Test = TypeVar("Test", bound=Callable[..., object])


class Recording:
    """The watched ports, row by row, as strings of bits.

    ``words`` holds what ``reader`` returned: the ports of the first row, of the second, and so on.
    """

    def __init__(self, ports: list[str], words: list[str], seconds: float):
        self.columns = {name: words[i :: len(ports)] for i, name in enumerate(ports)}
        self.clocks = len(words) // len(ports)
        self.seconds = seconds
        self._decoded: dict[str, tuple[np.ndarray, np.ndarray]] = {}
        # The rows in which the bench has read each port. The values in other rows decide nothing.
        self.looked = {name: np.zeros(self.clocks, dtype=bool) for name in ports}

    def _codes(self, port: str) -> tuple[np.ndarray, np.ndarray]:
        """The unsigned code of a port in every row, and whether all of its bits are 0 or 1.

        A bench asks for the same port again and again, so this is computed once.
        """
        if port not in self._decoded:
            words = self.columns[port]
            width = len(words[0])
            assert width < 64, f"{port}: {width} bits, and a code has 63 at most"
            bits = np.frombuffer("".join(words).encode(), np.uint8).reshape(-1, width) - ord("0")
            codes = np.zeros(len(words), dtype=np.int64)
            for bit in bits.T:
                codes <<= 1
                codes |= bit & 1
            self._decoded[port] = codes, (bits <= 1).all(axis=1)
        return self._decoded[port]

    def rows(self, port: str) -> np.ndarray:
        """Rows after the initial reset in which a flag is set; an undefined flag is an error.

        During the initial reset a flag may be undefined, or left from the test before.
        """
        after = np.arange(RESET_CLOCKS, self.clocks)
        return after[self.unsigned(port, after) == 1]

    def unsigned(self, port: str, rows: np.ndarray) -> np.ndarray:
        """Codes of an unsigned port in the given rows."""
        rows = np.asarray(rows, dtype=np.int64)
        self.looked[port][rows] = True
        codes, known = self._codes(port)
        if not known[rows].all():
            t = rows[~known[rows]][0]
            raise AssertionError(f"{port} is {self.columns[port][t]} in clock {t}")
        return codes[rows]

    def signed(self, port: str, rows: np.ndarray) -> np.ndarray:
        """Codes of a signed port in the given rows."""
        width = len(self.columns[port][0])
        codes = self.unsigned(port, rows)
        return codes - ((codes >> (width - 1)) << width)

    def resets(self) -> np.ndarray:
        """Rows in which reset is high."""
        return self.rows("rst") if "rst" in self.columns else np.array([], dtype=np.int64)

    def undisturbed(self, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        """Whether no reset falls on any of the rows first to last, for each pair."""
        resets = self.resets()
        return np.searchsorted(resets, last, side="right") == np.searchsorted(resets, first)


def test_of(applies: Callable[[Block], bool]) -> Callable[[Test], Test]:
    """Make a function a cocotb test, but only for the twins for which ``applies`` is true."""

    def chosen(test: Test) -> Test:
        configuration = os.environ.get(CONFIGURATION)
        if configuration is not None:
            _, twin = _loaded(configuration)
            return cocotb.test()(test) if applies(twin) else test
        # Outside a simulator a bench is read for its cases and faults, and planned.
        found = cocotb.test()(test)
        found.applies = applies
        return found

    return chosen


def test_named(module: str, name: str) -> Callable[[Test], Test]:
    """Make a function of a shared module a test of a bench: its seed follows from both names."""

    def named(test: Test) -> Test:
        test.__module__, test.__qualname__ = module, name
        return cocotb.test()(test)

    return named


@cache
def _loaded(configuration: str) -> tuple[BenchInput, Block]:
    """What is given of the scene, and the block under test, which all tests of a bench share."""
    said = json.loads(configuration)
    given: BenchInput = pickle.loads(Path(said["given"]).read_bytes())
    return given, next(b for b in walk(given.design) if b.entity == said["entity"])


class Bench:
    """One cocotb test: its twin, its random generator, and the count of what it compared."""

    def __init__(self, dut: Any) -> None:
        self.dut = dut
        configuration = os.environ[CONFIGURATION]
        self.configuration = json.loads(configuration)
        self.given, self.twin = _loaded(configuration)
        self.latency = self.twin.latency
        # cocotb derives RANDOM_SEED from the run's seed and the test's name.
        self.rng = np.random.default_rng(cocotb.RANDOM_SEED)
        self.frames = self.configuration["frames"]
        self.compared = 0
        self.facts: dict[str, float] = {}
        self.coverage = Coverage(self.twin)
        self.recordings: list[Recording] = []
        # For each recording: a digest of what was driven, and the rows in which each port was read.
        self.played: list[tuple[str, dict[str, np.ndarray]]] = []
        self.inputs = {port.name for port in self.twin.ports if port.direction == "in"}
        dut._log.info("rerun: %s", self.configuration["rerun"])

    def around(self, kind: type[Kind]) -> list[Kind]:
        """The blocks of a kind that the block under test is part of, the innermost first.

        The scene's top may be a network, several of them, or a whole instrument.
        """
        return [block for block in around(self.given.design, self.twin) if isinstance(block, kind)]

    async def play(
        self, drive: dict[str, np.ndarray], watch: list[str], offer: "Offer | None" = None
    ) -> Recording:
        """Reset the block, drive every port of ``drive`` clock by clock, and record ``watch``.

        The driven ports are recorded too. If ``drive`` leaves out the reset port, it stays low
        after the initial reset. Items of ``offer`` that are left when the timeline ends follow it.
        """
        length = len(next(iter(drive.values())))
        assert all(len(c) == length for c in drive.values()), "columns of unequal length"
        columns = from_reset(drive, hasattr(self.dut, "rst"))
        ports = list(columns) + watch + (offer.ports if offer else [])
        reads = [getattr(self.dut, name)._handle.get_signal_val_binstr for name in ports]
        changes = changed([(writer(self.dut, n), c) for n, c in columns.items()])
        clock = writer(self.dut, "clk") if hasattr(self.dut, "clk") else None
        show = offer.begin(self.dut) if offer else None
        words: list[str] = []
        half = Timer(5, "ns")
        behind = repeat((), offer.most_behind if offer else 0)
        started = time.perf_counter()
        for number, change in enumerate(chain(changes, behind)):
            if offer and number >= length + RESET_CLOCKS and not offer.left:
                break
            if clock:
                clock(0)
            for write, value in change:
                write(value)
            if show:
                show(number - RESET_CLOCKS)
            await half
            row = [read() for read in reads]
            words.extend(row)
            if offer:
                offer.look(dict(zip(ports, row, strict=True)))
            if clock:
                clock(1)
                await half
        return self.watched(Recording(ports, words, time.perf_counter() - started))

    def watched(self, recording: Recording) -> Recording:
        """Count the values of the ports, and check what every block promises after a reset.

        A test that does not use ``play`` must pass its recording through here.
        """
        for port, words in recording.columns.items():
            self.coverage.count_port(port, words[RESET_CLOCKS:])
        self._check_cleared(recording)
        self.played.append((driven_digest(recording, self.inputs), recording.looked))
        if self.configuration["trace"]:
            self.recordings.append(recording)
        return recording

    def _check_cleared(self, recording: Recording) -> None:
        """Check that no flag is high after a reset because of an input before the reset.

        A flag follows its cause by the latency at least, and an error flag by one clock. The twin
        names in ``data_flags`` the flags that are data and stay, such as the ``last`` of a
        position.
        """
        resets = recording.resets()
        for port in self.twin.ports:
            name = port.name
            flag = port.direction == "out" and port.kind is None
            flag &= name.endswith(("_valid", "_last", "_error"))
            if not flag or name not in recording.columns or name in self.twin.data_flags:
                continue
            clocks = 1 if name.endswith("_error") else self.latency
            high = recording.rows(name)
            before = np.searchsorted(resets, high, side="left")
            since = high - np.concatenate([[RESET_CLOCKS - 1], resets])[before]
            wrong = high[since <= clocks]
            assert not len(wrong), (
                f"{self.configuration['entity']}: {name} is high in clock {wrong[0]}, "
                f"{since[high == wrong[0]][0]} clocks after a reset, expected low for {clocks}; "
                f"rerun: {self.configuration['rerun']}"
            )

    def read(self, recording: Recording, port: str, rows: np.ndarray) -> np.ndarray:
        """Codes of a port of the twin in the given rows."""
        signed = any(one.signed for one in self.twin.ports if one.name == port)
        return (recording.signed if signed else recording.unsigned)(port, rows)

    def meet(self, quantity: str, values: np.ndarray) -> None:
        """Count values of a quantity on either side of its borders; see ``Block.borders``."""
        self.coverage.meet(quantity, np.asarray(values))

    def visit(self, state: State | str, values: np.ndarray) -> None:
        """Count the values that a state took: a state of the twin, or one of the timeline."""
        if isinstance(state, str):
            state = next(known for known in self.twin.states if known.name == state)
        self.coverage.visit(state, values)

    def compare(self, name: str, got: np.ndarray, expected: np.ndarray, **context: np.ndarray):
        """Compare bit for bit. A mismatch names everything that is needed to find it."""
        got, expected = np.asarray(got), np.asarray(expected)
        where = f"{self.configuration['entity']}: {name}"
        rerun = f"rerun: {self.configuration['rerun']}"
        assert len(got) == len(expected), (
            f"{where}: got {len(got)} results, expected {len(expected)}; {rerun}"
        )
        differ = got != expected
        wrong = np.flatnonzero(differ.any(axis=tuple(range(1, differ.ndim))))
        if len(wrong):
            at = wrong[0]
            inputs = ", ".join(f"{key}={values[at]}" for key, values in context.items())
            raise AssertionError(
                f"{where}: {len(wrong)} of {len(got)} results differ, first result {at} "
                f"({inputs}): got {got[at]}, expected {expected[at]}, "
                f"difference {got[at] - expected[at]} LSB; {rerun}"
            )
        self.compared += len(got)

    def compare_stream(
        self, recording: Recording, rows: np.ndarray, codes: np.ndarray, last: np.ndarray, **context
    ):
        """Compare ``out_valid``, ``out_data`` and ``out_last`` with what must leave.

        rows, codes, last: Its clocks, what it is, and whether each is the last of its frame.
        """
        left = recording.rows("out_valid")
        self.compare("clocks of out_valid", left, rows)
        self.compare("out_data", recording.signed("out_data", left), codes, **context)
        self.compare("clocks of out_last", recording.rows("out_last"), rows[last])

    def measured(self, recording: Recording, frames: int, first: int, final: int, ended):
        """Keep what so many frames take: the rows of the first one's begin and end, and all ends.

        A single frame has no interval.
        """
        self.facts = {
            "frames": frames,
            "seconds": recording.seconds,
            "clocks_per_frame": int(final - first + 1),
        }
        if len(ended) > 1:
            self.facts["interval"] = int(np.diff(ended).min())

    def finish(self, at_least: int = 1):
        """Fail if fewer results were compared than promised, and hand the count to the runner."""
        entity = self.configuration["entity"]
        assert self.compared >= at_least, (
            f"{entity}: compared {self.compared} results, expected at least {at_least}"
        )
        line = {
            "compared": self.compared,
            "coverage": self.coverage.counts,
            "played": {test_key(): self._play_digest()},
            **self.facts,
        }
        with Path(self.configuration["result"]).open("a", encoding="utf-8") as handle:
            handle.write(json.dumps(line) + "\n")
        if self.recordings:
            write_trace(Path(self.configuration["trace"]), self.recordings)

    def _play_digest(self) -> str:
        """A digest of what the test drove, which rows it read, and how many results it compared.

        The outputs follow from that and from the hardware, so they are left out. Both simulators
        give the same digest, and so does every netlist that behaves the same.
        """
        digest = hashlib.sha256(str(self.compared).encode())
        for driven, looked in self.played:
            digest.update(driven.encode())
            for name in sorted(looked):
                digest.update(f"{name} ".encode() + np.packbits(looked[name]).tobytes())
        return digest.hexdigest()


class Offer:
    """Items that are offered to a block one after the other, each until it is taken.

    An item that is offered during a reset is lost.

    stream: What the names of the ports begin with: "load_" of load_valid, load_ready, load_data.
    items: The values of the ports of data, by the rest of their names.
    wants: Whether the item of a number is offered from a clock on, if the ones before are taken.
    most_behind: In at most so many clocks behind the timeline the rest is offered.
    """

    def __init__(
        self,
        stream: str,
        items: dict[str, np.ndarray],
        wants: Callable[[int, int], bool],
        most_behind: int = 0,
    ):
        self.ports = [stream + name for name in ("valid", "ready", *items)]
        self.items = list(zip(*(values.tolist() for values in items.values()), strict=True))
        self.wants, self.most_behind = wants, most_behind
        self.at, self.offered = 0, False

    @property
    def left(self) -> bool:
        return self.at < len(self.items)

    def begin(self, dut) -> Callable[[int], None]:
        """A function that drives the ports in a clock."""
        valid, *data = (writer(dut, name) for name in self.ports if not name.endswith("ready"))

        def show(clock: int) -> None:
            wanted = clock >= 0 and self.left and (self.offered or self.wants(clock, self.at))
            self.offered = bool(wanted)
            # While nothing is offered, the ports show another item, which must have no effect.
            shown = self.items[(self.at if wanted else self.at + 7) % len(self.items)]
            valid(self.offered)
            for write, value in zip(data, shown, strict=True):
                write(value)

        return show

    def look(self, row: dict[str, str]) -> None:
        """Go on where the item is taken, or lost in a reset."""
        if self.offered and "1" in (row["rst"], row[self.ports[1]]):
            self.at, self.offered = self.at + 1, False


def test_key() -> str:
    """A key of the running test that does not depend on the seed of the run.

    cocotb adds a digest of the test's module and name to the seed of the run, so the difference of
    the two seeds identifies the test.
    """
    return f"{cocotb.RANDOM_SEED - int(os.environ['COCOTB_RANDOM_SEED']):040x}"[:12]


def driven_digest(recording: Recording, inputs: set[str]) -> str:
    """A digest of the values of the inputs, row by row."""
    digest = hashlib.sha256()
    for name in sorted(inputs & recording.columns.keys()):
        words = " ".join(recording.columns[name])
        digest.update(f"{name} {words}\n".encode())
    return digest.hexdigest()


def write_trace(path: Path, recordings: list[Recording]) -> None:
    """Append one line for each recording: the values, and the rows in which the bench read them."""
    with path.open("a", encoding="utf-8") as handle:
        for one in recordings:
            looked = {name: "".join("01"[int(v)] for v in one.looked[name]) for name in one.columns}
            handle.write(json.dumps({"columns": one.columns, "looked": looked}) + "\n")


def writer(dut, port: str) -> Callable[[int], None]:
    """A function that drives a port with a value from now on.

    It uses the simulator's own handle. cocotb wraps an object around each value and waits for a
    phase in which it may be written, which takes longer than Icarus takes for a clock. It is not
    needed here, because no value is written in the step in which it is read, or a clock rises.
    """
    handle = getattr(dut, port)
    deposit = _GPISetAction.DEPOSIT.value
    write_bits, write_word = handle._handle.set_signal_val_binstr, handle._handle.set_signal_val_int
    if isinstance(handle, LogicObject):
        return lambda value: write_bits(deposit, "1" if value else "0")
    width = len(handle)
    if width > 32:
        return lambda value: write_bits(deposit, f"{value % (1 << width):0{width}b}")
    return lambda value: write_word(deposit, value)


def from_reset(drive: dict[str, np.ndarray], resets: bool) -> dict[str, np.ndarray]:
    """The columns of a timeline behind the initial reset.

    If ``resets``, there is a port ``rst``. If ``drive`` leaves it out, it stays low afterwards.
    """
    columns = {name: np.asarray(values).astype(np.int64) for name, values in drive.items()}
    if resets:
        columns.setdefault("rst", np.zeros_like(next(iter(columns.values()))))
    return {
        name: np.concatenate([np.full(RESET_CLOCKS, int(name == "rst")), column])
        for name, column in columns.items()
    }


def changed(
    columns: Sequence[tuple[Callable[[int], None], np.ndarray]],
) -> Iterator[Iterable[tuple[Callable[[int], None], int]]]:
    """For every clock, the (port, value) pairs that differ from the clock before."""
    before: tuple[int | None, ...] = (None,) * len(columns)
    for now in zip(*(values.tolist() for _, values in columns), strict=True):
        changes = zip(columns, now, before, strict=True)
        yield [(write, value) for (write, _), value, old in changes if value != old]
        before = now
