"""Runs every bench on its cases, and the recorded frames of the shipped scenes.

Every run simulates each block in the cases in which its records are made, in one of the simulators:
that VHDL and Verilog are one function is proved (test_records.py). Default scenes are simulated in
both. ALL=1 adds the other cases, and the other simulator. Cases of whole networks are proved for
every frame instead (test_every_frame.py).
"""

import json
import logging
import os
import re
import signal
import warnings
from pathlib import Path

import pytest
from conftest import tiered
from shared import Shared, copied_job
from test_every_frame import NETWORKS as WHOLE_NETWORKS

from tactus.report.measure.networks import clocks_per_frame
from tactus.scene import load_scene
from tactus.verify.benches.collected import BENCHES, CASES, CASES_OF
from tactus.verify.benches.runner import Job, Outcome, run_job
from tactus.verify.benches.simulate import analyse, simulate
from tactus.verify.benches.tools import SIMULATORS
from tactus.verify.sign_off.record import recorded_cases, stale_records
from tb.common.bench import CONFIGURATION

# Every run plays all recorded frames through a default scene. ALL=1 adds the other one, the design
# that is not proved for every frame, and a whole board.
NETWORKS = tiered(["digit"], ["thesis", "digit-fast", "digit-board"])

# Other tests need these cases, which drive the same as others in other sizes. No bench runs them.
LEFT = (
    *("slow-axis-cascade", "axis-multiple", "few-past", "winner-past"),
    *("least-graph", "layers-reload", "exact-reload"),
)


def recorded(block: str, case: str) -> bool:
    return case in recorded_cases(block).values()


def proved(block: str, case: str) -> bool:
    """Whether a case of a whole network is proved for every frame, which shows no other images."""
    return block in WHOLE_NETWORKS and case != "rails-lanes-reload"


# Each bench with each of its cases. Those of a case are together, because they share exports.
PAIRS = [
    pytest.param(block, case, marks=[] if recorded(block, case) else [pytest.mark.all_only])
    for case in CASES
    for block in sorted(BENCHES)
    if case in CASES_OF[block]
    if recorded(block, case) or not (case in LEFT or proved(block, case))
]


def one_of_each(jobs: list[Job]) -> list[Job]:
    """The first entity of each block. Others differ only in constants."""
    return list({job.block: job for job in jobs}.values())


def check(outcomes: list[Outcome]) -> None:
    """Check that no bench failed, both simulators compared equally much, and records are current.

    The records of a bench belong to its trace, and each run shows whether the trace is still the
    same.
    """
    failed = [f"{o.job.simulator}, {o.job.entity}: {o.complaint()}" for o in outcomes]
    assert all(o.passed for o in outcomes), "\n".join(
        line for line, o in zip(failed, outcomes, strict=True) if not o.passed
    )
    counts, traces = (
        [
            {o.job.entity: value(o) for o in outcomes if o.job.simulator == simulator}
            for simulator in sorted({o.job.simulator for o in outcomes})
        ]
        for value in (lambda o: o.compared, lambda o: o.facts["played"])
    )
    assert counts[0] == counts[-1]
    assert all(count > 0 for count in counts[0].values())
    assert traces[0] == traces[-1]
    assert all(traces[0].values())
    assert [line for o in outcomes for line in stale_records(o)] == []


def check_clocks(outcomes: list[Outcome]) -> None:
    """Check that the clocks of whole networks are the published ones."""
    for outcome in outcomes:
        design = outcome.job.scene.twin()
        if outcome.job.entity == design.entity:
            assert outcome.facts.get("interval", design.interval) == design.interval
            assert outcome.facts["clocks_per_frame"] == clocks_per_frame(design)


@pytest.mark.parametrize(("block", "case"), PAIRS)
def test_hardware_equals_twin(shared: Shared, block: str, case: str, request) -> None:
    # Whoever works on one block sees it in both.
    every = request.config.getoption("all") or request.config.getoption("keyword")
    both = tuple(SIMULATORS)
    simulators = both if every else both[list(BENCHES).index(block) % 2 :][:1]
    jobs = [
        job for s in simulators for job in one_of_each(shared.jobs(case, s)) if job.block == block
    ]
    outcomes = shared.run(jobs)
    assert len(outcomes) == len(simulators), f"tb_{block}.py: CASES: {case} has no {block}"
    check(outcomes)
    check_clocks(outcomes)
    # A network of a user may never decide for a class; those of the cases decide for each.
    for outcome in outcomes:
        found = outcome.facts["coverage"]["ports"].get("winner_index", {})
        assert all(found.values()), f"{block}: {case}: {found}"


@pytest.mark.parametrize("scene", NETWORKS)
def test_recorded_frames_of_a_scene(shared: Shared, scene: str) -> None:
    """Run the whole network of a shipped scene, in both simulators."""
    top = load_scene(scene).twin().entity
    outcomes = shared.run([j for s in SIMULATORS for j in shared.jobs(scene, s) if j.entity == top])
    assert len(outcomes) == len(SIMULATORS)
    check(outcomes)
    check_clocks(outcomes)


VHDL = """\
entity wire is
    port (a: in bit; b: out bit);
end entity wire;

architecture plain of wire is
begin
    b <= a;
end architecture plain;
"""
VERILOG = "module wire_1(input a, output b); assign b = a; endmodule\n"
ENTITY = "wire_1"
HEAD = "import json, os, pathlib, cocotb, cocotb.triggers\n\n"


@pytest.fixture(params=SIMULATORS)
def wire(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """The simulator in which ``play`` runs benches of an entity that is a wire."""
    for name, text in ((f"{ENTITY}.vhd", VHDL.replace("wire", ENTITY)), (f"{ENTITY}.v", VERILOG)):
        (tmp_path / name).write_text(text)
    if request.param == "ghdl":
        analyse([tmp_path / f"{ENTITY}.vhd"], tmp_path)
    return request.param


def play(
    wire: str, folder: Path, bench: str, waves: bool = False, **environment: str
) -> tuple[bool, str]:
    """Whether a bench passed, and its log."""
    (folder / "bench.py").write_text(HEAD + bench)
    given = {"PATH": os.environ["PATH"], "PYTHONPATH": str(folder)} | environment
    log, sources = folder / "log.txt", [folder / f"{ENTITY}.v"]
    good = simulate(wire, ENTITY, "bench", sources, folder, folder / "run", waves, given, log)
    return good, log.read_text()


SOUND = """
@cocotb.test()
async def passes(dut):
    dut.a.value = 1
    await cocotb.triggers.Timer(1, "ns")
    assert dut.b.value == 1
    pathlib.Path("environment.json").write_text(json.dumps(dict(os.environ)))
"""
WRONG = """
@cocotb.test()
async def fails(dut):
    assert False, "seven is not eight"
"""
SKIPPED = SOUND.replace("test()", "test(skip=True)")
ENDS = """
@cocotb.test()
async def ends(dut):
    os._exit(0)
"""


def test_a_bench_that_passes_prints_nothing_and_changes_nothing(
    wire: str, tmp_path: Path, capfd
) -> None:
    def shared_by_the_process() -> list[object]:
        logs = [logging.getLogger(name) for name in ("", "cocotb")]
        handlers = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
        return [*handlers, [(log.level, [*log.handlers]) for log in logs], [*warnings.filters]]

    before = shared_by_the_process()
    good, log = play(wire, tmp_path, SOUND)
    assert good, log
    assert "bench.passes" in log
    assert capfd.readouterr() == ("", "")
    assert shared_by_the_process() == before
    assert not list((tmp_path / "run").glob("*.ghw")) + list((tmp_path / "run").glob("*.fst"))


@pytest.mark.parametrize(
    ("bench", "said"),
    [(WRONG, "seven is not eight"), (SKIPPED, "SKIP=1"), (ENDS, "Running tests"), ("", "")],
    ids=["wrong", "skipped", "ended", "without-tests"],
)
def test_a_bench_that_does_not_pass_is_false_and_its_log_says_why(
    wire: str, tmp_path: Path, bench: str, said: str, capfd
) -> None:
    good, log = play(wire, tmp_path, bench)
    assert not good
    assert said in log
    assert capfd.readouterr() == ("", "")


def test_what_cannot_be_built_is_false_and_its_log_says_why(wire: str, tmp_path: Path) -> None:
    (tmp_path / f"{ENTITY}.v").write_text("module other; endmodule\n")
    for unit in tmp_path.glob("*.cf"):
        unit.unlink()
    good, log = play(wire, tmp_path, SOUND)
    assert not good
    assert ENTITY in log


def test_the_environment_is_the_given_one_alone(wire: str, tmp_path: Path, monkeypatch) -> None:
    elsewhere = tmp_path / "elsewhere.xml"
    inherited = {
        "COCOTB_TEST_FILTER": "matches_nothing",
        "COCOTB_RESULTS_FILE": str(elsewhere),
        "RESULT_TESTPACKAGE": "another",
        "SIM": "verilator",
        "TACTUS_INHERITED": "1",
        "WAVES": "yes",
    }
    for name, value in inherited.items():
        monkeypatch.setenv(name, value)
    good, log = play(wire, tmp_path, SOUND, GIVEN="yes")
    assert good, log
    seen = json.loads(((tmp_path / "run") / "environment.json").read_text())
    assert seen["GIVEN"] == "yes"
    assert {name for name in inherited if name in seen} == {"COCOTB_RESULTS_FILE"}
    assert Path(seen["COCOTB_RESULTS_FILE"]).parent == (tmp_path / "run")
    assert not elsewhere.exists()


def test_waves_are_written(wire: str, tmp_path: Path) -> None:
    good, log = play(wire, tmp_path, SOUND, waves=True)
    assert good, log
    ending = {"ghdl": "ghw", "icarus": "fst"}[wire]
    assert ((tmp_path / "run") / f"{ENTITY}.{ending}").stat().st_size > 0


def test_a_job_inherits_no_variable_that_changes_a_bench(
    shared: Shared, tmp_path: Path, monkeypatch
) -> None:
    job = copied_job(shared.subject("abs_unit"), tmp_path)
    expected = run_job(job)
    monkeypatch.setenv("COCOTB_TEST_FILTER", "matches_nothing")
    monkeypatch.setenv("COCOTB_RANDOM_SEED", "not a number")
    monkeypatch.setenv(CONFIGURATION, "{}")
    outcome = run_job(job)
    assert outcome.passed, outcome.complaint()
    assert outcome.compared == expected.compared


# To import any of these takes longer than many a bench. A run starts hundreds of benches.
HEAVY = {"IPython", "jinja2", "joblib", "matplotlib", "onnx", "pandas", "rich", "scipy"}


def imported(log: str) -> set[str]:
    """The packages of which Python says that it imported them."""
    return set(re.findall(r"^import time:.*\| +(\w+)", log, re.M))


def test_a_bench_imports_nothing_heavy(shared: Shared, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setenv("PYTHONPROFILEIMPORTTIME", "1")
    outcome = run_job(copied_job(shared.subject("abs_unit"), tmp_path))
    log = outcome.log.read_text(encoding="utf-8")
    found = imported(log)
    assert {"golden", "numpy", "cocotb"} <= found
    assert not found & (HEAVY | {"myhdl", "_pytest"})
    # Whoever reads a scene imports the twins of all designs.
    assert re.search(r"\| +golden\.common\.block$", log, re.M)
    assert not re.search(r"\| +tactus(\.\w+)*$", log, re.M)
