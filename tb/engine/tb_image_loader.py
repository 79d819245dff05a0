"""image_loader against its twin: good images among cut, longer, changed and foreign ones.

Some are wrong although their check matches, wholly or in part. ``busy`` makes bytes wait. That
every change of an image is found, no check of 16 bits can do.
"""

from dataclasses import replace

import cocotb
import numpy as np

from golden.engine.formats import WORD_WIDTH
from golden.engine.image import CHECK_BYTES, LAST_ADDR, WORD_BYTES, Image
from golden.networks.engine import Engine
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import RELOADED, RELOADED_LANES
from tb.common.images import fitting_checks, naming, with_check
from tb.common.properties import Property
from tb.common.stimulus import random_resets
from tb.common.watch import check_byte

CASES = RELOADED | RELOADED_LANES


def random_image(bench, words):
    """An image of so many random words."""
    sizes, rng = bench.around(Engine)[0].loaded.sizes, bench.rng
    inputs = int(rng.integers(1, sizes.operand_words))
    return Image(sizes, inputs, tuple(rng.integers(0, 1 << WORD_WIDTH, words).tolist()))


def matching(bench, words):
    """Wrong images of so many words, whose check, or a part of it, is right all the same."""
    sizes = bench.around(Engine)[0].loaded.sizes
    most, image = sizes.words, random_image(bench, words).to_bytes()
    sent = image[:-CHECK_BYTES]
    # The header names one word more than the memory has, or more by the size of the memory, or more
    # by a power of two. The low bits of the larger counts are those of the words that come.
    found = [naming(sizes, image, count) for count in (most + 1, most + words)]
    found += [naming(sizes, image, words + (1 << bit)) for bit in range(LAST_ADDR[1])]
    # Behind a header that does not fit comes the check at once, or a good image in the wrong place.
    found += [with_check(sizes, found[0][:WORD_BYTES] + more) for more in (b"", sent)]
    return found + fitting_checks(sizes, image, words)


def streams(bench):
    """The bytes of images, and whether each image is good."""
    rng = bench.rng
    sizes = bench.around(Engine)[0].loaded.sizes
    whole = [random_image(bench, words).to_bytes() for words in (1, 2, 3, 10, 25, 1)]
    image = whole[3]
    cuts = [1, 4, 5, 6, *range(len(image) - 6, len(image)), *rng.integers(1, len(image), 5)]
    wrong = [image[:count] for count in cuts]
    # The check of an image with its check is zero, and stays zero if zeros follow. The last of
    # these has as many bytes as a word after the image, and then another image of one word.
    wrong += [image + bytes(count) for count in range(1, 18)]
    for place in [*range(1, 6), *rng.integers(6, len(image), 20)]:
        changed = bytearray(image)
        changed[place] ^= 1 << rng.integers(0, 8)
        wrong.append(bytes(changed))
    other = replace(sizes, program_words=2 * sizes.program_words)
    wrong.append(Image(other, 3, (1, 2, 3)).to_bytes())
    wrong += [*matching(bench, 1), *matching(bench, 3)]
    found = [(data, True) for data in 4 * whole] + [(data, False) for data in wrong]
    order = rng.permutation(len(found))
    full = (random_image(bench, sizes.words).to_bytes(), True)
    return [found[n] for n in order] + [full, (whole[0], True)]


def offered(bench, sent):
    """The columns of the ports: a byte stays on them until ``busy`` is low."""
    rng = bench.rng
    rows = []
    for data in sent:
        gap = 0.4 * rng.integers(0, 2)
        for place, byte in enumerate(data):
            while rng.random() < gap:
                rows.append((0, rng.integers(0, 256), rng.integers(0, 2), rng.integers(0, 2)))
            waits = rng.geometric(0.8) - 1
            last = int(place == len(data) - 1)
            rows += [(1, byte, last, 1)] * waits + [(1, byte, last, 0)]
        idle = int(rng.integers(0, 4))
        rows += [(0, rng.integers(0, 256), rng.integers(0, 2), 0)] * idle
    columns = np.array(rows, dtype=np.int64).T
    return dict(zip(("load_valid", "load_data", "load_last", "busy"), columns, strict=True))


async def check(bench, drive):
    """Compare every port with the twin, and return how many images were good."""
    ports = ["load_ready", "halt", "write", "write_addr", "word", "before_last", "image_error"]
    recording = await bench.play(drive, ports)
    rows = np.arange(RESET_CLOCKS, recording.clocks)
    names = ("load_valid", "load_data", "load_last", "busy", "rst")
    read = {name: recording.unsigned(name, rows) for name in names}
    loading = bench.twin.process(*read.values())

    for name, expected in (
        ("load_ready", 1 - read["busy"]),
        ("halt", loading.halt),
        ("image_error", loading.image_error),
    ):
        bench.compare(name, recording.unsigned(name, rows), expected, clock=rows)
    before, last = bench.twin.states
    bench.visit(before, np.minimum(loading.before, before.values[-1]))
    bench.visit(last, loading.write_addr[loading.write])
    written = rows[loading.write]
    bench.compare("clocks of write", recording.rows("write"), written)
    for name in ("write_addr", "word"):
        expected = getattr(loading, name)[loading.write]
        bench.compare(name, recording.unsigned(name, written), expected, clock=written)
    for number, (clock, before_last, _) in enumerate(loading.good):
        end = loading.good[number + 1][0] if number + 1 < len(loading.good) else len(rows)
        open_rows = rows[clock + 1 : end][~loading.halt[clock + 1 : end]]
        got = recording.unsigned("before_last", open_rows)
        bench.compare("before_last", got, np.full(len(got), before_last), clock=open_rows)
    return len(loading.good)


@cocotb.test()
async def images(dut):
    bench = Bench(dut)
    sent = streams(bench)
    found = await check(bench, offered(bench, [data for data, _ in sent]))
    expected = sum(whole for _, whole in sent)
    assert found == expected, f"found {found} good images, sent {expected}"
    bench.finish(at_least=10000)


@cocotb.test()
async def resets(dut):
    bench = Bench(dut)
    sent = [random_image(bench, int(words)).to_bytes() for words in bench.rng.integers(1, 12, 80)]
    drive = offered(bench, sent)
    drive["rst"] = random_resets(bench.rng, len(drive["busy"]), every=100)
    found = await check(bench, drive)
    assert 0 < found < len(sent), f"found {found} good images of {len(sent)}"
    bench.finish(at_least=3000)


def properties(twin):
    addr, samples = twin.program_addr_width, twin.operand_addr_width
    last_part = WORD_BYTES - 1
    # Beyond any image that fits, words are not counted further.
    most = max(1000, twin.words + 2)
    low, bits = LAST_ADDR
    watch = f"""
        wire byte_taken = load_valid && !busy;
        // Whole words of this image so far, the header among them, and bytes of the next.
        reg [15:0] count = 0;
        reg [2:0] part = 0;
        reg [31:0] before;
        wire [39:0] together = {{before, load_data}};
        reg [39:0] header;
        reg [15:0] sum_before = {twin.check_start};
        reg [15:0] sum;
        reg image_is_good = 0, image_failed = 0;
        always @* begin
            sum = sum_before;
            {check_byte("load_data")}
        end
        wire [{bits}:0] words = header[{low + bits - 1}:{low}] + 1;
        wire room = words <= {twin.words};
        wire inside = count != 0 && room && count <= words;
        wire ends_good = count != 0 && room && count == words + 1 && part == 1 && sum == 0;
        always @(posedge clk) begin
            if (byte_taken) begin
                before <= together;
                sum_before <= load_last ? {twin.check_start} : sum;
                part <= load_last || part == {last_part} ? 0 : part + 1;
                if (load_last) count <= 0;
                else if (part == {last_part} && count != {most}) count <= count + 1;
                if (part == {last_part} && count == 0) header <= together;
                image_is_good <= load_last && ends_good;
                if (load_last) image_failed <= !ends_good;
            end
            if (rst) begin
                sum_before <= {twin.check_start};
                count <= 0;
                part <= 0;
                image_is_good <= 0;
                image_failed <= 0;
            end
        end
    """
    helps = (
        "check == sum_before",
        "whole == image_is_good",
        "failed == image_failed",
        "place == part",
        f"part <= {last_part} && count <= {most}",
        # The states are the header, the words, the check, and bytes that are too many.
        "count != 0 || (!headed && !ended)",
        f"!inside || (headed && !ended && addr == ((words - count) & {(1 << addr) - 1}))",
        "count == 0 || !room || count != words + 1 || (headed && ended)",
        "count == 0 || (room && count <= words + 1) || (!headed && ended)",
        "held == before[27:0]",
        f"count == 0 || !room || count > words + 1 || samples == header[{17 + samples}:18]",
    )
    # Both may be anything, but must be the same.
    same = {
        "Before the first byte, the register of bytes and its copy in the proof are equal.": (
            "after_reset || held == before[27:0]"
        )
    }
    return [
        Property(
            name="good images only",
            sentence="halt ends with the last byte of an image that names no more words than the "
            "memory has, that has all of them and no byte more, and whose check is right. It "
            "begins with the first byte of the next image. No other image ends it, and image_error "
            "says so.",
            states=("halt == (byte_taken || !image_is_good)", "image_error == image_failed"),
            watch=watch,
            helps=helps,
            assumes=same,
            reached=("count == 2 && byte_taken",),
            refuted_by=(
                (r"check\[8-1:0\] == 0\)", "1'b1)"),
                (r"headed && ended && \(place == 1\)", "headed && ended"),
                (r"whole <= \(load_last && good\)", "whole <= good"),
                (rf"fits = \(named < {twin.words}\)", "fits = 1'b1"),
                (r"accept \|\| \(!whole\)", "!whole"),
            ),
            clocks=14,
        ),
        Property(
            name="words in order",
            sentence="Each word that the header names is written once, with its last byte, from "
            "the last address to address 0, unless the header names more words than the memory "
            "has. Nothing else is written, and nothing is written while busy is high.",
            states=(
                f"write == (byte_taken && inside && part == {last_part})",
                f"!write || write_addr == ((words - count) & {(1 << addr) - 1})",
                f"!write || word == together[{WORD_WIDTH - 1}:0]",
                "!busy || !(write || load_ready)",
            ),
            watch=watch,
            helps=helps,
            assumes=same,
            reached=("write",),
            refuted_by=(
                (rf"addr <= gathered\[{addr}-1:0\]", f"addr <= gathered[{addr + 1}-1:1]"),
                (r"full && headed && \(!ended\)", "full && (!ended)"),
                (rf"named < {twin.words}", f"named[17:{twin.words.bit_length()}] == 0"),
                (r"load_valid && \(!busy\)", "load_valid"),
                (r"held <= gathered\[28-1:0\]", "held <= {gathered[27:1], 1'b0}"),
            ),
            clocks=11,
        ),
        Property(
            name="length stays",
            sentence="The number of samples of a frame is that of the header when an image is "
            "found good, and it changes only in clocks with halt.",
            states=(f"!ends_good || before_last == header[{17 + samples}:18]", "steady"),
            watch=watch
            + f"""
                reg [{samples - 1}:0] was;
                reg may_change = 1;
                always @(posedge clk) begin
                    was <= before_last;
                    may_change <= halt || rst;
                end
                wire steady = may_change || before_last == was;
            """,
            helps=helps,
            assumes=same,
            reached=("count == 1",),
            refuted_by=(
                (r"samples <= gathered", "samples <= held"),
                (r"before_last = samples", "before_last = (samples ^ load_data)"),
            ),
            clocks=13,
        ),
    ]
