"""Runs every bench in both simulators, on its cases and on the shipped scenes.

Every run simulates each block in the cases in which its records are made, in both simulators. Those
other cases that drive something else it simulates in one of them, and ALL=1 in both. ``ALL_ONLY``
names the cases that only ALL=1 simulates. Whole networks that the proof of every frame covers are
simulated in few cases, and proved in the others (test_every_frame.py).
"""

import pytest
from conftest import tiered
from shared import Shared
from test_every_frame import NETWORKS as WHOLE_NETWORKS

from tactus.report.measure.clocks import clocks_per_frame
from tactus.scene import load_scene
from tactus.verify.benches.collected import BENCHES, CASES, CASES_OF, blocks_of
from tactus.verify.benches.runner import Job, Outcome
from tactus.verify.benches.tools import SIMULATORS
from tactus.verify.sign_off.current import stale_records
from tactus.verify.sign_off.subject import recorded_cases

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")

# Every run plays all recorded frames through a default scene. ALL=1 adds the other one, the design
# that is not proved for every frame, and a whole board.
NETWORKS = tiered(["digit"], ["thesis", "digit-fast", "digit-board"])

# Cases that ALL=1 adds: images and a serial line around an engine, no multiplier, converters,
# profiles, graphs of adders that are not proved, and activations of the thesis.
ALL_ONLY = (
    *("deep-reload", "tables-reload", "tables-lanes-reload", "reload-uart", "plain-uart"),
    *("serial-past", "loop-past", "chain-past", "past-uart"),
    *("winner-uart", "winner-reload", "drawn-winner", "winner-instrument", "other-profile"),
    *("wide-converter", "signed-converter", "least-instrument", "engine-instrument"),
    *("axis-cascade", "axis-past", "axis-loop", "least-axis", "wide-winner", "hybrid-winner"),
    *("short-graph", "three-graph", "logic-graph", "relu-graph", "narrow-graph"),
    *("pade-thesis", "polynomial-thesis", "polynomial-short", "gradient_parallel-thesis"),
    *("bipartite-low", "bipartite-logic", "logic-huge", "block-ram-huge", "chain-loop"),
    *("deep-least-engine", "huge-engine"),
)
# Of these cases it adds the whole network. Every run simulates the other blocks.
WHOLE = ("rails-lanes-reload",)
# Other tests need these cases, which drive the same as others in other sizes. No bench runs them.
LEFT = (
    *("slow-axis-cascade", "axis-multiple", "axis-engine", "few-past", "drawn-past"),
    *("winner-past", "winner-loop", "wide-uart", "winner-converter"),
    *("least-graph", "layers-reload", "exact-reload"),
)
# Nor these of cases whose other blocks are simulated, but for records.
LEFT_OF = {
    "fine-engine": {"operand_select", "program_memory"},
    "layers-lanes": {"lane_memory"},
    "rails-lanes-reload": {"frame_guard"},
}


def every_run(block: str, case: str) -> bool:
    """Whether every run simulates a bench's case."""
    left = case in (*LEFT, *ALL_ONLY) or block in LEFT_OF.get(case, ())
    whole = block in WHOLE_NETWORKS and case in WHOLE
    recorded = case in recorded_cases(block).values()
    return not left and not whole and (recorded or not proved(block, case))


def only_all(block: str, case: str) -> bool:
    """Whether only ALL=1 simulates a bench's case."""
    whole = block in WHOLE_NETWORKS and case in WHOLE
    chosen = (whole or case in ALL_ONLY) and not proved(block, case)
    recorded = case in recorded_cases(block).values()
    return not every_run(block, case) and (recorded or chosen)


def proved(block: str, case: str) -> bool:
    """Whether a case of a whole network is proved for every frame, which shows no other images."""
    return block in WHOLE_NETWORKS and case != "rails-lanes-reload"


def simulators_of(block: str, case: str) -> tuple[str, ...]:
    """The simulators of a case in every run: cases without records take turns.

    If there is only one case of a bench in every run, it is simulated in both.
    """
    both = tuple(SIMULATORS)
    others = [name for name in CASES_OF[block] if every_run(block, name)]
    if case in recorded_cases(block).values() or case not in others or others == [case]:
        return both
    return (both[others.index(case) % len(both)],)


# Each bench with each of its cases. Those of a case are together, because they share exports.
PAIRS = [
    pytest.param(block, case, marks=[pytest.mark.all_only] if only_all(block, case) else [])
    for case in sorted(CASES, key=lambda name: name in ALL_ONLY)
    for block in sorted(blocks_of(case))
    if every_run(block, case) or only_all(block, case)
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


def test_every_bench_has_a_case_in_every_run() -> None:
    assert {*LEFT, *ALL_ONLY, *WHOLE} <= set(CASES)
    assert all(blocks < blocks_of(case) for case, blocks in LEFT_OF.items())
    assert {b for case in CASES for b in blocks_of(case) if every_run(b, case)} == set(BENCHES)


@pytest.mark.parametrize(("block", "case"), PAIRS)
def test_hardware_equals_twin(
    shared: Shared, block: str, case: str, request: pytest.FixtureRequest
) -> None:
    """Run a block in a case of its bench."""
    # Whoever works on one block sees it in both.
    every = request.config.getoption("all") or request.config.getoption("keyword")
    simulators = tuple(SIMULATORS) if every else simulators_of(block, case)
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
