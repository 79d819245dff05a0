"""Images of random networks, for the benches of engines that load their program."""

from binascii import crc_hqx

from golden.engine.image import CHECK_BYTES, LAST_ADDR, WORD_BYTES, Image, Sizes
from golden.networks.engine import Engine
from golden.networks.settings import Settings
from tb.common.cases import random_mlp


def image_for(hardware: Engine, shape: tuple[int, int, int], seed: int) -> Image:
    """The image of a random network for an engine."""
    assert hardware.loaded, "no image can be loaded"
    sizes = hardware.loaded.sizes
    options = {
        "reload": True,
        "pipeline": "deep" if sizes.pipeline.memory_registers else "short",
        "segment_width": sizes.segment_width,
        "program_words": sizes.program_words,
        "operand_words": sizes.operand_words,
    }
    image = Engine.of([random_mlp(shape, 1.0, seed)], Settings(options=options)).loaded
    assert image
    return image


def with_check(sizes: Sizes, sent: bytes) -> bytes:
    """What is sent, and the check that matches it."""
    return sent + crc_hqx(sent, sizes.check_start).to_bytes(CHECK_BYTES, "big")


def naming(sizes: Sizes, image: bytes, words: int) -> bytes:
    """An image whose header names another number of words; its check matches."""
    count = ((1 << LAST_ADDR[1]) - 1) << LAST_ADDR[0]
    header = int.from_bytes(image[:WORD_BYTES], "big") & ~count | (words - 1) << LAST_ADDR[0]
    sent = header.to_bytes(WORD_BYTES, "big") + image[WORD_BYTES:-CHECK_BYTES]
    return with_check(sizes, sent)


def fitting_checks(sizes: Sizes, image: bytes, words: int) -> list[bytes]:
    """Wrong images made of a good one of so many words, whose check is right at least in part."""
    sent = image[:-CHECK_BYTES]
    # A word is missing; one is too many.
    found = [naming(sizes, image, words + 1), with_check(sizes, sent + bytes(WORD_BYTES))]
    # The first byte of the check is wrong, and the last is right behind it: of what is left of the
    # check each bit alone is not 0.
    left = [crc_hqx(bytes([wrong]), 0) & 0xFF for wrong in range(256)]
    for bit in range(8):
        changed = sent + bytes([image[-CHECK_BYTES] ^ left.index(1 << bit)])
        found.append(changed + bytes([crc_hqx(changed, sizes.check_start) >> 8]))
    return found
