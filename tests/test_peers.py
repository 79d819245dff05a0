"""Tests what make peers computes itself, but not what it installs and synthesises."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from golden.input_error import InputError
from golden.precision import SIGNAL
from golden.scene import load_scene
from hdl.synth.netlist import KINDS
from tb.peers import da4ml_rows, installed, nngen_rows, ours
from tb.peers.comparison import Row, Task, compared, task_of
from tb.peers.simulated import packed, simulated, unpacked
from tb.report.measure.one_network import RANDOM_FRAMES, mean_error


@pytest.fixture(scope="module")
def task() -> Task:
    return task_of(load_scene("digit-single"), 1)


def test_an_error_counts_to_the_end_of_the_range() -> None:
    """The errors are a quarter and a half of the last place, and 0 if both values saturate."""
    codes = np.array([[100, -100], [SIGNAL.high, SIGNAL.low]])
    real = np.array([[100.25, -100.5], [1e6, -1e6]]) / 8192
    assert mean_error(codes, real) == pytest.approx((0.25 + 0.5) / 4)


def test_recorded_and_random_frames_are_judged_apart(task: Task) -> None:
    float_outputs = np.concatenate([task.recorded, task.random]) / 8192
    codes = SIGNAL.quantise(task.mlp.process(float_outputs), "outputs")[0]
    worse = codes.copy()
    worse[: len(task.recorded)] = 0
    (exact, same), (wrong, again) = task.errors(codes), task.errors(worse)
    assert exact < 0.51
    assert wrong > 100
    assert same == again
    with pytest.raises(ValueError, match="outputs: got shape"):
        task.errors(codes[1:])


def test_frames_are_those_of_the_seed(task: Task) -> None:
    scene = load_scene("digit-single")
    assert (task_of(scene, 1).random == task.random).all()
    assert (task_of(scene, 2).random != task.random).any()
    assert task.random.shape == (RANDOM_FRAMES, 4)
    assert task.frames.shape == (143 + RANDOM_FRAMES, 4)


def test_the_table_names_what_is_counted() -> None:
    cells = {kind: n for n, kind in enumerate(KINDS)}
    lines = compared([Row("one", cells, 8, 1, (2.25, 1.0))], "as measured").lines()
    heading = " ".join(lines[2].split())
    assert heading == "LUT4 flip-flop MULT18 RAMB16 clocks a frame every recorded random"
    assert lines[3].split() == ["one", "0", "3", "4", "5", "8", "1", "2.25", "1"]
    assert lines[-1] == "as measured"


def test_our_designs_are_found(task: Task) -> None:
    """These are the designs that take a frame in every clock, and the engine, each once."""
    names = [name for name, _ in ours.designs(load_scene("digit-single"), task)]
    assert {"parallel, precise", "engine, precise"} <= set(names)
    assert len(set(names)) == len(names)


@given(st.lists(st.integers(SIGNAL.low, SIGNAL.high), min_size=1, max_size=6))
def test_codes_in_one_word(codes: list[int]) -> None:
    word = packed(codes)
    assert 0 <= word < 1 << (SIGNAL.width * len(codes))
    assert unpacked(word, len(codes)) == codes


PIPELINE = """module top(input clk, input [27:0] model_inp, output reg [27:0] model_out);
    reg [27:0] held;
    always @(posedge clk) begin held <= model_inp; model_out <= held; end
endmodule
"""


def test_a_pipeline_is_played(tmp_path: Path) -> None:
    """Every frame comes after its latency. With one clock less, the first value is unknown."""
    (tmp_path / "top.v").write_text(PIPELINE)
    frames = np.random.default_rng(1).integers(SIGNAL.low, SIGNAL.high + 1, (20, 2))
    assert (simulated(tmp_path, "top", frames, 2, 2) == frames).all()
    with pytest.raises(InputError, match="1 with unknown bits"):
        simulated(tmp_path, "top", frames, 2, 1)
    (tmp_path / "top.v").write_text("module top(;")
    with pytest.raises(InputError, match="iverilog: "):
        simulated(tmp_path, "top", frames, 2, 2)


def tried(task: Task, cost: float, off: int) -> da4ml_rows.Tried:
    """A setting with an error of about ``off`` units of the last place."""
    real = task.mlp.process(SIGNAL.to_real(task.frames))
    codes = SIGNAL.quantise(real, "outputs")[0]
    # The values are away from the end of the range, so that none saturates.
    codes -= off * np.sign(codes)
    return da4ml_rows.Tried(f"off {off}", cost, 8, codes, Path())


def test_the_cheapest_that_is_near_enough_is_taken(task: Task) -> None:
    settings = [tried(task, 3.0, 0), tried(task, 2.0, 1), tried(task, 1.0, 5)]
    for most, name in (((9.0, 9.0), "off 5"), ((2.0, 2.0), "off 1"), ((9.0, 0.9), "off 0")):
        assert da4ml_rows.cheapest(settings, task, most).setting == name
    with pytest.raises(InputError, match="no setting has errors of at most"):
        da4ml_rows.cheapest(settings, task, (0.0, 0.0))


def test_another_da4ml_is_told(task: Task, tmp_path: Path) -> None:
    """Each text that is replaced in its Verilog must occur just once."""
    one = replace(tried(task, 1.0, 0), folder=tmp_path / "written")
    static, found = tmp_path / "written" / "src" / "static", tmp_path / "found"
    static.mkdir(parents=True)
    found.mkdir()
    adder = static / "shift_adder.v"
    adder.write_text("  wire [BW_ADD-1:0] accum;\n")
    da4ml_rows.collected(one, found, da4ml_rows.KEPT)
    assert (found / "shift_adder.v").read_text() == "  (* keep *) wire [BW_ADD-1:0] accum;\n"
    adder.write_text("  wire [BW_ADD-1:0] sum;\n")
    with pytest.raises(InputError, match=r"shift_adder\.v: got 0 times .*, expected once"):
        da4ml_rows.collected(one, found, da4ml_rows.KEPT)


def test_verilog_that_differs_from_its_model_is_told(
    task: Task, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = np.zeros((3, 4), dtype=np.int64)
    found = expected.copy()
    da4ml_rows.check(found, expected)
    found[1, 2] = 1
    with pytest.raises(InputError, match="1 of 3 frames differ between simulation and model"):
        da4ml_rows.check(found, expected)
    answer = {"outputs": expected.tolist(), "simulated": found.tolist()}
    monkeypatch.setattr(nngen_rows, "run_isolated", lambda *_: answer)
    with pytest.raises(InputError, match="1 of 3 frames differ between simulation and model"):
        nngen_rows.row(Path("python"), task, tmp_path)


def test_without_a_network_is_one_message(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def run(command: list[str], _: Path | None = None) -> str:
        if "pip" in command:
            raise InputError("python: ERROR: No matching distribution found")
        return ""

    monkeypatch.setattr(installed, "run", run)
    with pytest.raises(InputError, match=r"da4ml>=.*, nngen>=.*: not installed; .* a network"):
        installed.installed(tmp_path / "environment")
    assert not (tmp_path / "environment" / installed.READY).exists()
