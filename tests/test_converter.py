"""Tests converters on an SPI: their data, the twin that reads them, and the scale of sensors."""

import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from conftest import on_engine
from refused import Desk

from golden.input_error import InputError
from golden.instruments.converter_instrument import ConverterInstrument
from golden.numbers.fixed import Fix
from golden.numbers.precision import SIGNAL
from golden.sensing.converter_parts import PARTS, PULL_UP_NS, TWOS
from golden.sensing.converter_reader import ConverterReader
from golden.sensing.scan_sequencer import ScanSequencer
from tactus.cli.train import train_scene
from tactus.core.finding import faults
from tactus.core.table import read_table, write_table
from tactus.rig import check
from tactus.rig.check import before_training, everything
from tactus.scene import Scene, load_scene
from tactus.scene.scale import Scale, on_readings
from tactus.train.split import scaled
from tactus.verify.benches.collected import CASES
from tactus.verify.benches.written import scene_of, write_scene
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


SENSORS = ["x0", "x1", "x2"]
OTHER = "readings in another unit, such as volts, take front_end.reference"


def codes_of(part: str) -> np.ndarray:
    """Forty frames of codes of a part, as a program prints them, with both ends among them."""
    data = PARTS[part]
    half = 1 << (data.bits - 1)
    codes = np.random.default_rng(3).integers(-half, half, (40, 3))
    codes[0], codes[1] = -half, half - 1
    return codes if data.coding == TWOS else codes + half


def rig(folder: Path, part: str, recorded: np.ndarray, keys: str = "", reference: str = "") -> Path:
    """A 3:5:2 scene with a converter, its recording, and ``keys`` of its data section."""
    mlp = on_readings(
        random_mlp((3, 5, 2), 1.0, 1), [Scale(2048, 2048)] * 3, [Scale(0, 25), Scale(0, 100)]
    )
    sections = f'{FRONT_END}converter = "{part}"\ncounter_width = 13\n{reference}'
    path = on_engine(folder, [mlp], sections=sections, rows=len(recorded))
    csv = path.with_suffix(".csv")
    names = [*SENSORS, "y0", "y1"]
    targets = read_table(csv, ["y0", "y1"]) * [25, 100]
    write_table(csv, names, np.column_stack([recorded, targets]), 4)
    text = path.read_text()
    assert "full_scale = { y1 = 0.9, y2 = 0.9 }\n" in text
    text = re.sub(r"full_scale.*\nlength_mm.*\n", keys, text)
    path.write_text(text)
    return path


OUTPUTS = "y0 = { factor = 25 }, y1 = { factor = 100 }"
NONE = f"scale = {{ {OUTPUTS} }}\n"


def written(scale: str) -> str:
    return f"scale = {{ {', '.join(f'{name} = {scale}' for name in SENSORS)}, {OUTPUTS} }}\n"


def signals_of(scene: Scene, codes: np.ndarray) -> np.ndarray:
    """The signals that the converter reader of the hardware makes from codes of its part."""
    reader = scene.twin().converter_reader
    return reader.process(codes % (1 << reader.part.bits))


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("keys", [NONE, written('"auto"')])
def test_networks_are_given_what_the_hardware_will_read(
    tmp_path: Path, part: str, keys: str
) -> None:
    """This holds bit for bit for every part, even if the readings cover little of its range."""
    codes = codes_of(part)
    path = rig(tmp_path, part, codes, keys)
    scene = load_scene(str(path))
    assert np.array_equal(scene.vectors().codes, signals_of(scene, codes))
    small = codes.mean(axis=0).round() + np.random.default_rng(1).integers(0, 50, codes.shape)
    table = read_table(path.with_suffix(".csv"), [*SENSORS, "y0", "y1"])
    table[:, :3] = small
    write_table(path.with_suffix(".csv"), [*SENSORS, "y0", "y1"], table, 4)
    scene = load_scene(str(path))
    assert np.array_equal(scene.vectors().codes, signals_of(scene, small.astype(np.int64)))


@pytest.mark.parametrize(
    ("part", "volts"),
    [("mcp3208", lambda codes: 3.3 * codes / 4096), ("ads8345", lambda codes: 2.5 * codes / 32768)],
)
def test_volts_need_the_reference_and_nothing_else(tmp_path: Path, part: str, volts) -> None:
    codes = codes_of(part)
    recorded = volts(codes)
    # Without the reference nothing is known about volts.
    path = rig(tmp_path, part, recorded, NONE)
    with pytest.raises(InputError, match=rf"mine\.toml: data\.scale: got none .* {OTHER}"):
        load_scene(str(path)).vectors()
    reference = 3.3 if part == "mcp3208" else 2.5
    path = rig(tmp_path, part, recorded, NONE, f"reference = {reference}\n")
    scene = load_scene(str(path))
    # Four decimals of a volt are a tenth of a code of fourteen bits.
    assert np.abs(scene.vectors().codes - signals_of(scene, codes)).max() <= 1
    assert not faults(everything(scene, tmp_path / "build"))


def test_readings_that_are_signals_stay(tmp_path: Path) -> None:
    signals = np.random.default_rng(3).uniform(-1, 0.99, (40, 3))
    for keys in (NONE, written('"auto"'), written("{ offset = 0, factor = 1 }")):
        scene = load_scene(str(rig(tmp_path, "mcp3208", signals, keys)))
        expected = SIGNAL.quantise(signals.round(4), "")[0]
        assert np.array_equal(scene.vectors().codes, expected)
        assert np.array_equal(scaled(scene).vectors().codes, expected)


def test_means_of_codes_are_told_to_be_codes(tmp_path: Path) -> None:
    """They cannot be distinguished from another unit, so each sensor needs a scale."""
    codes = codes_of("mcp3208") + 0.25
    codes[1] -= 1
    path = rig(tmp_path, "mcp3208", codes, NONE)
    message = (
        r"data\.scale: got none for readings of 0\.25 to 4094\.25 .*, expected signals of -1 to 1, "
        r"or the codes 0 to 4095 of converter 'mcp3208', whole numbers; means of codes take "
        r"\{ offset = 2048, factor = 2048 \} for each sensor"
    )
    with pytest.raises(InputError, match=message):
        load_scene(str(path)).vectors()
    path = rig(tmp_path, "mcp3208", codes, written("{ offset = 2048, factor = 2048 }"))
    assert not faults(everything(load_scene(str(path)), tmp_path / "build"))


# The written scale, the readings, and the right scale.
WRONG = {
    "auto before the converter": ("{ offset = 2046, factor = 95.2 }", "", 2048, 2048),
    "of another part": ("{ offset = 512, factor = 512 }", "", 2048, 2048),
    "of signals": ("{ offset = 0, factor = 1 }", "", 2048, 2048),
    "of another reference": ("{ offset = 2.5, factor = 2.5 }", "reference = 3.3\n", 1.65, 1.65),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_scale_that_is_not_the_converters_is_a_fault(tmp_path: Path, name: str) -> None:
    scale, reference, offset, factor = WRONG[name]
    codes = codes_of("mcp3208")
    path = rig(
        tmp_path, "mcp3208", codes * 3.3 / 4096 if reference else codes, written(scale), reference
    )
    message = (
        f"{path}: data.scale.x0: got {scale}, expected {{ offset = {offset}, factor = {factor} }} "
        "for each sensor, or none: "
    )
    for look in (everything, before_training):
        found = faults(look(load_scene(str(path)), tmp_path / "build"))
        assert len(found) == 1
        assert found[0].startswith(message)
    # The scale that the message names is right.
    path.write_text(path.read_text().replace(scale, f"{{ offset = {offset}, factor = {factor} }}"))
    assert not faults(everything(load_scene(str(path)), tmp_path / "build"))


@pytest.mark.parametrize(
    "words",
    [
        *("vhdl", "sim", "synth", "report", "train", "image"),
        *("bitstream ulx3s", "load twin", "monitor twin"),
    ],
)
def test_no_command_makes_hardware_with_another_scale(desk: Desk, words: str) -> None:
    scale = "{ offset = 2046, factor = 95 }"
    path = rig(desk.folder, "mcp3208", codes_of("mcp3208"), written(scale), reference="\n[uart]\n")
    path.write_text(path.read_text().replace('"engine"', '"engine"\nreload = true'))
    command, *others = words.split()
    says = f"mine.toml: data.scale.x0: got {scale}, expected {{ offset = 2048"
    desk.refuses(command, "mine.toml", *others, says=says)


def test_readings_beyond_the_converter(tmp_path: Path) -> None:
    codes = codes_of("mcp3208")
    codes[5, 1] = 4096
    path = rig(tmp_path, "mcp3208", codes, NONE)
    message = r"got none for readings of 0 to 4096 in .*mine\.csv, expected signals of -1 to 1, or "
    with pytest.raises(InputError, match=message):
        load_scene(str(path)).vectors()
    path = rig(tmp_path, "mcp3208", codes, NONE, "reference = 3000\n")
    with pytest.raises(
        InputError, match=r"'mcp3208' cannot read beyond it: correct front_end\.reference in"
    ):
        load_scene(str(path)).vectors()


def test_training_leaves_the_scale_of_the_sensors(tmp_path: Path) -> None:
    """It only computes the scale of the outputs."""
    codes = codes_of("mcp3208") // 50 + 1987
    keys = 'scale = "auto"\nfull_scale = { y0 = 25, y1 = 100 }\n'
    path = rig(tmp_path, "mcp3208", codes, keys)
    for network in tmp_path.glob("*.npz"):
        network.unlink()
    train_scene(load_scene(str(path)), tmp_path / "build", 1)
    scene = load_scene(str(path))
    assert scene.scales(SENSORS) == [Scale(2048, 2048)] * 3
    assert scene.auto == ["y0", "y1"]
    assert np.array_equal(scene.vectors().codes, signals_of(scene, codes))


def sequencer(inputs=4, slots=4, counter_width=12, sample_clock=900, pause=0) -> ScanSequencer:
    return ScanSequencer(FMT, inputs, slots, counter_width, sample_clock, pause)


def test_the_pattern_of_seven_slots() -> None:
    """The pattern is that of section 5.5 of the thesis. The eighth slot is idle."""
    scan = sequencer(slots=7, sample_clock=460)
    assert [f"{a:02b}" for a in scan.addresses[:7]] == ["00", "01", "10", "11", "00", "01", "10"]
    assert (scan.addresses[7], scan.slot_clocks) == (0, 512)


@pytest.mark.parametrize(
    ("pause", "second"), [(0, [71, 79, 87, 95, 103]), (36, [107, 115, 123, 131, 139])]
)
def test_a_frame_is_what_stood_on_the_converter(pause: int, second: list[int]) -> None:
    """A pause behind the slots takes nothing."""
    scan = sequencer(inputs=3, slots=5, counter_width=6, sample_clock=7, pause=pause)
    assert (scan.scan_clocks, scan.interval) == (64 + pause, 8)
    codes = np.arange(2 * scan.scan_clocks).reshape(2, -1)
    assert scan.process(codes).tolist() == [[7, 15, 23, 31, 39], second]


@pytest.mark.parametrize(
    ("rate", "clocks", "told"),
    [
        ("200.0", 320_000, "200 Hz at 64 MHz, exactly as asked"),
        ("15625", 4096, "15625 Hz at 64 MHz, exactly as asked"),
        ("0.0625", 1_024_000_000, "0.0625 Hz at 64 MHz, exactly as asked"),
        # That would be 58181.82 clocks.
        ("1100", 58_182, "1099.99656 Hz at 64 MHz, 3.12 ppm below the 1100 Hz that are asked for"),
        ("9000", 7111, "9000.14063 Hz at 64 MHz, 15.6 ppm above the 9000 Hz that are asked for"),
        ("0.0596047", 1_073_740_829, "0.0596047 Hz at 64 MHz, 0.000152 ppm above"),
        ("0", 4096, "15625 Hz at 64 MHz"),
    ],
)
def test_a_rate_is_kept_to_a_clock_and_what_is_missing_is_told(
    tmp_path, rate: str, clocks: int, told: str
) -> None:
    scene = scene_with(tmp_path, f"rate_hz = {rate}\n")
    assert scene.twin().interval == clocks
    assert scene.front_end.describe().startswith(f"a scan every {clocks} clocks, {told}")
    # The samples of a frame are as close together as without a rate.
    assert scene.twin().scan_sequencer.sample_clocks.tolist() == [1843, 3891]


def test_make_check_tells_the_rate(tmp_path) -> None:
    scene = scene_with(tmp_path, "rate_hz = 1100\n")
    (found,) = (f for f in check.design(scene, trained=True) if f.subject == "front_end")
    assert found.text == scene.front_end.describe()


def test_a_scan_takes_as_long_as_the_slowest_network_of_a_cascade(tmp_path) -> None:
    """There are four slots, and the networks take a frame every eleven clocks."""
    slow = replace(CASES["slower-cascade"], shapes=[(2 + i, 1, 1) for i in range(3)])
    scan = f"{FRONT_END}counter_width = 4\n"
    assert scene_of(replace(slow, sections=scan), tmp_path, "slow").twin().interval == 16
    hasty = replace(slow, sections=scan.replace("4", "3"))
    with pytest.raises(InputError, match="a scan of 8 clocks, expected 11 or more"):
        scene_of(hasty, tmp_path, "hasty").twin()


def test_a_rate_needs_the_clock_of_the_scene(tmp_path: Path) -> None:
    scene = scene_with(tmp_path, "rate_hz = 200\n")
    text = scene.path.read_text(encoding="utf-8")
    scene.path.write_text(text.replace("[hardware]", "[hardware]\nclock_mhz = 100", 1), "utf-8")
    assert load_scene(str(scene.path)).twin().interval == 500_000
