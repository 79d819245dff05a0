"""Runs every bench on its cases, and the recorded frames of the shipped scenes.

Every run simulates each block in the cases in which its records are made, in one of the simulators:
that VHDL and Verilog are one function is proved (test_records.py). Default scenes are simulated in
both. ALL=1 adds the other cases, and the other simulator. Cases of whole networks are proved for
every frame instead (test_every_frame.py).
"""

import pytest
from conftest import tiered
from shared import Shared
from test_every_frame import NETWORKS as WHOLE_NETWORKS

from tactus.report.measure.networks import clocks_per_frame
from tactus.scene import load_scene
from tactus.verify.benches.collected import BENCHES, CASES, CASES_OF
from tactus.verify.benches.runner import Job, Outcome
from tactus.verify.benches.tools import SIMULATORS
from tactus.verify.sign_off.record import stale_records
from tactus.verify.sign_off.subject import recorded_cases

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")

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
            assert outcome.facts["interval"] == design.interval
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


@pytest.mark.parametrize("scene", NETWORKS)
def test_recorded_frames_of_a_scene(shared: Shared, scene: str) -> None:
    """Run the whole network of a shipped scene, in both simulators."""
    top = load_scene(scene).twin().entity
    outcomes = shared.run([j for s in SIMULATORS for j in shared.jobs(scene, s) if j.entity == top])
    assert len(outcomes) == len(SIMULATORS)
    check(outcomes)
    check_clocks(outcomes)
