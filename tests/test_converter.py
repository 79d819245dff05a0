"""Tests converters on an SPI: their data, the twin that reads them, and the keys of a scene."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from golden.input_error import InputError
from golden.instruments.converter_instrument import ConverterInstrument
from golden.numbers.fixed import Fix
from golden.sensing.converter_parts import PARTS, PULL_UP_NS
from golden.sensing.converter_reader import ConverterReader
from tactus.scene import load_scene
from tactus.verify.benches.written import write_scene
from tb.common.cases import FRONT_END, random_mlp

FMT = Fix(14, 13)


def reader(part="mcp3208", inputs=4, slots=4, counter_width=13, clock_mhz=64.0, pause=0):
    return ConverterReader(FMT, PARTS[part], inputs, slots, counter_width, clock_mhz, pause)


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("clock_mhz", [0.048, 1.0, 4.0, 12.0, 25.0, 33.3333, 64.0, 100.0, 250.0])
def test_no_limit_of_a_part_is_broken_at_any_clock(part: str, clock_mhz: float) -> None:
    """It is also the fastest clock that breaks no limit."""
    data, clock = PARTS[part], Fraction(str(clock_mhz))
    half_ns = data.half_clocks(clock) * 1000 / clock

    def kept(half_ns: Fraction) -> bool:
        return (
            half_ns >= max(data.high_ns, data.low_ns, data.select_ns, data.setup_ns, data.hold_ns)
            and 2 * half_ns >= Fraction(1_000_000, data.fastest_khz)
            and 2 * half_ns > data.output_ns
            and 2 * half_ns * data.acquisition_clocks >= data.acquisition_ns
        )

    assert kept(half_ns)
    assert data.half_clocks(clock) == 1 or not kept(half_ns - 1000 / clock)
    high_ns = data.high_clocks(clock) * 1000 / clock
    assert high_ns >= max(data.deselect_ns, data.release_ns + PULL_UP_NS)


@pytest.mark.parametrize(
    ("part", "half_clocks", "least"),
    [("mcp3208", 32, 13), ("mcp3208-5v", 16, 12), ("ads8344", 14, 12), ("ads8345", 14, 12)],
)
def test_what_a_part_needs_at_64_mhz(part: str, half_clocks: int, least: int) -> None:
    assert reader(part).half_clocks == half_clocks
    reader(part, counter_width=least)
    with pytest.raises(InputError, match=f"counter_width={least - 1}, expected {least} to 24: for"):
        reader(part, counter_width=least - 1)


def test_codes_of_twelve_bits_get_zeros() -> None:
    assert reader().process([0, 1, 2047, 2048, 4095]).tolist() == [-8192, -8188, -4, 0, 8188]


def test_codes_of_sixteen_bits_are_rounded() -> None:
    codes = [0, 1, 2, 32768, 32769, 32770, 65533, 65534, 65535]
    expected = [-8192, -8192, -8191, 0, 0, 1, 8191, 8191, 8191]
    assert reader("ads8344").process(codes).tolist() == expected
    turned = [(code - 32768) % 65536 for code in codes]
    assert reader("ads8345").process(turned).tolist() == expected


@pytest.mark.parametrize(("part", "most"), [("mcp3208", 2), ("ads8344", 0), ("ads8345", 0)])
def test_every_voltage_comes_back(part: str, most: int) -> None:
    """It is off by at most half a step of the part, and saturates above the largest code."""
    voltages = np.arange(FMT.low, FMT.high + 1)
    twin = reader(part)
    error = np.abs(twin.process(twin.converted(voltages)) - voltages)
    assert error[voltages <= 8188].max() == most
    assert error.max() <= 3


def test_the_worst_error_of_the_rounding() -> None:
    """Over all codes of 16 bits it is two quarters of a step; for the largest two, three."""
    codes = np.arange(1 << 16)
    error = np.abs(4 * reader("ads8344").process(codes) - (codes - 32768))
    assert error[:-2].max() == 2
    assert error.max() == 3


def sent(part: str, code: int) -> np.ndarray:
    """The bits that a working converter sends, with a 1 before them."""
    data = PARTS[part]
    bits = np.ones(data.clocks + 1, dtype=np.int64)
    bits[data.first :] = 0
    bits[list(data.zeros)] = 0
    for n in range(data.bits):
        bits[data.last - n] = code >> n & 1
        if data.mirrored:
            bits[data.last + n] = code >> n & 1
    return bits


@pytest.mark.parametrize("part", PARTS)
def test_a_converter_that_is_not_there_is_told_of_every_code(part: str) -> None:
    twin, data = reader(part), PARTS[part]
    codes = np.array([0, 1, (1 << data.bits) - 1, 0x5A5A % (1 << data.bits)])
    bits = np.array([sent(part, int(code)) for code in codes])
    got, right = twin.received(bits)
    assert right.all()
    assert got.tolist() == codes.tolist()
    for level in (0, 1):
        assert not twin.received(np.full(data.clocks + 1, level))[1]
    for bit in (0, *data.zeros):
        broken = bits.copy()
        broken[:, bit] ^= 1
        assert not twin.received(broken)[1].any()


def test_a_code_that_is_not_repeated_is_told() -> None:
    for bit in [*range(8, 19), *range(20, 31)]:
        bits = sent("mcp3208", 0x5A5)
        bits[bit] ^= 1
        assert not reader().received(bits)[1]


def test_a_code_that_the_part_has_not_is_refused() -> None:
    with pytest.raises(InputError, match="converter_reader codes: got 4096, expected 0 to 4095"):
        reader().process([4096])


def scene_with(tmp_path, lines: str, shape=(2, 3, 4)):
    mlp = random_mlp(shape, 1.0, 1)
    path = write_scene(tmp_path, "rig", "exact", [mlp], sections=f"{FRONT_END}{lines}")
    return load_scene(str(path))


def test_a_scene_names_its_converter(tmp_path) -> None:
    scene = scene_with(tmp_path, 'converter = "mcp3208-5v"\ncounter_width = 11\nrate_hz = 1000\n')
    design = scene.twin()
    assert isinstance(design, ConverterInstrument)
    expected = replace(reader("mcp3208-5v", 2, 2, 11), pause=64000 - 2048)
    assert design.converter_reader == expected
    assert design.interval == 64000
    # A converter of twelve bits only gives these codes to the network.
    voltages = np.array([[-8192, 8191], [3, -3]])
    through = np.array([[-8192, 8188], [4, -4]])
    assert (design.process(voltages) == design.readout.process(through)).all()
