"""image_loader against its twin.

Sweeps: images of random words: of one word, of a few, and of as many as the memory holds. Some
images are cut, at each of their last bytes or at random; some have further bytes, one changed bit,
or are for other hardware. Some are wrong although their check matches: the header names more words
than the memory has, with words behind it or none, a word is missing, or there is a word too many.
In some the first byte of the check is wrong and the last byte fits it.
Drives: good and wrong images in random order, their bytes with and without gaps, and ``busy`` at
random clocks, so that a byte stays on the ports until it is taken; then the same with resets at
random clocks.
Checks: load_ready, halt and image_error in every clock; each word, its address and its clock; the
number of samples of a frame while frames may come; that every complete image is found good, and no
other.
Does not prove: that every change of an image is found, which no check of 16 bits can do.
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
from tb.common.stimulus import random_resets

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
