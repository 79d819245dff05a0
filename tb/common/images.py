"""Images of random networks, for the benches of engines that load their program."""

from binascii import crc_hqx
from collections.abc import Iterable
from contextlib import suppress

from golden.engine.image import CHECK_BYTES, LAST_ADDR, WORD_BYTES, Image, Sizes
from golden.input_error import InputError
from golden.networks.engine import Engine
from golden.trained.dense import DenseNetwork, Quantiser
from golden.trained.function import Function
from tb.common.cases import random_mlp, random_network


def image_for(hardware: Engine, shape: tuple[int, int, int], seed: int) -> Image:
    """The image of a random network for an engine."""
    return hardware.image_for([random_mlp(shape, 1.0, seed)])


def longest_image(hardware: Engine, inputs: int, most: int, outputs: int, seed: int) -> Image:
    """The image of a random network with ``most`` hidden nodes, or as many as there is room."""
    for hidden in range(most, 1, -1):
        with suppress(InputError):
            return image_for(hardware, (inputs, hidden, outputs), seed)
    return image_for(hardware, (inputs, 1, outputs), seed)


def images_with_room(hardware: Engine, networks: Iterable[DenseNetwork]) -> list[Image]:
    """The images of those networks for which an engine has room.

    A user's engine may have room for its own network alone. That image is the only one then.
    """
    found: list[Image] = []
    for network in networks:
        with suppress(InputError):
            found.append(hardware.image_for([network]))
    assert hardware.loaded is not None
    return found or [hardware.loaded]


def networks_of_other_depth(quantiser: Quantiser | None) -> list[DenseNetwork]:
    """Networks with one to four hidden layers, which fit hardware with ReLU.

    ``quantiser`` is the one that stands behind the layers of the hardware's own network, if any.
    The first network has no ReLU and no quantiser.
    """
    kinds = ("linear", "relu") if quantiser else ("relu", "tanh", "leaky_relu", "sigmoid")
    found: list[DenseNetwork] = [random_mlp((4, 2, 1), 1.0, seed=1)]
    for depth in (4, 1, 2):
        hidden = tuple(kinds[n % len(kinds)] for n in range(depth))
        shape = (2 + depth, *(2 + n % 2 for n in range(depth)), 2)
        found.append(random_network(shape, hidden, 1.5, seed=depth, quantiser=quantiser))
    return found


def networks_of_other_functions() -> list[DenseNetwork]:
    """Networks whose tables take one block, three, or fewer than three, and one of tanh."""
    soft, wave = Function("soft", "x / (1 + abs(x))"), Function("wave", "x * (3 - abs(x)) / 8")
    bent = Function("bent", "x * x / 64 - x / 4")
    # The last node of a hidden layer has no effect.
    kinds = ("tanh", "table:wave", "table:bent,wave,wave", "table:soft,bent,bent", "table:bent")
    return [
        random_network((3, 3, 2), (kind,), 2.0, seed, functions=(soft, wave, bent))
        for seed, kind in enumerate(kinds)
    ]


def with_check(sizes: Sizes, sent: bytes) -> bytes:
    """The bytes that are sent, followed by the check that matches them."""
    return sent + crc_hqx(sent, sizes.check_start).to_bytes(CHECK_BYTES, "big")


def naming(sizes: Sizes, image: bytes, words: int) -> bytes:
    """An image whose header names another number of words, with a check that matches."""
    count = ((1 << LAST_ADDR[1]) - 1) << LAST_ADDR[0]
    header = int.from_bytes(image[:WORD_BYTES], "big") & ~count | (words - 1) << LAST_ADDR[0]
    sent = header.to_bytes(WORD_BYTES, "big") + image[WORD_BYTES:-CHECK_BYTES]
    return with_check(sizes, sent)


def fitting_checks(sizes: Sizes, image: bytes, words: int) -> list[bytes]:
    """Wrong images, made of a good one of ``words`` words. Their check is right, or in part."""
    sent = image[:-CHECK_BYTES]
    # In the first image a word is missing; the second has one word too many.
    found = [naming(sizes, image, words + 1), with_check(sizes, sent + bytes(WORD_BYTES))]
    # The first byte of the check is wrong, and the last byte is right for a check that continues
    # from it. In each image another single bit of the remaining check is not 0.
    left = [crc_hqx(bytes([wrong]), 0) & 0xFF for wrong in range(256)]
    for bit in range(8):
        changed = sent + bytes([image[-CHECK_BYTES] ^ left.index(1 << bit)])
        found.append(changed + bytes([crc_hqx(changed, sizes.check_start) >> 8]))
    return found
