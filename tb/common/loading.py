"""Loads images into an engine that can be reloaded, and checks what it then computes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from golden.common.block import Block
from golden.networks.engine import Engine
from golden.numbers.precision import SIGNAL
from tb.common.bench import RESET_CLOCKS, Bench, Offer, Recording
from tb.common.framing import check_outputs, random_lengths
from tb.common.stimulus import spread

WATCH = ["out_valid", "out_data", "out_last", "frame_error", "image_error"]


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
    queue = [(one, place) for one in sent for place in range(len(one.data))]

    def wants(clock: int, at: int) -> bool:
        one = queue[at][0]
        return clock >= one.at and bool(bench.rng.random() >= one.gap)

    ends = [one.closed and place == len(one.data) - 1 for one, place in queue]
    data = np.array([one.data[place] for one, place in queue])
    items = {"data": data, "last": np.array(ends, dtype=np.int64)}
    # While a frame is computed bytes wait, so some may be left when the timeline ends. Then no
    # frame comes any more, and four clocks are enough for a byte that comes with gaps.
    return await bench.play(drive, WATCH, Offer("load_", items, wants, 4 * len(queue)))


def computed(engine: Engine, valid, last, load, busy, last_out, clears):
    """What loader and guard of an engine make of columns of its inputs.

    load: The columns of load_valid, load_data and load_last.
    busy, last_out: Where a frame is computed, and where its last output leaves.

    Returns their columns, and for each good image the engine that runs it and the clocks of the
    last samples of the frames that are computed with it.
    """
    loading = engine.image_loader.process(*load, busy, clears)
    since = np.array([clock for clock, _ in loading.good], dtype=np.int64)
    images = [engine.received(data) for _, data in loading.good]
    # The image that is loaded in each clock. Before the first image no frame is taken.
    place = np.searchsorted(since, np.arange(len(valid))) - 1
    before_last = np.array([0, *(image.inputs - 2 for image in images)])[place + 1]
    guarded = engine.frame_guard.process(valid, last, loading.halt, before_last, last_out, clears)
    ends = np.flatnonzero(guarded.done)
    return (
        loading,
        guarded,
        [(engine.running(i), ends[place[ends] == n]) for n, i in enumerate(images)],
    )


def check_loading(bench: Bench, recording: Recording) -> list[int]:
    """Compare every output with what the twins compute from samples and bytes.

    Returns: For each image that was found good, how many frames were computed with it.
    """
    rows = np.arange(RESET_CLOCKS, recording.clocks)
    names = ("in_valid", "in_last", "load_valid", "load_data", "load_last", "load_ready", "rst")
    valid, last, *load, ready, clears = (recording.unsigned(name, rows) for name in names)
    last_out = np.isin(rows, recording.rows("out_last"))
    loading, guarded, runs = computed(bench.twin, valid, last, load, 1 - ready, last_out, clears)
    bench.compare("load_ready", ready, ~guarded.busy, clock=rows)
    found = recording.rows("image_error")
    bench.compare("clocks of image_error", found, rows[loading.image_error])
    bench.compare("clocks of frame_error", recording.rows("frame_error"), rows[guarded.frame_error])
    samples = np.flatnonzero(valid)
    codes = recording.signed("in_data", rows[samples])
    due = [
        (
            network,
            rows[ends],
            rows[ends],
            codes[at[:, np.newaxis] + np.arange(1 - network.inputs, 1)],
        )
        for network, ends in runs
        for at in [np.searchsorted(samples, ends)]
    ]
    check_outputs(bench, recording, *due)
    return [len(ends) for _, ends in runs]


def traffic(bench, samples, most):
    """Frames of the right length and some shorter and longer ones, up to ``most`` clocks apart."""
    twin, rng = bench.twin, bench.rng
    last = random_lengths(rng, twin.inputs, samples)
    data = rng.integers(SIGNAL.low, SIGNAL.high + 1, samples if len(last) < samples else len(last))
    pause = np.roll(last, 1) * rng.integers(0, most + 1, len(last))
    tail = twin.output_clocks[-1] + 5
    return spread(rng, {"in_data": data, "in_last": last}, "in_valid", 0.1, tail, pause)


def wrong_images(rng, image):
    """Images that are cut, too long, or wrong in one bit: of every other it is proved."""
    changed = bytearray(image)
    changed[rng.integers(0, len(image))] ^= 1 << rng.integers(0, 8)
    return [image[:-1], bytes(changed), image + bytes(5), image[:6]]


async def check_images(bench: Bench, own: bytes, other: bytes) -> None:
    """Load two images in turn and wrong ones, in the middle of frames and of their computation.

    One is broken off without a last byte, so that the next image is part of it.
    """
    rng, wrong = bench.rng, wrong_images(bench.rng, own)
    sent, at = [], 0
    for number in range(12):
        data = [own, other, wrong[number // 3]][number % 3]
        sent.append(Sent(at, data, gap=0.3 * (number % 2)))
        at += 2 * len(data) + int(rng.integers(0, 400))
    sent += [Sent(at, own[:50], closed=False), Sent(at, own), Sent(at, own)]
    drive = traffic(bench, (at + 3 * len(own)) // 5, most=40)
    counts = check_loading(bench, await exchange(bench, drive, sent))
    assert len(counts) == 9, f"got {len(counts)} good images, sent 9"
    assert sum(counts), "no frame was computed"
