"""Loads images into an engine that can be reloaded, and checks what it then computes."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, repeat

import numpy as np

from golden.common.block import Block
from golden.engine.image import Image
from tb.common.bench import (
    RESET_CLOCKS,
    Bench,
    Recording,
    changed,
    each_half,
    from_reset,
    reader,
    writer,
)

WATCH = ["out_valid", "out_data", "out_last", "frame_error", "load_ready", "image_error"]


@dataclass(frozen=True)
class Sent:
    """Bytes that are offered to the loader one after the other.

    at: The clock from which on the first byte is offered.
    closed: Whether the last byte comes with ``load_last``.
    gap: The probability that no byte is offered in a clock.
    """

    at: int
    data: bytes
    closed: bool = True
    gap: float = 0.0


def loaded(twin: Block) -> bool:
    """Whether an image is loaded into the hardware."""
    return bool(twin.image)


def after_loading(drive: dict[str, np.ndarray], image: bytes) -> dict[str, np.ndarray]:
    """A timeline in which the image is loaded at the start and after each reset.

    The stream is empty while the image is loaded.
    """
    length = len(drive["in_valid"])
    resets = drive.get("rst", np.zeros(length, dtype=np.int64))
    ends = np.flatnonzero((resets == 1) & (np.append(resets[1:], 0) == 0)) + 1
    places = np.repeat(np.concatenate([[0], ends]), len(image))
    quiet = {name: np.insert(np.asarray(column), places, 0) for name, column in drive.items()}
    rounds = len(places) // len(image)
    last = np.zeros(len(image), dtype=np.int64)
    last[-1] = 1
    added = {"load_valid": np.ones_like(last), "load_data": np.frombuffer(image, np.uint8)}
    for name, column in (added | {"load_last": last}).items():
        zeros = np.zeros(length, dtype=np.int64)
        quiet[name] = np.insert(zeros, places, np.tile(column, rounds))
    return quiet


def untaught(bench: Bench, drive: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """A timeline in which an engine that learns keeps no placement, though it may learn.

    All known outputs that come are of the wrong length, so there is nothing to learn from.
    """
    length, added = len(drive["in_valid"]), {}
    for port in bench.twin.core.lesson_ports:
        if port.direction == "in":
            low, high = (0, 1) if port.kind is None else (port.kind.low, port.kind.high)
            added[port.name] = bench.rng.integers(low, high + 1, length)
    if added:
        several = bench.twin.core.outputs > 1
        added["target_last"] = np.where(added["target_valid"], several, added["target_last"])
    return drive | added


async def exchange(bench: Bench, drive: dict[str, np.ndarray], sent: Sequence[Sent]) -> Recording:
    """Play a timeline and send bytes in their order. Each byte is offered until it is taken.

    A byte that is offered during a reset is lost.
    """
    dut = bench.dut
    columns = from_reset(drive, resets=True)
    ports = [*columns, "load_valid", "load_data", "load_last", *WATCH]
    read, taking, reset = reader(dut, ports), ports.index("load_ready"), ports.index("rst")
    changes = changed([(writer(dut, name), column) for name, column in columns.items()])
    driven = ("clk", "load_valid", "load_data", "load_last")
    drive_clock, valid, data, final = (writer(dut, name) for name in driven)
    queue = [
        (one.at + RESET_CLOCKS, byte, one.closed and place == len(one.data) - 1, one.gap)
        for one in sent
        for place, byte in enumerate(one.data)
    ]
    words: list[str] = []
    clocks = len(columns["rst"])

    def halves() -> Iterator[None]:
        at, offered = 0, False
        # While a frame is computed bytes wait, so some may be left when the timeline ends. Then no
        # frame comes any more, and four clocks are enough for a byte that comes with gaps.
        for clock, change in enumerate(chain(changes, repeat((), 4 * len(queue)))):
            if clock >= clocks and at == len(queue):
                break
            drive_clock(0)
            for write, value in change:
                write(value)
            if not offered and at < len(queue) and clock >= queue[at][0]:
                offered = bench.rng.random() >= queue[at][3]
            if at < len(queue):
                # While nothing is offered, the port shows another byte, which must have no effect.
                _, byte, last, _ = queue[at if offered else (at + 7) % len(queue)]
                data(byte)
                final(int(last))
            valid(int(offered))
            yield
            row = read()
            words.extend(row)
            if offered and "1" in (row[reset], row[taking]):
                at, offered = at + 1, False
            drive_clock(1)
            yield

    started = time.perf_counter()
    await each_half(halves())
    return bench.watched(Recording(ports, words, time.perf_counter() - started))


def check_loading(bench: Bench, recording: Recording) -> list[int]:
    """Compare every output with what the twins compute from samples and bytes.

    Returns: For each image that was found good, how many frames were computed with it.
    """
    twin = bench.twin
    rows = np.arange(RESET_CLOCKS, recording.clocks)
    names = ("in_valid", "in_last", "load_valid", "load_data", "load_last", "load_ready", "rst")
    read = {name: recording.unsigned(name, rows) for name in names}
    loading = twin.image_loader.process(
        *(read[name] for name in ("load_valid", "load_data", "load_last")),
        1 - read["load_ready"],
        read["rst"],
    )
    images = [
        Image(twin.loaded.sizes, (before + 2) % twin.loaded.sizes.operand_words, tuple(words))
        for _, before, words in loading.good
    ]
    since = np.array([clock for clock, _, _ in loading.good], dtype=np.int64)
    # The image that is loaded in each clock. Before the first image no frame is taken.
    place = np.searchsorted(since, np.arange(len(rows))) - 1
    before_last = np.array([0, *(before for _, before, _ in loading.good)])[place + 1]
    last_out = np.isin(rows, recording.rows("out_last"))
    guarded = twin.frame_guard.process(
        read["in_valid"],
        read["in_last"],
        loading.halt,
        before_last,
        np.zeros_like(rows),
        last_out,
        read["rst"],
    )
    bench.compare("load_ready", read["load_ready"], ~guarded.busy, clock=rows)
    found = recording.rows("image_error")
    bench.compare("clocks of image_error", found, rows[loading.image_error])
    bench.compare("clocks of frame_error", recording.rows("frame_error"), rows[guarded.frame_error])

    samples = np.flatnonzero(read["in_valid"])
    codes = recording.signed("in_data", rows[samples])
    ends = np.flatnonzero(guarded.done)
    expected = [np.empty((0, 3), dtype=np.int64)]
    counts = []
    for number, image in enumerate(images):
        running = twin.running(image)
        chosen = ends[place[ends] == number]
        counts.append(len(chosen))
        at = np.searchsorted(samples, chosen)
        frames = codes[at[:, np.newaxis] + np.arange(1 - running.inputs, 1)]
        leave = chosen[:, np.newaxis] + np.array(running.output_clocks)
        last = np.zeros_like(leave)
        last[:, -1] = 1
        results = running.process(frames)
        # A reset between the last sample and an output stops this output.
        alive = recording.undisturbed(
            rows[np.repeat(chosen, running.outputs)], rows[0] + leave.ravel() - 1
        )
        alive &= leave.ravel() < len(rows)
        expected.append(np.stack([leave.ravel(), results.ravel(), last.ravel()], axis=1)[alive])
    due = np.concatenate(expected)
    at = rows[0] + due[:, 0]
    bench.compare_stream(recording, at, due[:, 1], due[:, 2] == 1, clock=at)
    return counts
