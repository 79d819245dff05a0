"""Compares packets with bytes made by hand, and their check with one computed bit by bit."""

import random

import pytest

from golden.input_error import InputError
from golden.link.packets import (
    FLAGS,
    MOST_IMAGE,
    Frame,
    FrameLayout,
    check_of,
    image_packet,
    lesson_packet,
)


def bitwise(data: bytes) -> int:
    check = 0xFFFF
    for byte in data:
        for bit in range(7, -1, -1):
            out = check >> 15 ^ byte >> bit & 1
            check = (check << 1 & 0xFFFF) ^ (0x1021 if out else 0)
    return check


def test_the_check_is_the_polynomials() -> None:
    # The check of these nine digits is published for the polynomial with this preset.
    assert check_of(b"123456789") == bitwise(b"123456789") == 0x29B1


def test_a_frame_byte_by_byte() -> None:
    frame = Frame(7, ("converter_error", "line_error"), 0x1234, (-8192, 8191), (-1,), (40, 1, -2))
    found = FrameLayout(2, 1, drawn=True).to_bytes(frame)
    body = bytes.fromhex("11 0e 07 09 1234 e000 1fff ffff 28 0001 fffe")
    assert found == b"\xa5" + body + bitwise(body).to_bytes(2, "big")


def test_a_winner_stands_behind_the_outputs() -> None:
    frame = Frame(7, (), 1, (-1,), (8191, -8192), (40, 1, -2), (1, 16383))
    found = FrameLayout(1, 2, drawn=True, decides=True).to_bytes(frame)
    body = bytes.fromhex("11 11 07 00 0001 ffff 1fff e000 01 3fff 28 0001 fffe")
    assert found == b"\xa5" + body + bitwise(body).to_bytes(2, "big")


def test_the_bytes_of_a_board_that_learns() -> None:
    frame = Frame(7, ("learning",), 1, (-1,), (8191,), (40, 1, -2), theta=(3, -8192))
    found = FrameLayout(1, 1, drawn=True, learns=True).to_bytes(frame)
    body = bytes.fromhex("11 0f 07 40 0001 ffff 1fff 03 e000 28 0001 fffe")
    assert found == b"\xa5" + body + bitwise(body).to_bytes(2, "big")
    for packet, text in (
        (lesson_packet(4, True, [1, -1]), "13 09 03 0001 ffff 0000 0000"),
        (lesson_packet(4, False, [1, -1, 2, -2], "theta"), "13 09 04 0001 ffff 0002 fffe"),
        (lesson_packet(1, True), "13 03 01 0000"),
    ):
        assert packet == b"\xa5" + bytes.fromhex(text) + bitwise(bytes.fromhex(text)).to_bytes(2)


@pytest.mark.parametrize("drawn", [False, True])
@pytest.mark.parametrize("decides", [False, True])
@pytest.mark.parametrize("learns", [False, True])
def test_what_is_sent_is_what_is_read(drawn: bool, decides: bool, learns: bool) -> None:
    draw = random.Random(1)
    for _ in range(100):
        layout = FrameLayout(draw.randrange(2, 9), draw.randrange(1, 5), drawn, decides, learns)
        samples, outputs = (
            tuple(draw.randrange(-8192, 8192) for _ in range(count))
            for count in (layout.inputs, layout.outputs)
        )
        point = (draw.randrange(256), draw.randrange(-8192, 8192), -5) if drawn else None
        flags = tuple(name for name in FLAGS if draw.random() < 0.5)
        numbers = draw.randrange(256), flags, draw.randrange(65536)
        winner = (draw.randrange(5), draw.randrange(1 << 14)) if decides else None
        theta = (draw.randrange(256), draw.randrange(-8192, 8192)) if learns else None
        frame = Frame(*numbers, samples, outputs, point, winner, theta)
        packet = layout.to_bytes(frame)
        assert len(packet) == layout.packet_bytes
        assert layout.from_payload(frame.number, packet[4:-2]) == frame


def test_what_is_too_long_is_refused() -> None:
    with pytest.raises(InputError, match="127 samples and 1 outputs, a payload of 259 bytes"):
        FrameLayout(127, 1)
    assert image_packet(b"ab") == bytes.fromhex("a5 12 0002") + b"ab"
    with pytest.raises(InputError, match="got 65536 bytes"):
        image_packet(bytes(MOST_IMAGE + 1))
