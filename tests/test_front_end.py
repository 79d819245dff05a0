"""Tests the front end: the patterns of the thesis, ranges, and the keys of a scene."""

from dataclasses import replace

import numpy as np
import pytest

from golden.input_error import InputError
from golden.numbers.fixed import Fix
from golden.sensing.scan_sequencer import ScanSequencer
from tactus.rig import check
from tactus.scene import load_scene
from tactus.verify.benches.collected import CASES
from tactus.verify.benches.written import scene_of, write_scene
from tb.common.cases import FRONT_END, random_mlp

FMT = Fix(14, 13)


def sequencer(inputs=4, slots=4, counter_width=12, sample_clock=900, pause=0) -> ScanSequencer:
    return ScanSequencer(FMT, inputs, slots, counter_width, sample_clock, pause)


def test_the_pattern_of_four_slots() -> None:
    """Section 5.4.4 of the thesis has 12 bits and four slots of 1024 clocks."""
    scan = sequencer()
    assert scan.addresses == (0, 1, 2, 3)
    assert (scan.slot_clocks, scan.scan_clocks) == (1024, 4096)
    assert scan.sample_clocks.tolist() == [900, 1924, 2948, 3972]


def test_the_pattern_of_seven_slots() -> None:
    """The pattern is that of section 5.5 of the thesis. The eighth slot is idle."""
    scan = sequencer(slots=7, sample_clock=460)
    assert [f"{a:02b}" for a in scan.addresses[:7]] == ["00", "01", "10", "11", "00", "01", "10"]
    assert scan.addresses[7] == 0
    assert scan.slot_clocks == 512


def test_a_frame_is_what_stood_on_the_converter() -> None:
    scan = sequencer(inputs=3, slots=5, counter_width=6, sample_clock=7)
    codes = np.arange(2 * 64).reshape(2, 64)
    assert scan.process(codes).tolist() == [[7, 15, 23, 31, 39], [71, 79, 87, 95, 103]]


def test_a_pause_behind_the_slots_takes_nothing() -> None:
    scan = replace(sequencer(inputs=3, slots=5, counter_width=6, sample_clock=7), pause=36)
    assert (scan.scan_clocks, scan.interval) == (100, 8)
    codes = np.arange(2 * 100).reshape(2, 100)
    assert scan.process(codes).tolist() == [[7, 15, 23, 31, 39], [107, 115, 123, 131, 139]]


def scene_with(tmp_path, section: str, shape=(2, 3, 4), design="hybrid"):
    mlp = random_mlp(shape, 1.0, 1)
    path = write_scene(tmp_path, "rig", "exact", [mlp], design=design, sections=section)
    return load_scene(str(path))


def test_a_scene_without_the_section_has_none_of_it(tmp_path) -> None:
    assert scene_with(tmp_path, "").twin().block == "hybrid"


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
    scene = scene_with(tmp_path, f"{FRONT_END}rate_hz = {rate}\n")
    assert scene.twin().interval == clocks
    assert scene.front_end.describe().startswith(f"a scan every {clocks} clocks, {told}")
    # The samples of a frame are as close together as without a rate.
    assert scene.twin().scan_sequencer.sample_clocks.tolist() == [1843, 3891]


def test_make_check_tells_the_rate(tmp_path) -> None:
    scene = scene_with(tmp_path, f"{FRONT_END}rate_hz = 1100\n")
    (found,) = (f for f in check.design(scene, trained=True) if f.subject == "front_end")
    assert found.text == scene.front_end.describe()


def test_a_rate_needs_the_clock(tmp_path) -> None:
    scene = scene_with(tmp_path, f"{FRONT_END}rate_hz = 200\n")
    text = scene.path.read_text(encoding="utf-8")
    scene.path.write_text(text.replace("[hardware]", "[hardware]\nclock_mhz = 100", 1), "utf-8")
    assert load_scene(str(scene.path)).twin().interval == 500_000


@pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")
def test_a_scan_takes_as_long_as_the_slowest_network_of_a_cascade(tmp_path) -> None:
    """There are four slots, and the networks take a frame every eleven clocks."""
    slow = replace(CASES["slower-cascade"], shapes=[(2 + i, 1, 1) for i in range(3)])
    scan = f"{FRONT_END}counter_width = 4\n"
    assert scene_of(replace(slow, sections=scan), tmp_path, "slow").twin().interval == 16
    hasty = replace(slow, sections=scan.replace("4", "3"))
    with pytest.raises(InputError, match="a scan of 8 clocks, expected 11 or more"):
        scene_of(hasty, tmp_path, "hasty").twin()
