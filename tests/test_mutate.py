"""Tests that recorded mutation scores are current and high, and that the method can fail."""

import json
import re
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from shared import Shared

from golden.input_error import InputError
from tactus.core import store
from tactus.core.store import VARIABLE
from tactus.report.page import sign_off
from tactus.report.page.sign_off import percent
from tactus.verify.benches import runner
from tactus.verify.benches.collected import BENCHES
from tactus.verify.benches.runner import run_job
from tactus.verify.sign_off.mutate import same
from tactus.verify.sign_off.mutate.mutants import (
    explain,
    explanations,
    given,
    make_mutants,
    write_netlists,
)
from tactus.verify.sign_off.mutate.replay import replay, write_trace
from tactus.verify.sign_off.mutate.same import OPEN, OTHER, SAME, proved
from tactus.verify.sign_off.mutate.score import COUNT, Subject, describe, prepare, run_bench
from tactus.verify.sign_off.record import read_record, recorded_cases, records

LEAST = 0.99
SCORED = sorted(records("mutation"))
# A few mutants of a small block, because this tests the method and not the block.
FEW = 12


@pytest.mark.parametrize("name", SCORED)
def test_the_score_is_high_and_every_survivor_explained(name: str) -> None:
    record, block = read_record("mutation", name), name.partition(".")[0]
    survivors = record["survivors"]
    assert record["killed"] + record["same"] + len(survivors) == record["mutants"]
    counted = record["mutants"] - record["same"] - record["explained"]
    assert record["score"] == round(record["killed"] / counted, 4)
    assert record["score"] >= LEAST
    for one in survivors:
        assert one["explained"], f"{one['where']}: {one['what']}: not explained"
        assert one["explained"] == explain(block, record["scene"], one["what"])


def test_explanations_are_of_survivors() -> None:
    for block in BENCHES:
        seen: set[str] = set()
        written: set[str] = set()
        for name in recorded_cases(block):
            record = read_record("mutation", name)
            patterns = explanations(block, record["scene"])
            written |= patterns.keys()
            for one in record["survivors"]:
                seen |= {pattern for pattern in patterns if re.fullmatch(pattern, one["what"])}
        assert seen == written, f"{block}: {written - seen}"


@pytest.fixture(scope="module")
def small(shared: Shared, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Subject]:
    """The block abs_unit with a few mutants, without results of earlier runs."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(VARIABLE, str(tmp_path_factory.mktemp("store")))
        job = shared.subject("abs_unit")
        hdl = job.hdl_folder.resolve()
        job = replace(job, build=tmp_path_factory.mktemp("build"))
        job.hdl_folder.parent.mkdir(parents=True)
        job.hdl_folder.symlink_to(hdl)
        yield prepare(job, tmp_path_factory.mktemp("small"), FEW, seed=3)


@pytest.fixture(scope="module")
def recorded(small: Subject) -> str:
    """The trace of the bench: what it drove, recorded and read."""
    job = replace(small.job, trace=True)
    assert run_job(job).passed
    return job.trace_file.read_text(encoding="utf-8")


def found(small: Subject, recorded: str, folder: Path) -> list[bool]:
    """Whether the replay of a trace detects the sound netlist, and each mutant."""
    (folder / "recorded").write_text(recorded, encoding="utf-8")
    shutil.copy(small.folder / "abs_unit.v", folder)
    trace = write_trace(folder / "recorded", "abs_unit", folder)
    return [bool(replay(trace, small.sources(n))) for n in range(FEW + 1)]


@pytest.mark.all_only
def test_what_the_replay_finds_the_bench_finds(
    small: Subject, recorded: str, tmp_path: Path
) -> None:
    differ = found(small, recorded, tmp_path)
    assert not differ[0]
    assert sum(differ) > FEW / 2
    assert run_bench(small, differ.index(True))


def test_a_verdict_of_the_bench_is_of_all_that_enters_it(small: Subject, monkeypatch) -> None:
    asked: list[store.Key] = []
    monkeypatch.setattr(store, "cached", lambda key, work: asked.append(key) or True)
    for job in (small.job, replace(small.job, seed=2), replace(small.job, frames=7)):
        run_bench(replace(small, job=job), 1)
    run_bench(small, 2)
    assert len({key.digest for key in asked}) == 4
    assert {"bench", "twin", "twins", "simulated", "tools"} <= asked[0].parts.keys()


def test_a_bench_that_fails_for_want_of_room_detects_no_mutant(small: Subject, monkeypatch) -> None:
    monkeypatch.setattr(runner, "simulate", lambda *_: False)
    monkeypatch.setattr(runner, "ROOM", 1 << 80)
    with pytest.raises(InputError, match="full, so nothing is known of abs_unit in icarus"):
        run_bench(small, FEW)
    monkeypatch.setattr(runner, "ROOM", 0)
    assert run_bench(small, FEW), "what was not known was not kept"


@pytest.mark.all_only
def test_what_the_bench_does_not_look_at_survives(
    small: Subject, recorded: str, tmp_path: Path
) -> None:
    """A bench that does not read the result only detects mutants that change flags."""
    parts = [json.loads(line) for line in recorded.splitlines()]
    for part in parts:
        part["looked"]["out_mag"] = "0" * len(part["looked"]["out_mag"])
    blind = found(small, "\n".join(map(json.dumps, parts)), tmp_path)
    assert sum(blind) < FEW / 2


CHANGES = """
module counter(clk, rst, in_valid, in_data, out_valid, out_data);
input clk;
input rst;
input in_valid;
input [3:0] in_data;
output out_valid;
reg out_valid;
output [3:0] out_data;
reg [3:0] out_data;
reg [1:0] count;
always @(posedge clk) begin: step
    if (rst == 1) begin
        count <= 0;
    end
    else if (count < 2) begin
        count <= count + 1;
    end
end
always @(posedge clk) begin: keep
    out_valid <= in_valid;
    out_data <= (in_valid ? in_data : 5);
    if (count == 3) begin
        out_data <= 0;
    end
end
endmodule
"""


@pytest.mark.all_only
def test_a_proof_tells_what_is_the_same_from_what_is_not(tmp_path: Path) -> None:
    (tmp_path / "counter.v").write_text(CHANGES)
    commands = make_mutants(["counter.v"], "counter", 200, 1, tmp_path)
    write_netlists(commands, "counter", tmp_path)
    found = {describe(command, tmp_path)[1]: command for command in commands}
    # Yosys made the cell that enables a register, so it is named by the register's process.
    assert "before keep: A[0] stuck at 1" in found
    # The first never differs. The second only differs in clocks that nothing reads.
    patterns = (
        r"keep: SRST.*stuck at 0",
        r".* : 5: A\[0\] inverted",
        r".* : 5: B\[0\] .* inverted",
    )
    chosen = [next(c for what, c in found.items() if re.fullmatch(p, what)) for p in patterns]
    answers = proved(chosen, "counter", tmp_path, {"out_data": "out_valid"})
    assert answers == [SAME, SAME, OTHER]
    alone = [proved([one], "counter", tmp_path, {"out_data": "out_valid"})[0] for one in chosen]
    assert alone == answers
    assert proved(chosen, "counter", tmp_path, {}) == [SAME, OTHER, OTHER]
    # The proof over several clocks is not tried for an explained mutant.
    assert proved(chosen, "counter", tmp_path, {}, {1, 3}) == [OPEN, OTHER, OPEN]


TWICE = """
module twice(clk, rst, in_valid, in_data, one, two);
input clk, rst, in_valid;
input [3:0] in_data;
output [3:0] one, two;
counter u_0 (.clk(clk), .rst(rst), .in_valid(in_valid), .in_data(in_data), .out_data(one));
counter u_1 (.clk(clk), .rst(rst), .in_valid(in_valid), .in_data(~in_data), .out_data(two));
endmodule
"""


def test_a_part_that_is_there_twice_is_mutated_and_proved_with_its_block(tmp_path: Path) -> None:
    (tmp_path / "counter.v").write_text(CHANGES)
    (tmp_path / "twice.v").write_text(TWICE)
    commands = make_mutants(["counter.v", "twice.v"], "twice", 60, 1, tmp_path, ["counter"])
    assert {given(command)["module"] for command in commands} == {"counter", "twice"}
    sound, *_ = write_netlists(commands, "twice", tmp_path, ["counter"])
    assert re.findall(r"^module (\w+)", sound.read_text(), re.M) == ["counter", "twice"]
    found = {describe(command, tmp_path)[1]: command for command in commands}
    chosen = [found["count + 1: A[1] stuck at 0"], found["count + 1: Y[1] inverted"]]
    assert proved(chosen, "twice", tmp_path, {}) == [SAME, OTHER]


@pytest.mark.all_only
def test_a_selection_that_yosys_takes_out_is_an_error(tmp_path: Path, monkeypatch) -> None:
    """A mutant of which the selection is gone is never taken for one that nothing reads."""
    (tmp_path / "counter.v").write_text(CHANGES)
    commands = make_mutants(["counter.v"], "counter", 1, 1, tmp_path)
    monkeypatch.setattr(same, "NARROWEST", 1)
    with pytest.raises(InputError, match="0 elements instead of the asserted 1"):
        proved(commands, "counter", tmp_path, {})


def test_the_page_tells_how_sure_a_score_is(monkeypatch) -> None:
    """The limits are those of the binomial distribution: 0.025 is left on either side."""
    facts = {"mutants": COUNT, "same": 7, "explained": 3, "killed": 189, "score": 0.9947}
    score, low = re.fullmatch(r"(\S+ %) \((\S+) to 100 %\)", percent(facts)).groups()
    assert score == "99.5 %"
    chance = float(low) / 100
    lost = 1 - chance
    at_least = chance**190 + 190 * chance**189 * lost
    assert at_least == pytest.approx(0.025, rel=0.1)
    assert percent({"mutants": 31, "score": 1}) == "100 %"
    facts["survivors"] = []
    of_block = {"mutation": {"abs_unit": facts}}
    monkeypatch.setattr(sign_off, "records", lambda kind: of_block.get(kind, {}))
    said = "mutants detected: 189 of 200; proved equivalent: 7; score"
    assert said in sign_off.sheet("abs_unit")
