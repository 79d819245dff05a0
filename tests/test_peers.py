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
from tb.peers import alkaid_rows, da4ml_rows, installed, nngen_rows, ours
from tb.peers.__main__ import PEERS, brought, chosen
from tb.peers.collected import KEPT, collected
from tb.peers.comparison import Row, Task, compared, task_of
from tb.peers.simulated import check, packed, simulated, unpacked
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
    """Of Series 7 LUTs are counted, and of Virtex-II every kind; a foreign network has no errors."""
    cells = {
        family: {kind: n + start for n, kind in enumerate(KINDS)}
        for family, start in (("xc2v", 0), ("xc7", 10))
    }
    rows = [Row("digit", "one", cells, 8, 1, (2.25, 1.0)), Row("jets", "two", cells, 7, 1)]
    table = compared(rows, "as measured")
    assert table.columns[2:7] == ["LUT4", "LUT6", "flip-flop", "MULT18", "RAMB16"]
    assert table.rows[0] == ["digit", "one", 0, 10, 3, 4, 5, 8, 1, 2.25, 1.0]
    assert table.rows[1][-2:] == [None, None]
    assert table.lines()[-1] == "as measured"


def test_our_designs_are_found(task: Task) -> None:
    """These are the designs that take a frame in every clock, and the engine, each once."""
    names = [name for name, _ in ours.designs(load_scene("digit-single"), task)]
    assert {"parallel, precise", "engine, precise"} <= set(names)
    assert len(set(names)) == len(names)
    fast = load_scene("digit-fast")
    (only,) = ours.designs(fast, task_of(fast, 1))
    assert only[0] == "adder_graph, bipartite"
    assert only[1].entity == fast.twin().entity


@given(st.lists(st.integers(SIGNAL.low, SIGNAL.high), min_size=1, max_size=6))
def test_codes_in_one_word(codes: list[int]) -> None:
    word = packed(codes, SIGNAL.width)
    assert 0 <= word < 1 << (SIGNAL.width * len(codes))
    assert unpacked(word, len(codes), SIGNAL.width) == codes
    assert unpacked(packed([-3, 2], 3), 2, 3) == [-3, 2]


PIPELINE = """module peer(input clk, input [27:0] model_inp, output reg [27:0] model_out);
    reg [27:0] held;
    always @(posedge clk) begin held <= model_inp; model_out <= held; end
endmodule
"""


def test_a_pipeline_is_played(tmp_path: Path) -> None:
    """Every frame comes after its latency. With one clock less, the first value is unknown."""
    (tmp_path / "peer.v").write_text(PIPELINE)
    frames = np.random.default_rng(1).integers(SIGNAL.low, SIGNAL.high + 1, (20, 2))
    assert (simulated(tmp_path, frames, 2, 2) == frames).all()
    check("one", tmp_path, frames, frames, 2)
    with pytest.raises(InputError, match="one: 1 of 20 frames differ between simulation and model"):
        check("one", tmp_path, frames, np.where(np.arange(20)[:, None] == 7, 0, frames), 2)
    with pytest.raises(InputError, match=r"1 with unknown bits"):
        simulated(tmp_path, frames, 2, 1)
    (tmp_path / "peer.v").write_text("module peer(;")
    with pytest.raises(InputError, match="iverilog: "):
        simulated(tmp_path, frames, 2, 2)


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


def test_another_version_is_told(tmp_path: Path) -> None:
    """Each text that is replaced in a peer's Verilog must occur just once."""
    static = tmp_path / "src" / "static"
    static.mkdir(parents=True)
    adder = static / "shift_adder.v"
    adder.write_text("  wire [BW_ADD-1:0] accum;\n")
    collected("da4ml", tmp_path / "src", tmp_path / "found", KEPT)
    kept = (tmp_path / "found" / "shift_adder.v").read_text()
    assert kept == "  (* keep *) wire [BW_ADD-1:0] accum;\n"
    adder.write_text("  wire [BW_ADD-1:0] sum;\n")
    with pytest.raises(InputError, match=r"da4ml: shift_adder\.v: got 0 times .*, expected once"):
        collected("da4ml", tmp_path / "src", tmp_path / "again", KEPT)


def test_a_simulation_that_differs_is_told(
    task: Task, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = np.zeros((3, 4), dtype=np.int64)
    found = expected.copy()
    found[1, 2] = 1
    answer = {"outputs": expected.tolist(), "simulated": found.tolist()}
    monkeypatch.setattr(nngen_rows, "run_isolated", lambda *_: answer)
    with pytest.raises(InputError, match="1 of 3 frames differ between simulation and model"):
        list(nngen_rows.rows(Path("python"), {task.scene: task}, tmp_path))


def test_alkaid_is_asked_for_our_tables(task: Task) -> None:
    """Its question holds the words of two block RAMs and the codes of both layers."""
    asked = alkaid_rows.question(task)
    assert len(asked["bases"]) == 1024
    assert len(asked["corrections"]) == 2048
    assert asked["first"]["weights"] == task.constants.first.weights


def test_only_names_peers() -> None:
    assert chosen("") == list(PEERS)
    assert chosen("nngen alkaid") == ["alkaid", "nngen"]
    with pytest.raises(
        InputError,
        match="ONLY=alkaide: got 'alkaide', expected some of ours, al.*; did you mean 'alkaid'",
    ):
        chosen("alkaide")


def test_what_cannot_be_had_is_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The others go on, and the reason is told."""

    def run(command: list[str], _: Path | None = None) -> str:
        if "pip" in command:
            raise InputError("python: ERROR: No matching distribution found")
        return ""

    monkeypatch.setattr(installed, "run", run)
    places, missing = brought(["ours", "alkaid"], tmp_path)
    assert list(places) == ["ours"]
    (told,) = missing
    assert told.startswith("alkaid is left out: alkaid==")
    assert "a network" in told
    assert told.endswith("No matching distribution found")
    assert not (tmp_path / "peers" / "alkaid" / installed.READY).exists()


def test_a_program_that_is_not_there_is_told() -> None:
    with pytest.raises(InputError, match="not installed: no-such-program"):
        installed.run(["no-such-program"])


def test_versions_are_pinned() -> None:
    assert installed.pinned("alkaid") == "0.8.2"
    assert installed.pinned("da4ml") == "0.6.0"
