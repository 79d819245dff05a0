"""Tests the serial line of an instrument: its twins, and the keys of a scene."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import on_engine

from golden.input_error import InputError
from golden.instruments.uart_instrument import PulseDensity, UartInstrument
from golden.link.image_receiver import ImageReceiver
from golden.link.packet_sender import PacketSender
from golden.link.packets import IMAGE, SYNC, image_packet, kind_byte
from golden.link.uart import UartReceiver, UartTransmitter, bits_of
from golden.numbers.fixed import Fix
from tactus.scene import Scene, load_scene
from tactus.verify.benches.written import scene_of
from tb.common.case_library import PLAIN_UART, UART
from tb.common.cases import FRONT_END, random_mlp

PART = f'{FRONT_END}converter = "mcp3208-5v"\ncounter_width = 8\n'
CLOCK = "clock_mhz = 4.0\n"


def heard(divisor: int, levels: np.ndarray) -> list[int]:
    found = UartReceiver(divisor).process(levels, np.zeros(len(levels)))
    return found.out_data[found.out_valid].tolist()


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
    got = found.load_data[found.load_valid].tolist()
    assert bytes(got) == image + bytes([1, 2, 3, 0])
    assert np.flatnonzero(found.load_last[found.load_valid]).tolist() == [39, 43]


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
    frames = twin.process(columns, np.zeros(2000), byte_clocks=4).frames
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
    sending = twin.process(columns, np.zeros(200), byte_clocks=4)
    assert sending.begins == [7]
    (frame,) = sending.frames
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
    twin = scene_of(UART, tmp_path, "uart").twin()
    reader = replace(twin.converter_reader, pause=0)
    assert isinstance(twin, UartInstrument)
    with pytest.raises(InputError, match="uart_instrument: got analogue without a profile"):
        replace(scene_of(PLAIN_UART, tmp_path, "plain").twin(), analogue=True)
    assert twin.readout.output_clocks[-1] <= reader.scan_clocks - reader.slots
