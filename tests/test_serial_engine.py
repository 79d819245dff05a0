"""Tests that the engine without a multiplier gives the same results, bit by bit."""

from collections import defaultdict
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from golden.engine.fields import get
from golden.engine.formats import SAMPLE_SHIFT, WIDTH
from golden.engine.graph import Kind
from golden.engine.operand_memory import WORD
from golden.engine.operand_select import OperandSelect
from golden.engine.plane_select import PlaneSelect
from golden.engine.program import KIND, SOURCE, WEIGHT
from golden.engine.replay import CLEAR, ONE_PLANE
from golden.engine.serial_program import BEFORE, NOTHING
from golden.input_error import InputError
from golden.networks.engine import Engine
from golden.networks.settings import Settings
from golden.numbers.precision import SIGNAL
from tactus.scene import load_scene
from tactus.verify.benches.written import write_scene
from tb.common.case_library import ENGINES
from tb.common.cases import random_mlp

SCENES = ("digit-single", "digit", "digit-multiple", "swing-cascade")
NAMES = (*ENGINES, *SCENES)


@cache
def engine(name: str, lanes: int, lean: bool = True) -> Engine:
    settings = Settings(options={"lanes": lanes}, lean=lean)
    if name in ENGINES:
        case = ENGINES[name]
        return Engine.of(case.networks(), settings, case.arrangement)
    scene = load_scene(name)
    return Engine.of(scene.mlps(), settings, scene.arrangement)


@pytest.mark.parametrize("lean", [True, False])
@pytest.mark.parametrize("name", NAMES)
def test_results_are_those_with_a_multiplier(name: str, lean: bool) -> None:
    serial, dsp = (engine(name, lanes, lean) for lanes in (0, 1))
    rng = np.random.default_rng(3)
    frames = rng.integers(SIGNAL.low, SIGNAL.high + 1, (500, serial.inputs))
    frames[:100] = rng.choice([SIGNAL.low, -1, 0, SIGNAL.high], (100, serial.inputs))
    assert np.array_equal(serial.process(frames), dsp.process(frames))


@pytest.mark.parametrize("name", ["digit-single", "digit"])
def test_a_frame_is_computed_within_a_scan(name: str) -> None:
    assert engine(name, 0).output_clocks[-1] <= 4096


@pytest.mark.parametrize("segment_width", [7, 8, 9])
@pytest.mark.parametrize("kind", Kind)
def test_the_planes_make_the_product(kind: Kind, segment_width: int) -> None:
    """The sum over all planes, or over that of the number one, is the operand."""
    rng = np.random.default_rng(4)
    words = rng.integers(WORD.low, WORD.high + 1, 2000)
    words[:4] = WORD.low, WORD.high, 0, -1
    kinds = np.full(len(words), int(kind))
    once = kind in (Kind.ONE, Kind.INTERCEPT)
    total = np.zeros(len(words), dtype=np.int64)
    for plane in [ONE_PLANE] if once else range(WIDTH):
        bit = np.full(len(words), 1 << plane)
        take, table, minus = PlaneSelect(segment_width).process(words, bit, kinds)
        of_table = kind in (Kind.INTERCEPT, Kind.DISTANCE)
        assert not (take if of_table else table).any()
        total += np.where(minus, -1, 1) * (take | table) << plane
    assert np.array_equal(total, OperandSelect(segment_width).process(words, kinds))


def reads(serial: Engine) -> list[tuple[int, int]]:
    """Every word that is read for a frame, clock by clock, with its plane."""
    memory = serial.replay_memory
    clocks = serial.output_clocks[-1]
    words, planes, _ = memory.process(np.ones(clocks), np.zeros(clocks), np.zeros(clocks))
    return list(zip(words.tolist(), np.log2(planes).astype(int).tolist(), strict=True))


@pytest.mark.parametrize("name", NAMES)
def test_no_operand_is_read_too_early(name: str) -> None:
    serial = engine(name, 0)
    ready = dict.fromkeys(range(serial.inputs), 0)
    counted = 0
    for clock, (word, plane) in enumerate(reads(serial)):
        if plane == CLEAR and get(word, BEFORE) != NOTHING:
            ready[len(ready)] = clock - 1 + serial.program.pipeline.result_ready
        kind = get(word, KIND)
        matters = {
            Kind.WORD: plane < WIDTH and get(word, WEIGHT) != 0,
            Kind.DISTANCE: plane < serial.program.segment_width,
            Kind.INTERCEPT: plane == ONE_PLANE,
            Kind.ONE: False,
        }
        if matters[Kind(kind)]:
            assert ready[get(word, SOURCE)] <= clock
            counted += 1
    assert counted
    assert len(ready) == serial.program.addresses


@pytest.mark.parametrize("name", NAMES)
def test_passes_leave_out_zeros_alone(name: str) -> None:
    """A term is read in each plane in which its operand has bits, and in no other."""
    serial = engine(name, 0)
    seen: dict[tuple[int, int], list[int]] = defaultdict(list)
    neuron = -1
    for word, plane in reads(serial):
        neuron += plane == CLEAR
        if plane < CLEAR:
            seen[neuron, word].append(plane)
    for (_, word), planes in seen.items():
        kind = get(word, KIND)
        if kind in (Kind.ONE, Kind.INTERCEPT):
            needed = {ONE_PLANE}
        elif kind == Kind.WORD and get(word, SOURCE) < serial.inputs:
            needed = set(range(SAMPLE_SHIFT, WIDTH)) if get(word, WEIGHT) else set()
        elif kind == Kind.WORD:
            needed = set(range(WIDTH))
        else:
            needed = set(range(serial.program.segment_width))
        assert needed <= set(planes)
        if kind in (Kind.ONE, Kind.INTERCEPT):
            assert set(planes) == needed


def test_registers_behind_the_memories_go_with_a_multiplier_alone() -> None:
    hardware = {"lanes": 0, "pipeline": "deep"}
    with pytest.raises(InputError, match=r"hardware\.pipeline: got 'deep' with lanes 0"):
        Engine.of(ENGINES["least-engine"].networks(), Settings(options=hardware))


def budgeted(tmp_path: Path, lines: str, sections: str = "") -> Engine:
    path = write_scene(
        tmp_path,
        "budget",
        "exact",
        [random_mlp((2, 3, 3), 1.0, 4)],
        activation="precise",
        design="engine",
        hardware=lines,
        sections=sections,
    )
    found = load_scene(str(path)).twin().core
    assert isinstance(found, Engine)
    return found


def test_a_budget_takes_the_smallest_that_keeps_to_it(tmp_path) -> None:
    slow, fast = (budgeted(tmp_path, f"lanes = {lanes}").output_clocks[-1] for lanes in (0, 1))
    assert slow > fast
    for clocks, serial in ((slow, True), (slow - 1, False), (fast, False)):
        assert budgeted(tmp_path, f"clocks = {clocks}").serial is serial
    with pytest.raises(InputError, match=rf"hardware.clocks: got {fast - 1}, expected {fast} or"):
        budgeted(tmp_path, f"clocks = {fast - 1}")
    with pytest.raises(InputError, match=rf"expected {slow} or more, which .* lanes = 0"):
        budgeted(tmp_path, f"lanes = 0\nclocks = {slow - 1}")


def test_with_a_front_end_the_budget_is_what_a_scan_leaves(tmp_path) -> None:
    for width, serial in ((11, True), (8, False)):
        section = f"\n[front_end]\ncounter_width = {width}\n"
        found = budgeted(tmp_path, "", section)
        # There are two slots, and in each the sample is taken at the same place.
        assert found.budget == (1 << width) // 2 - 1
        assert found.serial is serial
        assert found.output_clocks[-1] <= found.budget
    with pytest.raises(InputError, match="front_end: instrument: got counter_width=4, a scan"):
        budgeted(tmp_path, "", "\n[front_end]\ncounter_width = 4\n")
