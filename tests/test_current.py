"""A record belongs to the trace of a bench. Another trace makes it stale, and nothing else does."""

from dataclasses import replace

import pytest
from shared import Shared

from tactus.verify.benches.runner import run_job
from tactus.verify.sign_off.current import COMMANDS, another_trace, stale_records

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
