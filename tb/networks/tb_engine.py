"""engine, a whole scene on one multiplier or several, against its twin.

Sweeps: all recorded frames of the scene; corner frames (rails, alternating rails, zeros, one sensor
at a rail); frames that drive each hidden sum to both of its ends; 100 random frames; frames that
are too short or too long among good frames. If the engine can be reloaded: its own image, images of
shipped scenes, images with other numbers of samples and, where it has ReLU, images of networks with
one to four hidden layers; where it has blocks of tables, images of networks with other functions;
images that are cut, too long, changed in one bit, for other hardware, or without an end; wrong
images whose check matches, wholly or in part.
Drives: frames as close as the design takes them, with random gaps, closer than it takes them, with
resets in mid-frame, and with one reset at each clock of a frame, or at many clocks of a long frame.
If the engine can be reloaded: images before, between and in the middle of frames, bytes with gaps,
and resets while an image is loaded.
Checks: every output, ``out_last`` and ``frame_error`` bit for bit in its clock, and that no output
comes in any other clock; ``load_ready`` and ``image_error`` too. The twin executes the words of the
program and of the lanes, or those that are loaded. The bench also measures the clocks of a frame.
Does not prove: how accurate the network is (the report of `make demo` shows that).
"""

from contextlib import suppress

import numpy as np

from golden.engine.image import CHECK_BYTES, WORD_BYTES
from golden.input_error import InputError
from golden.numbers.precision import SIGNAL
from golden.trained.dense import layers_of
from tb.common.bench import Bench, test_of
from tb.common.case_library import (
    ENGINES,
    LANES,
    LAYERED,
    LEARNED,
    RELOADED,
    RELOADED_LANES,
    TABLES,
)
from tb.common.cases import random_mlp
from tb.common.framing import random_lengths
from tb.common.images import fitting_checks, images_with_room
from tb.common.images import networks_of_other_depth as other_depths
from tb.common.images import networks_of_other_functions as other_functions
from tb.common.loading import Sent, check_loading, exchange, loaded
from tb.common.network import (
    corners_and_random,
    recorded,
    reset_at_every_clock,
    resets_in_mid_frame,
    wrong_lengths,
)
from tb.common.stimulus import random_resets, spread

CASES = ENGINES | LANES | LAYERED | TABLES | LEARNED | RELOADED | RELOADED_LANES
# The first case and this one have one lane, with one memory for all; here is a layer of ReLU and
# one of tanh. Then come several lanes with a table, and with ReLU and none. What quantised networks
# add is in lane_round alone, whose properties are proved of these.
ALSO = ("steep-engine", "rails-lanes", "relu-lanes")
# How many intervals of frames are left behind the last image at least.
BEHIND = 20
# The runner gives these to the bench. They have other arrangements, and another number of samples.
SCENES = ("digit-single", "digit-multiple", "swing-single")

__all__ = [
    "corners_and_random",
    "recorded",
    "reset_at_every_clock",
    "resets_in_mid_frame",
    "wrong_lengths",
]


def frames_of(bench, frames, after):
    """A timeline of frames as close as the twin takes them, which starts after ``after`` clocks."""
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
    """Frames of the right length and some shorter and longer ones, up to ``most`` clocks apart."""
    twin, rng = bench.twin, bench.rng
    last = random_lengths(rng, twin.inputs, samples)
    data = rng.integers(SIGNAL.low, SIGNAL.high + 1, samples if len(last) < samples else len(last))
    pause = np.roll(last, 1) * rng.integers(0, most + 1, len(last))
    tail = twin.output_clocks[-1] + 5
    return spread(rng, {"in_data": data, "in_last": last}, "in_valid", 0.1, tail, pause)


def wrong_images(rng, sizes, image):
    """Byte streams that differ from the image. Each must be refused."""
    cuts = [1, 4, 5, 6, len(image) // 2, len(image) - 2, len(image) - 1]
    wrong = [image[:count] for count in cuts]
    wrong += [image + bytes(count) for count in (1, 2, 3, 5, 7)]
    # The changed bytes are in the fields of the header, in a word, in the last word and in the
    # check.
    for place in (1, 2, 3, 4, len(image) // 2, len(image) - 3, len(image) - 2, len(image) - 1):
        changed = bytearray(image)
        changed[place] ^= 1 << rng.integers(0, 8)
        wrong.append(bytes(changed))
    words = (len(image) - CHECK_BYTES) // WORD_BYTES - 1
    return wrong + fitting_checks(sizes, image, words)


def shipped_with_room(hardware, shipped):
    """Those of the shipped scenes for whose networks the hardware has room, and their images."""
    for scene in shipped:
        with suppress(InputError):
            yield scene, hardware.image_for(scene.networks, scene.arrangement, scene.met)


@test_of(loaded)
async def images_one_after_the_other(dut):
    """Load the own image and those of shipped scenes, and play the recorded frames of each."""
    bench = Bench(dut)
    hardware = bench.twin
    shipped = shipped_with_room(hardware, bench.given.shipped)
    for scene, image in ((bench.given, hardware.loaded), *shipped):
        bench.twin = hardware.running(image)
        codes = scene.codes[: bench.frames]
        image = bench.twin.image
        drive = frames_of(bench, codes, after=len(image) + 2)
        recording = await exchange(bench, drive, [Sent(0, image)])
        counts = check_loading(bench, recording)
        assert counts == [len(codes)], f"{scene.name}: got {counts} frames, sent {len(codes)}"
    bench.finish(at_least=bench.frames)


async def load_and_play(bench, hardware, image, count, what):
    """Load an image, and check that random frames behind it are those of its network."""
    bench.twin = hardware.running(image)
    codes = bench.rng.integers(SIGNAL.low, SIGNAL.high + 1, (count, image.inputs))
    drive = frames_of(bench, codes, after=len(bench.twin.image) + 2)
    recording = await exchange(bench, drive, [Sent(0, bench.twin.image)])
    counts = check_loading(bench, recording)
    assert counts == [count], f"{what}: got {counts} frames"


def samples_of_every_bit(hardware):
    """Two networks; each bit of the number of samples is 1 in one and 0 in the other."""
    sizes = hardware.loaded.sizes
    every_other = sum(1 << bit for bit in range(0, sizes.operand_addr_width, 2))
    twos = every_other, sizes.operand_words - 1 - every_other
    return [random_mlp((less_two + 2, 2, 1), 1.0, seed=less_two) for less_two in twos]


@test_of(loaded)
async def other_numbers_of_samples(dut):
    """Load two images; each bit of the number of samples is 1 in one and 0 in the other."""
    bench = Bench(dut)
    hardware = bench.twin
    images = images_with_room(hardware, samples_of_every_bit(hardware))
    for image in images:
        await load_and_play(bench, hardware, image, 8, f"{image.inputs} samples")
    bench.finish(at_least=8 * len(images))


@test_of(lambda twin: loaded(twin) and twin.rectifies)
async def networks_of_other_depth(dut):
    """Load networks with one to four hidden layers one after the other, also some without ReLU."""
    bench = Bench(dut)
    hardware = bench.twin
    network, *_ = bench.given.networks
    images = images_with_room(hardware, other_depths(layers_of(network)[0].quantiser))
    for number, image in enumerate(images):
        await load_and_play(bench, hardware, image, 20, f"network {number}")
    bench.finish(at_least=20 * len(images))


@test_of(lambda twin: loaded(twin) and twin.loaded.sizes.table_blocks)
async def networks_of_other_functions(dut):
    """Load networks one after the other, each with tables of its own."""
    bench = Bench(dut)
    hardware = bench.twin
    images = images_with_room(hardware, other_functions())
    for number, image in enumerate(images):
        await load_and_play(bench, hardware, image, 20, f"network {number}")
    bench.finish(at_least=20 * len(images))


@test_of(loaded)
async def wrong_images_among_good_ones(dut):
    """Check that no frame is taken from the first byte of a wrong image on."""
    bench = Bench(dut)
    rng, image = bench.rng, bench.twin.image
    sent, at, sound = [Sent(0, image)], 0, 1
    for wrong in wrong_images(rng, bench.twin.loaded.sizes, image):
        good = rng.random() < 0.3
        sent += [Sent(at, wrong)] + [Sent(at, image)] * good
        sound += good
        at += len(wrong) + good * len(image) + int(rng.integers(0, 300))
    # Broken off without a last byte: the next image is part of it, the one after is good.
    sent += [Sent(at, image[:50], closed=False), Sent(at, image), Sent(at, image)]
    samples = (at + 3 * len(image)) // 10
    drive = traffic(bench, samples, most=80)
    # Long images leave few clocks between them, so frames must also come behind the last one.
    clocks = sum(len(one.data) for one in sent) + BEHIND * bench.twin.interval
    while len(drive["in_valid"]) < clocks:
        samples += len(image) // 10
        drive = traffic(bench, samples, most=80)
    recording = await exchange(bench, drive, sent)
    counts = check_loading(bench, recording)
    assert len(counts) == sound + 1, f"got {len(counts)} good images, sent {sound + 1}"
    assert sum(counts), "no frame was computed"
    bench.finish(at_least=100)


@test_of(loaded)
async def frames_while_loading(dut):
    """Load images of two scenes in turn, in the middle of frames and of their computation."""
    bench = Bench(dut)
    rng = bench.rng
    shipped = shipped_with_room(bench.twin, bench.given.shipped)
    *_, other = bench.twin.image, *(image.to_bytes() for _, image in shipped)
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


@test_of(loaded)
async def resets_while_loading(dut):
    """Play resets at random clocks, also during loading. Each reset discards the image."""
    bench = Bench(dut)
    image = bench.twin.image
    sent = [Sent(at, image) for at in range(0, 24 * len(image), 2 * len(image))]
    drive = traffic(bench, 4 * len(image), most=40)
    drive["rst"] = random_resets(bench.rng, len(drive["in_valid"]), every=3 * len(image))
    counts = check_loading(bench, await exchange(bench, drive, sent))
    assert sum(counts), "no frame was computed"
    bench.finish(at_least=100)
