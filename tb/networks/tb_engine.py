"""engine, a whole scene on one multiplier or several, against its twin.

Besides the tests of tb/common/network.py: if the engine can be reloaded, images of its own, of
shipped scenes and of other sizes come before, between and in the middle of frames, with a few
wrong ones among them, and with resets. The twin executes the words of the program, or those that
are loaded.
"""

from contextlib import suppress

import numpy as np

from golden.input_error import InputError
from golden.numbers.precision import SIGNAL
from tb.common.bench import Bench, test_of
from tb.common.case_library import cases
from tb.common.cases import random_mlp
from tb.common.framing import whole
from tb.common.images import images_with_room
from tb.common.images import networks_of_other_depth as other_depths
from tb.common.images import networks_of_other_functions as other_functions
from tb.common.loading import Sent, check_images, check_loading, exchange, loaded, traffic
from tb.common.network import TESTS
from tb.common.properties import Property
from tb.common.stimulus import random_resets, spread
from tb.common.watch import busy_of, frames_computed
from tb.engine.stream_proof import frame_check, frame_guard, image_loader

CASES = cases(
    *("engines", "lanes", "layered", "tables", "learned", "reloaded", "reloaded-lanes"),
)
# The first case and this one have one lane, with one memory for all; here is a layer of ReLU and
# one of tanh. Then come several lanes with a table, and with ReLU and none.
ALSO = ("steep-engine", "rails-lanes", "relu-lanes")
# Several lanes read their steps from a part that one lane does not have.
COMPARED = ("rails-lanes",)
# Several layers; three lanes; registers behind the memories; and programs that are loaded, into one
# lane and into several.
PROVED = ("steep-engine", "rails-lanes", "deep-engine", "rails-reload", "rails-lanes-reload")
# The proof for every frame shows what the program and the lanes compute.
SHOWN_BY_FRAMES = ("lane_accumulate", "lane_memory", "lane_round", "program_memory")
# The runner gives these to the bench. They have other arrangements, and another number of samples.
SCENES = ("digit-single", "digit-multiple", "swing-single")

recorded, corners_and_random, wrong_lengths, resets_in_mid_frame, reset_at_every_clock = TESTS


def frames_of(bench, frames, after):
    """A timeline of frames as close as the twin takes them, which starts after ``after`` clocks."""
    count, inputs = frames.shape
    pause = np.zeros((count, inputs), dtype=np.int64)
    pause[:, 0] = bench.twin.interval - inputs
    pause[0, 0] = after
    items = dict(zip(("in_data", "in_last"), whole(frames), strict=True))
    tail = bench.twin.output_clocks[-1] + 5
    return spread(bench.rng, items, "in_valid", 0.0, tail, pause.ravel())


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


def samples_of_every_bit(hardware):
    """Two networks; each bit of the number of samples is 1 in one and 0 in the other."""
    sizes = hardware.loaded.sizes
    every_other = sum(1 << bit for bit in range(0, sizes.operand_addr_width, 2))
    twos = every_other, sizes.operand_words - 1 - every_other
    return [random_mlp((less_two + 2, 2, 1), 1.0, seed=less_two) for less_two in twos]


@test_of(loaded)
async def other_networks(dut):
    """Load networks of other sizes, depths and functions, and compare random frames behind each."""
    bench = Bench(dut)
    hardware = bench.twin
    groups = [samples_of_every_bit(hardware)]
    if hardware.rectifies:
        groups.append(other_depths(bench.given.networks[0].layers[0].quantiser))
    if hardware.loaded.sizes.table_blocks:
        groups.append(other_functions())
    images = [image for group in groups for image in images_with_room(hardware, group)]
    for number, image in enumerate(images):
        bench.twin = hardware.running(image)
        count = max(8, min(20, 2000 // image.inputs))
        codes = bench.rng.integers(SIGNAL.low, SIGNAL.high + 1, (count, image.inputs))
        drive = frames_of(bench, codes, after=len(bench.twin.image) + 2)
        counts = check_loading(bench, await exchange(bench, drive, [Sent(0, bench.twin.image)]))
        assert counts == [count], f"network {number}: got {counts} frames"
    bench.finish(at_least=8 * len(images))


@test_of(loaded)
async def images_at_any_time(dut):
    """Load images of two scenes and wrong ones at any time."""
    bench = Bench(dut)
    own = bench.twin.image
    shipped = shipped_with_room(bench.twin, bench.given.shipped)
    *_, other = own, *(image.to_bytes() for _, image in shipped)
    await check_images(bench, own, other)
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


def properties(twin):
    """Of an engine that takes images whatever these hold; otherwise with the program as it is.

    They do not cover what the data paths compute, nor that each operand is there when a step reads
    it: the proof for every frame shows both. A program has no branches, so its clocks are the same
    for every frame.
    """
    if twin.loaded:
        return [*no_half_image(twin), placed(twin)]
    return built_in(twin)


def no_half_image(twin):
    return [
        Property(
            name="no half image",
            sentence="A frame starts, and is computed, only while the last image that came was "
            "whole and had the right check, and no byte of another has been taken since. So the "
            "program memory is never written from the start of a frame to its last output.",
            states=(
                "!(start || run) || u_image_loader_0.whole",
                "!(start || run) || !(halt || put || u_image_loader_0.accept)",
            ),
            helps=busy_of(twin),
            # The program in the memory and the check of an image may be anything.
            free=("word", "u_image_loader_0.check"),
            reached=("start",),
            refuted_by=(
                (r"(?s)(frame_guard u_frame_guard_0 .*?\.halt)\(halt\)", r"\1(1'b0)"),
                (r"\.busy\(busy\)", ".busy(1'b0)"),
                (r"accept \|\| \(!whole\)", "!whole"),
            ),
            clocks=18,
        )
    ]


def built_in(twin):
    """The properties of an engine with a known program, of which every clock is known too."""
    program, inputs = twin.program, twin.inputs
    at, late, begin = (
        program.pipeline,
        program.pipeline.memory_registers,
        program.begin * twin.alone,
    )
    outputs = " || ".join(f"since == {clock}" for clock in twin.output_clocks)
    # A single lane has a memory of its own kind, in which every other word is one of the program.
    here, place = ("lane_alone0_", 2) if twin.alone else ("u_program_memory_0.", 1)

    def behind(clocks):
        """The address that is read so many clocks after the counter left the first one."""
        return f"(since > {clocks} ? {begin - clocks} + since : {begin})"

    # ``fetched_from`` is the address of the word that is there while ``run`` is high.
    read = f"""
        reg [15:0] read_from, fetched_from;
        always @(posedge clk) begin
            read_from <= {here}counter;
            fetched_from <= {"read_from" if late else f"{here}counter"};
        end
    """
    helps = [
        f"run == (since >= {at.run}) && finish == (since == {twin.busy})",
        *(("start == (since == 1)", "u_frame_check_0.waiting == start") if at.run > 1 else ()),
        f"since <= {twin.busy} && samples < {inputs} && (since == 0 || samples == 0)",
        "u_frame_check_0.dropping == skipping",
        f"since != 0 || u_frame_check_0.addr == (samples == 0 ? {(1 << twin.addr_width) - 1} "
        ": samples - 1)",
        f"{here}counter == {behind(at.run - 1)}",
        f"since < {at.run} || fetched_from == {behind(at.begin)}",
        f"since < {at.run} || word == {here}memory[{place} * fetched_from]",
    ]
    if late:
        helps += [
            f"since == 0 || read_from == {behind(at.run)}",
            f"since == 0 || {here}fetched == {here}memory[{place} * read_from]",
        ]
    return [
        Property(
            name="outputs of good frames",
            sentence="Each good frame, and nothing else, yields outputs in the clocks "
            f"{', '.join(map(str, twin.output_clocks))} after its last sample, the last one with "
            "out_last. frame_error is high for one clock for each wrong frame, which yields no "
            "output.",
            states=(
                f"out_valid == ({outputs})",
                f"out_valid || since != {twin.busy}",
                f"!out_valid || out_last == (since == {twin.output_clocks[-1]})",
                "frame_error == told",
            ),
            watch=frames_computed(inputs, twin.busy, "samples") + read,
            helps=tuple(helps),
            reached=("since == 2",),
            refuted_by=(
                (r"out_valid <= leaves", "out_valid <= (leaves || start)"),
                (r"complete != in_last", "complete && !in_last"),
            ),
            clocks=inputs + 9,
            induction=5,
        )
    ]


def placed(twin):
    """Where the words of an image go."""
    sizes, lanes = twin.loaded.sizes, range(twin.lanes)
    table, columns = sizes.table_words, sizes.columns
    own = [f"behind && column == {1 + lane // 2}" for lane in lanes]
    high = [f"put_word[{18 * (lane % 2) + 17}:{18 * (lane % 2)}]" for lane in lanes]
    return Property(
        name="words where they belong",
        sentence=f"The first {table} words of an image are written to the tables of every lane. "
        f"Behind them are rows of {columns} words: the first is that of the program, and in each "
        "further one there are the weights of two lanes, at the place of the row.",
        states=(
            "put_program == (put && behind && column == 0)",
            *(f"lane_put_{n} == (put && (!behind || ({own[n]})))" for n in lanes),
            f"!behind || (row == number && lane_addr == {sizes.program_words} + number)",
            "behind || lane_addr == put_addr",
            *(f"lane_word_{n} == {high[n]}" for n in lanes),
        ),
        watch=f"""
            wire [31:0] address = put_addr;
            wire behind = address >= {table};
            wire [31:0] number = (address - {table}) / {columns};
            wire [31:0] column = (address - {table}) % {columns};
        """,
        assumes={
            "No address is beyond those that an image may have, which image_loader proves.": (
                f"put_addr < {sizes.words}"
            )
        },
        free=("put", "put_addr", "put_word"),
        reached=("put_program && row == 3", "put && !behind"),
        refuted_by=(
            (r"put_addr\[\d+-1:\d+\] - 1\)", "put_addr[10:9])"),
            (r"lane_put_0 = .*;", "lane_put_0 = put;"),
            *[(r"lane_word_1 = .*;", "lane_word_1 = put_word[17:0];")] * (twin.lanes > 1),
        ),
        clocks=2,
    )


OF_PARTS = {
    "frame_check": frame_check,
    "frame_guard": frame_guard,
    "image_loader": image_loader,
}
