"""Runs every bench in both simulators, on its cases and on the shipped scenes.

Every run simulates each block in the cases in which its records are made, in both simulators. Those
other cases that drive something else it simulates in one of them, and ALL=1 in both. ``LEFT`` and
``LEFT_OF`` name the cases that only ALL=1 simulates. Where a case combines two properties, such as
ReLU and a program that can be reloaded, every run has each of them in another case.
"""

from pathlib import Path

import pytest
from conftest import tiered
from shared import Shared

from golden.activation.left_out import left_out
from golden.scene import load_scene
from tb.common.collected import BENCHES, CASES, CASES_OF, blocks_of
from tb.common.runner import Job, Outcome
from tb.common.tools import SIMULATORS
from tb.report.measure.clocks import clocks_per_frame
from tb.sign_off.current import stale_records
from tb.sign_off.subject import recorded_cases

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")

# Every run plays all recorded frames through the default scene. ALL=1 adds the design with every
# multiplication at once, and the design of the thesis in its arithmetic, which `make demo`
# simulates too. The cases cover the other arrangements and interfaces.
NETWORKS = tiered(
    ["digit"],
    [
        *("digit-parallel", "digit-single-thesis"),
        *(f"comparison/swing-{form}-thesis" for form in ("single", "multiple", "cascade")),
    ],
)


# These cases drive the same as others in other sizes, so only ALL=1 runs them. ``chain-engine`` is
# a cascade on the engine, as ``digit`` is, whose recorded frames every run plays. ``ranged-engine``
# differs from ``steep-engine`` in ``round_saturate``, of which every run has all cases. And
# ``tables-serial`` has the tables of ``tables-engine`` and the sum of ``least-serial``.
LEFT = (
    *("deep-cascade", "slow-axis-cascade", "huge-exact", "wide-thesis", "pade-thesis"),
    *("profile", "other-profile", "deep-reload", "three-engine", "huge-engine"),
    *("chain-engine", "ranged-engine"),
    *("one-past", "few-past", "three-past", "serial-past", "axis-past", "drawn-past"),
    *("instrument", "slower-cascade", "wide-multiple", "wide-parallel"),
    *("wide-converter", "signed-converter", "bipartite-low", "short-graph", "logic-graph"),
    *("chain-serial", "axis-cascade", "gradient_parallel-thesis", "lut-exact", "polynomial-exact"),
    *("deep-least-engine", "wide-engine", "tables-serial", "wide-graph", "least-thesis"),
    *("pade-exact", "pade-axis", "parallel", "polynomial-thesis", "gradient_parallel-exact"),
    *("three-graph", "axis-multiple", "chain-past"),
    *("huge", "huge-parallel", "logic-huge", "block-ram-huge"),
    *("reload-uart", "wide-uart", "plain-uart", "engine-instrument"),
    *("precise-parallel", "axis-engine", "fine-serial", "deep-layers-engine"),
    *(
        "hybrid-winner",
        "winner-past",
        "winner-long",
        "winner-converter",
        "winner-uart",
        "least-winner-axis",
    ),
    *("winner-reload", "drawn-winner", "wide-winner", "winner-instrument"),
    *("small-tables-engine", "tables-reload", "tables-lanes-reload"),
    *("exact-reload", "layers-reload", "layers-serial", "bipartite-logic"),
    *("least-graph", "polynomial-short", "relu-graph", "narrow-graph"),
    *("least-axis", "least-cascade", "least-multiple", "least-instrument"),
    *("least-lanes", "huge-lanes", "chain-lanes", "three-lanes", "flat-lanes"),
    *("least-loop", "chain-loop", "relu-loop", "layers-loop", "deep-loop", "loop-past"),
    *("axis-loop", "winner-loop"),
)
# So are these of cases whose other blocks are simulated in every run. An engine with several layers
# is ``steep-engine``, and a cascade is ``chain``: what is different in ``layers-engine`` and in
# ``slow-cascade`` are these other blocks.
LEFT_OF = {
    "block-ram": {"hybrid"},
    "bell-lanes": {"lanes"},
    "deep-engine": {"engine"},
    "deep-lanes": {"lanes"},
    "deep-tables-engine": {"engine"},
    "exact-engine": {"engine"},
    "exact-lanes": {"lanes"},
    "fine-engine": {"engine", "operand_select", "program_memory"},
    "floor-engine": {"engine"},
    "floor-lanes": {"lanes"},
    "layers-lanes": {"lane_memory"},
    "least": {"gradient", "output_controller", "output_integral"},
    "layers-engine": {"engine"},
    "logic": {"hybrid"},
    "rails-lanes-reload": {"frame_guard"},
    "rails-serial": {"engine"},
    "slow-cascade": {"cascade"},
    "tables-lanes": {"lanes"},
    "wide": {"gradient", "output_controller", "output_integral"},
}


# Networks of these are proved for every frame (test_every_frame.py), so in every run each has its
# recorded cases only. Engines without a multiplier are not proved.
PROVED = ("engine", "lanes", "hybrid", "parallel", "table_graph")
SERIAL = "least-serial"


def left(block: str, case: str) -> bool:
    """Whether a bench's case is left to ALL=1."""
    proved = block in PROVED and case not in (SERIAL, *recorded_cases(block).values())
    return proved or case in LEFT or block in LEFT_OF.get(case, ())


def simulators_of(block: str, case: str) -> tuple[str, ...]:
    """The simulators of a case in every run: cases without records take turns.

    If there is only one case of a bench in every run, it is simulated in both.
    """
    both = tuple(SIMULATORS)
    others = [name for name in CASES_OF[block] if not left(block, name)]
    if case in recorded_cases(block).values() or case not in others or others == [case]:
        return both
    return (both[others.index(case) % len(both)],)


# Each bench with each of its cases. Those of a case are together, because they share exports.
PAIRS = [
    pytest.param(block, case, marks=[pytest.mark.all_only] if left(block, case) else [])
    for case in sorted(CASES, key=lambda name: name in LEFT)
    for block in sorted(blocks_of(case))
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


@pytest.mark.parametrize("block", BENCHES)
def test_a_bench_has_cases(block: str) -> None:
    assert CASES_OF[block], f"tb_{block}.py: CASES: got none"


def test_every_bench_has_a_case_in_every_run() -> None:
    assert set(LEFT) <= set(CASES)
    assert all(blocks < blocks_of(case) for case, blocks in LEFT_OF.items())
    assert {b for case in CASES for b in blocks_of(case) if not left(b, case)} == set(BENCHES)


def test_every_run_has_each_bench_in_both_simulators() -> None:
    for block, cases in CASES_OF.items():
        kept = [case for case in cases if not left(block, case)]
        assert {s for case in kept for s in simulators_of(block, case)} == set(SIMULATORS)


@pytest.mark.parametrize(("block", "case"), PAIRS)
def test_hardware_equals_twin(
    shared: Shared, block: str, case: str, request: pytest.FixtureRequest
) -> None:
    """Run a block in a case of its bench."""
    # Whoever works on one block sees it in both.
    every = request.config.getoption("all") or request.config.getoption("block")
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


@pytest.mark.all_only
@pytest.mark.parametrize("case", CASES)
def test_all_constants_of_a_case(shared: Shared, case: str) -> None:
    """Run the entities that test_hardware_equals_twin leaves out."""
    blocks = blocks_of(case)
    left = []
    for simulator in SIMULATORS:
        jobs = [job for job in shared.jobs(case, simulator) if job.block in blocks]
        left += [job for job in jobs if job not in one_of_each(jobs)]
    if left:
        check(shared.run(left))


def test_the_cases_differ_as_meant(tmp_path: Path) -> None:
    designs = {name: case.scene(tmp_path, name).twin() for name, case in CASES.items()}
    assert designs["wide"].input_controller.spacing == 5
    assert designs["least"].input_controller.spacing == 0
    assert designs["wide-multiple"].input_controller.spacing == 3
    assert designs["pade-parallel"].interval == 3
    assert designs["parallel"].interval == 1
    assert designs["axis"].spacing == 5
    assert designs["axis-cascade"].slots == 2
    for name, interval in (("slow-cascade", 3), ("slower-cascade", 11)):
        assert designs[name].interval == interval
        assert designs[name].frame_store.outputs == 3
    assert designs["slow-axis-cascade"].spacing == 11
    assert designs["deep-cascade"].frame_store is None
    for form in ("logic", "block-ram"):
        few = max(a.words for a in designs[form].activations)
        assert few < designs[f"{form}-huge"].activations[0].words
    assert max(int(a.variant[1:].split("c")[0]) for a in designs["huge"].activations) > 200
    for name in CASES:
        if CASES[name].shapes == [(2, 1, 2)]:
            (activation,) = designs[name].activations
            assert bool(left_out(activation)) == name.endswith("short"), name
    assert designs["pade-exact"].input_controller.spacing == 3
    assert designs["profile"].load_profile.divider.gain_frac == 0
    assert designs["other-profile"].load_profile.divider.gain_frac == 15
    assert designs["other-profile"].load_profile.ramp.start < 0
