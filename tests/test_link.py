"""Tests the serial line of an instrument: its twins, and the keys of a scene."""

from collections import Counter
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest
from conftest import on_engine
from hypothesis import given
from hypothesis import strategies as st

from golden.input_error import InputError
from golden.instruments.readout import Readout
from golden.instruments.uart_instrument import PulseDensity, UartInstrument
from golden.link.decoder import MOST_WAITING, Decoder, fault
from golden.link.image_receiver import ImageReceiver
from golden.link.packet_sender import PacketSender
from golden.link.packets import (
    FLAGS,
    FRAME,
    IMAGE,
    MOST_IMAGE,
    SYNC,
    Frame,
    FrameLayout,
    check_of,
    image_packet,
    kind_byte,
    lesson_packet,
)
from golden.link.uart import UartReceiver, UartTransmitter, bits_of
from golden.numbers.fixed import Fix
from tactus.scene import Scene, load_scene
from tactus.verify.benches.written import scene_of
from tb.common.case_library import CASE
from tb.common.cases import FRONT_END, random_mlp

PART = f'{FRONT_END}converter = "mcp3208-5v"\ncounter_width = 8\n'
CLOCK = "clock_mhz = 4.0\n"


def heard(divisor: int, levels: np.ndarray) -> list[int]:
    found = UartReceiver(divisor).process(levels, np.zeros(len(levels)))
    return found["out_data"][found["out_valid"] == 1].tolist()


@pytest.mark.parametrize("divisor", [4, 5, 25, 104])
def test_what_is_sent_is_heard(divisor: int) -> None:
    sent, clocks = list(range(0, 256, 5)), 10 * divisor
    column = np.repeat(sent, clocks)
    valid = np.ones(len(column), dtype=np.int64)
    ready, tx = UartTransmitter(divisor).process(valid, column, 0 * valid)
    assert np.flatnonzero(ready).tolist() == list(range(0, len(column), clocks))
    assert heard(divisor, np.append(tx, [1, 1, 1])) == sent


@pytest.mark.parametrize(("divisor", "shorter", "longer"), [(4, 0.025, 0.055), (25, 0.048, 0.055)])
def test_as_far_as_the_page_says_bits_may_be_off(divisor, shorter, longer) -> None:
    """The bits may begin at any part of a clock. A tenth more is too much."""
    byte = 0xA5
    phases = np.linspace(0, 0.999, 23)

    def right(off: float) -> bool:
        found = []
        for phase in phases:
            edges = 3 + phase + np.arange(21) * divisor * (1 + off)
            place = np.searchsorted(edges, np.arange(3 + 26 * divisor), side="right")
            levels = np.array([1, *bits_of(byte), *bits_of(0), 1])[np.minimum(place, 21)]
            found.append(heard(divisor, levels)[:1] == [byte])
        return all(found)

    assert right(-0.99 * shorter)
    assert right(0.99 * longer)
    assert not right(-1.2 * shorter)
    assert not right(1.2 * longer)


def test_images_are_found_among_other_bytes() -> None:
    image = bytes(range(40, 80))
    sent = b"\x07" + bytes([SYNC, SYNC]) + image_packet(image)[1:] + bytes([SYNC, 0x22, 0, 1, 9])
    cut = bytes([SYNC, kind_byte(IMAGE), 0, 9, 1, 2, 3])
    data = np.frombuffer(sent + cut, np.uint8)
    quiet = np.zeros(100, dtype=np.int64)
    valid = np.concatenate([np.ones(len(data), dtype=np.int64), quiet])
    column = np.concatenate([data, quiet])
    twin = ImageReceiver(idle_clocks=50, depth=4)
    found = twin.process(valid, column, np.ones(len(valid)), np.zeros(len(valid)))
    left = found["load_valid"] == 1
    assert bytes(found["load_data"][left].tolist()) == image + bytes([1, 2, 3, 0])
    assert np.flatnonzero(found["load_last"][left]).tolist() == [39, 43]


def quiet_columns(twin: PacketSender, clocks: int) -> dict[str, np.ndarray]:
    names = [port.name for port in twin.ports if port.direction == "in"]
    return {name: np.zeros(clocks, dtype=np.int64) for name in names}


def test_a_frame_between_two_packets_is_counted_alone() -> None:
    twin = PacketSender(1, 1, points=0, reload=True, patience=1000)
    columns, ends = quiet_columns(twin, 2000), np.array([5, 20, 40, 600])
    for name in ("sample", "result"):
        columns[f"{name}_valid"][ends] = columns[f"{name}_last"][ends] = 1
        columns[f"{name}_data"][ends] = [-7, 8, 9, -10]
    columns["line_error"][30] = 1
    *_, frames = twin.process(columns, np.zeros(2000), byte_clocks=4)
    told = [(f.number, f.count, f.samples, f.outputs, f.flags) for f in frames]
    assert told[0] == (0, 1, (-7,), (-7,), ())
    # Thirteen bytes of four clocks; then a line so long free that a packet goes without a frame.
    assert told[1:] == [(1, 4, (-10,), (-10,), ("line_error",)), (2, 4, (-10,), (-10,), ())]


def test_a_frame_is_complete_with_its_winner() -> None:
    twin = PacketSender(1, 2, points=0, reload=False, patience=1000, decides=True)
    columns = quiet_columns(twin, 200)
    columns["result_valid"][[4, 5]] = columns["result_last"][5] = 1
    columns["result_data"][[4, 5]] = [-3, 8]
    columns["winner_valid"][6] = columns["winner_index"][6] = 1
    columns["winner_margin"][6] = 11
    valid, _, (frame,) = twin.process(columns, np.zeros(200), byte_clocks=4)
    assert np.flatnonzero(valid)[0] == 8
    assert (frame.count, frame.outputs, frame.winner) == (1, (-3, 8), (1, 11))
    with pytest.raises(InputError, match="got outputs=1, expected 2 or more"):
        PacketSender(1, 1, points=0, reload=False, patience=9, decides=True)


@pytest.mark.parametrize("code", [-8192, -8191, -1, 0, 1, 2048, 8191])
def test_as_many_ones_as_a_code_asks_for(code: int) -> None:
    twin = PulseDensity(Fix(14, 13))
    bits = twin.process(np.full(1 + (1 << 14), code), np.zeros(1 + (1 << 14)))[1:]
    assert bits.sum() == code + 8192
    due = np.arange(1, len(bits) + 1) * (code + 8192) / (1 << 14)
    assert np.abs(np.cumsum(bits) - due).max() <= 1


def test_a_scene_has_a_line(tmp_path: Path) -> None:
    def with_line(hardware: str) -> Scene:
        mlps, sections = [random_mlp((2, 3, 4), 1.0, 1)], f"{PART}[uart]\n"
        return load_scene(str(on_engine(tmp_path, mlps, hardware=hardware, sections=sections)))

    design = with_line(CLOCK).twin()
    assert isinstance(design, UartInstrument)
    assert (design.divisor, design.image) == (4, b"")
    assert {port.name for port in design.ports} & {"rx", "tx", "dac_x"} == {"tx"}
    loaded = with_line(f"{CLOCK}reload = true").twin()
    assert "rx" in {port.name for port in loaded.ports}
    assert loaded.image == image_packet(loaded.core.image)


def test_outputs_leave_before_the_next_samples_come(tmp_path) -> None:
    twin = scene_of(CASE["plain-uart"], tmp_path, "uart").twin()
    with pytest.raises(InputError, match="uart_instrument: got analogue without a profile"):
        replace(twin, analogue=True)
    late = "got a scan of 128 clocks, expected 1003 or more: outputs leave before the next samples"
    with patch.object(Readout, "output_clocks", (9, 999)), pytest.raises(InputError, match=late):
        replace(twin)


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
        assert tally["missed"] == 1
        # If the beginning and the length are still right, the check fails.
        assert tally["failed"] == (bit >= 8 * 3)
        assert tally["skipped"] == LAYOUT.packet_bytes + MOST_WAITING


def test_missed_packets_are_counted_and_not_those_of_a_cut_cable() -> None:
    frame = Frame(0, (), 0, (1, 2), (3,))
    decoder = Decoder(PLAIN)
    for number in (250, 251, 254, 2):
        decoder.feed(PLAIN.to_bytes(replace(frame, number=number)))
    assert decoder.tally == Counter(frames=4, missed=2 + 3)
    decoder.feed(PLAIN.to_bytes(frame)[:5])
    decoder.restart()
    decoder.feed(PLAIN.to_bytes(replace(frame, number=77)))
    assert decoder.tally == Counter(frames=5, missed=5, skipped=5)


def test_who_begins_in_the_middle_of_a_packet_is_told_of_no_garbage() -> None:
    packet = PLAIN.to_bytes(Frame(0, (), 0, (1, 2), (3,)))
    for start in range(1, len(packet)):
        decoder = Decoder(PLAIN)
        assert len(decoder.feed(packet[start:] + packet)) == 1
        assert decoder.tally == Counter(frames=1)
    decoder = Decoder(PLAIN)
    decoder.feed(bytes(len(packet)) + packet)
    assert decoder.tally == Counter(frames=1, skipped=1)


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
    ((kind, count),) = (+decoder.tally).items()
    assert fault(kind, count) == ""
    decoder.feed(other(version, length) * 3)
    assert said in fault(kind, decoder.tally[kind], count)
    assert fault(kind, decoder.tally[kind], decoder.tally[kind]) == ""
    assert decoder.tally["skipped"] == 0


def test_an_image_is_no_frame() -> None:
    decoder = Decoder(PLAIN)
    packet = PLAIN.to_bytes(Frame(0, (), 0, (1, 2), (3,)))
    assert len(decoder.feed(packet + image_packet(bytes(50)) + packet)) == 2
    assert decoder.tally["skipped"] == 54
    assert decoder.tally["missed"] == 255


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


POINT = (40, 1, -2)
FLAGGED = Frame(7, ("converter_error", "line_error"), 0x1234, (-8192, 8191), (-1,), POINT)
ALL = Frame(7, ("learning",), 1, (-1,), (8191, -8192), POINT, (1, 16383), theta=(255, 5))


@pytest.mark.parametrize(
    ("layout", "frame", "text"),
    [
        (FrameLayout(2, 1, drawn=True), FLAGGED, "0e 07 09 1234 e000 1fff ffff 28 0001 fffe"),
        (
            FrameLayout(1, 2, drawn=True, decides=True, learns=True),
            ALL,
            "14 07 40 0001 ffff 1fff e000 01 3fff ff 0005 28 0001 fffe",
        ),
    ],
)
def test_a_frame_byte_by_byte(layout: FrameLayout, frame: Frame, text: str) -> None:
    body, packet = bytes.fromhex(f"11 {text}"), layout.to_bytes(frame)
    assert packet == b"\xa5" + body + bitwise(body).to_bytes(2, "big")
    assert len(packet) == layout.packet_bytes
    assert layout.from_payload(frame.number, packet[4:-2]) == frame


@pytest.mark.parametrize(
    ("packet", "text"),
    [
        (lesson_packet(4, True, [1, -1]), "13 09 03 0001 ffff 0000 0000"),
        (lesson_packet(4, False, [1, -1, 2, -2], "theta"), "13 09 04 0001 ffff 0002 fffe"),
        (lesson_packet(1, True), "13 03 01 0000"),
    ],
)
def test_a_lesson_byte_by_byte(packet: bytes, text: str) -> None:
    body = bytes.fromhex(text)
    assert packet == b"\xa5" + body + bitwise(body).to_bytes(2, "big")


def test_what_is_too_long_is_refused() -> None:
    with pytest.raises(InputError, match="127 samples and 1 outputs, a payload of 259 bytes"):
        FrameLayout(127, 1)
    assert image_packet(b"ab") == bytes.fromhex("a5 12 0002") + b"ab"
    with pytest.raises(InputError, match="got 65536 bytes"):
        image_packet(bytes(MOST_IMAGE + 1))
