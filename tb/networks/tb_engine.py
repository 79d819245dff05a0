"""engine, a whole scene on one multiplier or on none, against its twin.

Sweeps: all recorded frames of the scene; corner frames (rails, alternating rails, zeros, one
sensor alone); frames that drive each hidden sum to its ends; 100 random frames; frames too short
and too long among good ones. Where it can be reloaded: its own image, those of shipped scenes and
of other numbers of samples; images that are cut, too long, changed in one bit, for other hardware,
or without an end.
Drives: as close as the design takes frames, with random gaps, closer than it takes them, with
resets in mid-frame, and with one reset at each clock of a frame, of a long one at many. Where it
can be reloaded: images before, between and in the middle of frames, bytes with gaps, resets in
mid-load.
Checks: every output, ``out_last`` and ``frame_error`` bit for bit in its clock, and that nothing
comes out in any other clock; ``load_ready`` and ``image_error`` too. The twin executes the words
that were loaded. Measures the clocks of a frame.
Does not prove: anything about the accuracy of the network (the report of `make demo` does).
"""

import cocotb
import numpy as np

from golden.precision import SIGNAL
from golden.scene import load_scene
from golden.scene.image import scene_image
from tb.common.bench import Bench
from tb.common.framing import random_lengths
from tb.common.images import image_for
from tb.common.loading import Sent, check_loading, exchange
from tb.common.network import (
    corners_and_random,
    recorded,
    reset_at_every_clock,
    resets_in_mid_frame,
    wrong_lengths,
)
from tb.common.small import ENGINES, LAYERED, RELOADED, SERIAL_ENGINES
from tb.common.stimulus import random_resets, spread

# Without a multiplier the sum is another; what stands around it is the same.
SERIAL = {n: SERIAL_ENGINES[n] for n in ("rails-serial", "least-serial", "chain-serial")}
CASES = RELOADED | ENGINES | LAYERED | SERIAL
FAULTS = [
    (r"first_bit|word\[31\]", "word[30]"),
    (r"out_valid <= .*;", "out_valid <= leaves;"),
    (r"(?s)(frame_guard u_frame_guard_0 .*?\.halt)\(halt\)", r"\1(1'b0)"),
    (r"\.busy\(busy\)", ".busy(1'b0)"),
]
# Other arrangements, and another number of samples.
SCENES = ("digit-single", "digit-multiple", "swing-single")

__all__ = [
    "corners_and_random",
    "recorded",
    "reset_at_every_clock",
    "resets_in_mid_frame",
    "wrong_lengths",
]


def frames_of(bench, frames, after):
    """A timeline of frames as close as the twin takes them, ``after`` clocks from its begin."""
    count, inputs = frames.shape
    pause = np.zeros((count, inputs), dtype=np.int64)
    pause[:, 0] = bench.twin.interval - inputs
    pause[0, 0] = after
    last = np.zeros((count, inputs), dtype=np.int64)
    last[:, -1] = 1
    items = {"in_data": frames.ravel(), "in_last": last.ravel()}
    tail = bench.twin.output_clocks[-1] + 5
    return spread(bench.rng, items, "in_valid", 0.0, tail, pause.ravel())


def traffic(bench, samples, most):
    """Frames of the right length, and some shorter and longer, up to ``most`` clocks apart."""
    twin, rng = bench.twin, bench.rng
    last = random_lengths(rng, twin.inputs, samples)
    data = rng.integers(SIGNAL.low, SIGNAL.high + 1, samples if len(last) < samples else len(last))
    pause = np.roll(last, 1) * rng.integers(0, most + 1, len(last))
    tail = twin.output_clocks[-1] + 5
    return spread(rng, {"in_data": data, "in_last": last}, "in_valid", 0.1, tail, pause)


def wrong_images(rng, image):
    """Byte streams that are not the image: each must be refused."""
    cuts = [1, 4, 5, 6, len(image) // 2, len(image) - 2, len(image) - 1]
    wrong = [image[:count] for count in cuts]
    wrong += [image + bytes(count) for count in (1, 2, 3, 5, 7)]
    # The header's fields, a word, the last word to come, and the check.
    for place in (1, 2, 3, 4, len(image) // 2, len(image) - 3, len(image) - 2, len(image) - 1):
        changed = bytearray(image)
        changed[place] ^= 1 << rng.integers(0, 8)
        wrong.append(bytes(changed))
    return wrong


@cocotb.test()
async def images_one_after_the_other(dut):
    """Its own image and those of shipped scenes, each with its recorded frames."""
    bench = Bench(dut)
    if not bench.twin.image:
        return
    hardware = bench.twin
    for scene in (bench.scene, *map(load_scene, SCENES)):
        bench.twin = hardware.running(scene_image(scene, hardware))
        codes = scene.vectors().codes[: bench.frames]
        image = bench.twin.image
        drive = frames_of(bench, codes, after=len(image) + 2)
        recording = await exchange(bench, drive, [Sent(0, image)])
        counts = check_loading(bench, recording)
        assert counts == [len(codes)], f"{scene.name}: got {counts} frames, sent {len(codes)}"
    bench.finish(at_least=bench.frames)


@cocotb.test()
async def other_numbers_of_samples(dut):
    """Each bit of the number that the image names is 1 in one of two and 0 in the other."""
    bench = Bench(dut)
    if not bench.twin.image:
        return
    hardware = bench.twin
    sizes = hardware.loaded.sizes
    every_other = sum(1 << bit for bit in range(0, sizes.operand_addr_width, 2))
    for less_two in (every_other, sizes.operand_words - 1 - every_other):
        image = image_for(hardware, (less_two + 2, 2, 1), seed=less_two)
        bench.twin = hardware.running(image)
        codes = bench.rng.integers(SIGNAL.low, SIGNAL.high + 1, (8, less_two + 2))
        drive = frames_of(bench, codes, after=len(bench.twin.image) + 2)
        recording = await exchange(bench, drive, [Sent(0, bench.twin.image)])
        counts = check_loading(bench, recording)
        assert counts == [len(codes)], f"{less_two + 2} samples: got {counts} frames"
    bench.finish(at_least=16)


@cocotb.test()
async def wrong_images_among_good_ones(dut):
    """No frame is taken from the first byte of an image on that is not good."""
    bench = Bench(dut)
    if not bench.twin.image:
        return
    rng, image = bench.rng, bench.twin.image
    sent, at, sound = [Sent(0, image)], 0, 1
    for wrong in wrong_images(rng, image):
        good = rng.random() < 0.3
        sent += [Sent(at, wrong)] + [Sent(at, image)] * good
        sound += good
        at += len(wrong) + good * len(image) + int(rng.integers(0, 300))
    # Broken off without a last byte: the next image is part of it, the one after is good.
    sent += [Sent(at, image[:50], closed=False), Sent(at, image), Sent(at, image)]
    samples = (at + 3 * len(image)) // 10
    recording = await exchange(bench, traffic(bench, samples, most=80), sent)
    counts = check_loading(bench, recording)
    assert len(counts) == sound + 1, f"got {len(counts)} good images, sent {sound + 1}"
    assert sum(counts), "no frame was computed"
    bench.finish(at_least=100)


@cocotb.test()
async def frames_while_loading(dut):
    """Images in the middle of frames and of their computation, of two scenes in turn."""
    bench = Bench(dut)
    if not bench.twin.image:
        return
    rng = bench.rng
    other = scene_image(load_scene(SCENES[-1]), bench.twin).to_bytes()
    sent, at = [], 0
    for number in range(12):
        data = other if number % 4 == 3 else bench.twin.image
        sent.append(Sent(at, data, gap=0.3 * (number % 2)))
        at += 2 * len(data) + int(rng.integers(0, 400))
    drive = traffic(bench, at // 5, most=40)
    counts = check_loading(bench, await exchange(bench, drive, sent))
    assert len(counts) == len(sent), f"got {len(counts)} good images, sent {len(sent)}"
    assert sum(counts), "no frame was computed"
    bench.finish(at_least=100)


@cocotb.test()
async def resets_while_loading(dut):
    """Resets at random clocks, also in mid-load; each forgets the image."""
    bench = Bench(dut)
    if not bench.twin.image:
        return
    image = bench.twin.image
    sent = [Sent(at, image) for at in range(0, 24 * len(image), 2 * len(image))]
    drive = traffic(bench, 4 * len(image), most=40)
    drive["rst"] = random_resets(bench.rng, len(drive["in_valid"]), every=3 * len(image))
    counts = check_loading(bench, await exchange(bench, drive, sent))
    assert sum(counts), "no frame was computed"
    bench.finish(at_least=100)
