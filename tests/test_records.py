"""The records of every block exist and are of its present source, whatever was recorded."""

from dataclasses import replace

import pytest
from shared import Shared

from tactus.verify.benches.collected import BENCHES, PROOFS
from tactus.verify.benches.runner import run_job
from tactus.verify.sign_off import coverage, equal, prove
from tactus.verify.sign_off.coverage import named_by
from tactus.verify.sign_off.netlist_record import KIND as NETLIST
from tactus.verify.sign_off.netlist_record import SCENES, families_of
from tactus.verify.sign_off.record import (
    COMMANDS,
    another_trace,
    of_this_verilog,
    read_record,
    records,
    short,
    stale_records,
    verilog,
)
from tactus.verify.sign_off.subject import recorded_cases
from tactus.verify.sign_off.unknown import UNKNOWN

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")

NAMES = {name: case for block in BENCHES for name, case in recorded_cases(block).items()}


def test_every_block_has_a_score() -> None:
    assert sorted(NAMES) == sorted(records("mutation"))
    assert set(PROOFS) <= set(BENCHES)


@pytest.mark.parametrize("name", NAMES)
def test_records_of_a_case_are_of_this_verilog(shared: Shared, name: str) -> None:
    block = name.partition(".")[0]
    job = shared.subject(block, case=NAMES[name])
    now = verilog(job)
    found = [of_this_verilog(kind, name, now) for kind in ("mutation", coverage.KIND, UNKNOWN)]
    assert found == [""] * 3
    score = read_record("mutation", name)
    assert (score["entity"], score["scene"]) == (job.entity, job.scene.name)
    again = f"the twin names something else; run: make coverage BLOCK={block} RECORD=1"
    assert read_record(coverage.KIND, name)["named"] == short(named_by(job.twin)), again
    registers = read_record(UNKNOWN, name)
    assert registers["passed"]
    assert bool(registers["control"]) == bool(registers["reset"])
    assert registers["control proved over clocks"] is None


@pytest.mark.parametrize("block", BENCHES)
def test_records_of_a_block_are_of_this_source(shared: Shared, block: str) -> None:
    pair = equal.Pair(shared.subject(block), shared.subject(block, "ghdl"))
    assert equal.check_record(pair) == []
    if block in PROOFS:
        planned = prove.entities(block, lambda block, case: shared.subject(block, case=case))
        assert prove.check_record(planned) == []
    runs = read_record(NETLIST, block)["runs"]
    again = f"run: {COMMANDS[NETLIST].format(block)}"
    assert all(run["passed"] and run["compared"] for run in runs), again
    found: dict[str, set[str]] = {}
    for run in runs:
        found.setdefault(run["verilog"], set()).add(run["family"])
    jobs = [shared.subject(block, case=case) for case in recorded_cases(block).values()]
    jobs += [job for name in SCENES for job in shared.jobs(name, "icarus") if job.block == block]
    expected: dict[str, set[str]] = {}
    for job in jobs:
        expected.setdefault(short(verilog(job)), set(families_of(job)))
    assert found == expected, again


BLOCK = "abs_unit"


@pytest.mark.parametrize(("seed", "kinds"), [(1, []), (2, list(COMMANDS))], ids=["same", "other"])
def test_another_trace_makes_records_stale(shared: Shared, tmp_path, seed: int, kinds: list[str]):
    job = shared.subject(BLOCK)
    (tmp_path / job.scene.name).mkdir()
    (tmp_path / job.scene.name / "verilog").symlink_to(job.hdl_folder)
    outcome = run_job(replace(job, build=tmp_path, seed=seed))
    assert outcome.passed
    found = stale_records(outcome)
    assert [line.split("run: ")[1] for line in found] == [COMMANDS[k].format(BLOCK) for k in kinds]


def test_what_another_scene_plays_is_not_compared(shared: Shared) -> None:
    outcome = run_job(shared.subject(BLOCK))
    outcome.facts["played"] = {"another": "trace"}
    assert stale_records(outcome)
    other = replace(outcome.job, scene=shared.scene("digit"))
    assert stale_records(replace(outcome, job=other)) == []


def test_a_record_of_some_tests_is_of_those() -> None:
    recorded = {"tests": "(a)", "played": {"a": "1"}}
    assert not another_trace(recorded, {"a": "1", "b": "2"})
    assert another_trace(recorded, {"a": "3", "b": "2"})
    assert another_trace(recorded, {"b": "2"})
    assert another_trace(recorded | {"played": {}}, {"a": "1"})
    whole = recorded | {"tests": "all"}
    assert another_trace(whole, {"a": "1", "b": "2"})
    assert not another_trace(whole, {"a": "1"})
