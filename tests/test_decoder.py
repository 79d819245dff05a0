"""Tests the packets of the serial line, and the decoder that finds every complete one."""

import random
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from golden.input_error import InputError
from golden.link.decoder import MOST_WAITING, Decoder, Tally
from golden.link.packets import (
    FLAGS,
    FRAME,
    MOST_IMAGE,
    SYNC,
    Frame,
    FrameLayout,
    check_of,
    image_packet,
    lesson_packet,
)

LAYOUT = FrameLayout(4, 2, drawn=True)
PLAIN = FrameLayout(2, 1)
# A code with the same bytes as the beginning of a packet.
BEGINS = int.from_bytes(bytes([SYNC, 0x10 | FRAME]), "big", signed=True)

codes = st.integers(-(1 << 15), (1 << 15) - 1) | st.just(BEGINS)


@st.composite
def some_frames(draw: st.DrawFn, layout: FrameLayout = LAYOUT) -> list[Frame]:
    first, count = draw(st.integers(0, 255)), draw(st.integers(0, 6))
    found = []
    for number in range(first, first + count):
        values = draw(st.lists(codes, min_size=6, max_size=6))
        flags = draw(st.sets(st.sampled_from(FLAGS)))
        point = (draw(st.integers(0, 255)), draw(codes), draw(codes))
        found.append(
            Frame(
                number % 256,
                tuple(name for name in FLAGS if name in flags),
                draw(st.integers(0, 65535)),
                tuple(values[:4]),
                tuple(values[4:]),
                point,
            )
        )
    return found


def pieces(data: bytes, cuts: list[int]) -> list[bytes]:
    """The same bytes in pieces, as a port gives them."""
    ends = sorted({min(cut, len(data)) for cut in cuts} | {0, len(data)})
    return [data[a:b] for a, b in pairwise(ends)]


def whole(data: bytes, layout: FrameLayout) -> list[int]:
    """The places where packets begin, from the definition alone.

    It is the first place of a packet, then the first after its end, and so on.
    """
    found, at = [], 0
    while at + 6 <= len(data):
        end = at + 4 + data[at + 2] + 2
        head = data[at] == SYNC and data[at + 1] & 15 == FRAME and end <= len(data)
        if head and check_of(data[at + 1 : end - 2]) == int.from_bytes(data[end - 2 : end], "big"):
            if data[at + 1] >> 4 == 1 and data[at + 2] == layout.payload_bytes:
                found.append(at)
            at = end
        else:
            at += 1
    return found


@given(some_frames(), st.lists(st.binary(max_size=60)), st.lists(st.integers(0, 600)))
def test_every_packet_between_garbage_is_found(
    frames: list[Frame], garbage: list[bytes], cuts: list[int]
) -> None:
    garbage = (garbage + [b""] * len(frames))[: len(frames)]
    data = b"".join(
        noise + LAYOUT.to_bytes(f) for noise, f in zip(garbage, frames, strict=True)
    ) + bytes(MOST_WAITING)
    places = whole(data, LAYOUT)
    decoder = Decoder(LAYOUT)
    found = [f for piece in pieces(data, cuts) for f in decoder.feed(piece)]
    assert len(found) == len(places)
    for frame, place in zip(found, places, strict=True):
        assert LAYOUT.to_bytes(frame) == data[place : place + LAYOUT.packet_bytes]
    # Noise that passes the check could hide packets, but hypothesis does not generate such noise.
    assert found == frames


def test_the_beginning_of_a_packet_hides_none_behind_it() -> None:
    """Garbage that begins like the longest possible packet, cut anywhere, comes before packets."""
    frames = [Frame(n, (), n, (BEGINS,) * 4, (BEGINS,) * 2, (0, n, BEGINS)) for n in range(12)]
    data = b"".join(map(LAYOUT.to_bytes, frames))
    for head in (
        b"\xa5\x11\xff",
        b"\xa5\x21\x00",
        b"\xa5\xa5",
        b"\xa5\x11",
        LAYOUT.to_bytes(frames[0])[:9],
    ):
        decoder = Decoder(LAYOUT)
        found = decoder.feed(head)
        for byte in data:
            found += decoder.feed(bytes([byte]))
        assert found + decoder.feed(bytes(MOST_WAITING)) == frames, head


def test_a_turned_bit_costs_its_packet_alone() -> None:
    frames = [Frame(n, (), n, (n, -n, BEGINS, 5), (7, -7), (n, n, n)) for n in range(5)]
    packets = list(map(LAYOUT.to_bytes, frames))
    for bit in range(8 * LAYOUT.packet_bytes):
        broken = bytearray(packets[2])
        broken[bit // 8] ^= 1 << bit % 8
        decoder = Decoder(LAYOUT)
        data = b"".join([*packets[:2], bytes(broken), *packets[3:], bytes(MOST_WAITING)])
        assert decoder.feed(data) == frames[:2] + frames[3:], bit
        tally = decoder.tally
        assert tally.missed == 1
        # If the beginning and the length are still right, the check fails.
        assert tally.failed == (bit >= 8 * 3)
        assert tally.skipped == LAYOUT.packet_bytes + MOST_WAITING


def test_missed_packets_are_counted_and_not_those_of_a_cut_cable() -> None:
    frame = Frame(0, (), 0, (1, 2), (3,))
    decoder = Decoder(PLAIN)
    for number in (250, 251, 254, 2):
        decoder.feed(PLAIN.to_bytes(replace(frame, number=number)))
    assert decoder.tally == Tally(frames=4, missed=2 + 3)
    decoder.feed(PLAIN.to_bytes(frame)[:5])
    decoder.restart()
    decoder.feed(PLAIN.to_bytes(replace(frame, number=77)))
    assert decoder.tally == Tally(frames=5, missed=5, skipped=5)


def test_who_begins_in_the_middle_of_a_packet_is_told_of_no_garbage() -> None:
    packet = PLAIN.to_bytes(Frame(0, (), 0, (1, 2), (3,)))
    for start in range(1, len(packet)):
        decoder = Decoder(PLAIN)
        assert len(decoder.feed(packet[start:] + packet)) == 1
        assert decoder.tally == Tally(frames=1)
    decoder = Decoder(PLAIN)
    decoder.feed(bytes(len(packet)) + packet)
    assert decoder.tally == Tally(frames=1, skipped=1)


def other(version: int, length: int) -> bytes:
    body = bytes([version << 4 | FRAME, length, 9]) + bytes(length)
    return bytes([SYNC]) + body + check_of(body).to_bytes(2, "big")


@pytest.mark.parametrize(
    ("version", "length", "said"),
    [
        (2, PLAIN.payload_bytes, "packets are of version 2 of the protocol, expected 1"),
        (0, 3, "packets are of version 0 of the protocol, expected 1"),
        (1, 30, "a payload of 30 bytes, expected 9: the board runs the hardware of another scene"),
    ],
)
def test_another_board_is_told_and_not_at_its_first_packet(
    version: int, length: int, said: str
) -> None:
    decoder = Decoder(PLAIN)
    assert decoder.feed(other(version, length)) == []
    assert decoder.tally.faults(Tally(), PLAIN) == {}
    before = decoder.tally.copy()
    decoder.feed(other(version, length) * 3)
    (line,) = decoder.tally.faults(before, PLAIN).values()
    assert said in line
    assert decoder.tally.faults(decoder.tally, PLAIN) == {}
    assert decoder.tally.skipped == 0


def test_an_image_is_no_frame() -> None:
    decoder = Decoder(PLAIN)
    packet = PLAIN.to_bytes(Frame(0, (), 0, (1, 2), (3,)))
    assert len(decoder.feed(packet + image_packet(bytes(50)) + packet)) == 2
    assert decoder.tally.skipped == 54
    assert decoder.tally.missed == 255


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
