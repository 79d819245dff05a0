"""The library's bench of each entity of an export, and the borders that it reaches.

A bench fails where it leaves out a border, a state or a value of a port that the twin does not
declare unreachable. So one that passes has reached all of them on this very entity. Where a record
of the library is of the same bytes, it stands for the run.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from tactus.certify.results import StepResult
from tactus.report.measure.table import Cell, Table
from tactus.verify.benches.kept_results import run_kept
from tactus.verify.benches.results import chosen
from tactus.verify.benches.runner import Job, Outcome, run_jobs
from tactus.verify.sign_off.record import recorded, short
from tactus.verify.sign_off.source import verilog
from tactus.verify.sign_off.subject import recorded_cases

STEP = "benches"
# Of reasons why a border cannot be reached, the table has so many of each entity.
REASONS = 3


@dataclass(frozen=True)
class BenchResult:
    """What is known of the bench of one entity.

    job: Of an entity around networks it has recorded frames alone, and then no border is asked for.
    recorded: Whether the library has a record of the same bytes, so that the bench did not run.
    compared: How many values the bench compared, if it ran.
    complaint: Why the bench failed; empty if it passed.
    """

    job: Job
    recorded: bool
    compared: int = 0
    complaint: str = ""

    @property
    def whole(self) -> bool:
        """Whether every border was asked for."""
        return self.recorded or not self.job.test


def run_benches(
    entities: Sequence[Job], drawn: Sequence[Job], tell: Callable[[str], None]
) -> list[BenchResult]:
    """Run the benches of the drawn ones among all entities, but for those that have a record."""
    # An instrument or a cascade takes minutes, and its networks have benches of their own.
    around = {job.entity for job in chosen(list(entities)) if job.test}

    def bench(job: Job) -> Outcome:
        tell(f"bench of {job.entity}")
        return run_kept(job)

    jobs = [replace(job, test="recorded") if job.entity in around else job for job in drawn]
    known = {job.entity: BenchResult(job, True) for job in jobs if same_bytes(job, "coverage")}
    new = [job for job in jobs if job.entity not in known]
    for outcome in run_jobs(new, lambda _: None, work=bench):
        complaint = "" if outcome.passed else outcome.complaint()
        known[outcome.job.entity] = BenchResult(outcome.job, False, outcome.compared, complaint)
    return [known[job.entity] for job in jobs]


def bench_result(benches: Sequence[BenchResult], entities: int) -> StepResult:
    """What the benches found, as a step. It is amber where something was not asked for."""
    failed = [f"{one.job.entity}: {one.complaint}" for one in benches if one.complaint]
    if failed:
        return StepResult("red", STEP, f"fail: {'; '.join(failed)}")
    short = [one.job.entity for one in benches if not one.whole]
    ran = sum(not one.recorded for one in benches)
    sides = sum(len(_reached(one)) for one in benches)
    figure = (
        f"{ran} ran, of {len(benches) - ran} the library has a record of the same bytes; both "
        f"sides of {sides} borders are reached"
    )
    if len(benches) < entities:
        figure += f"; {entities - len(benches)} other entities were not drawn"
    if short:
        figure += f"; to {', '.join(short)} only recorded frames were played"
    return StepResult("amber" if short or len(benches) < entities else "green", STEP, figure)


def bench_table(benches: Sequence[BenchResult]) -> Table:
    """What each bench reaches, and what cannot be reached and why."""
    rows: list[list[Cell]] = []
    for one in benches:
        twin = one.job.twin
        why = [f"{b.name}: {b.unreachable}" for b in twin.borders if b.unreachable]
        why += [f"{name}: {text}" for name, text in twin.unreachable.items()]
        more = [f"and {len(why) - REASONS} more"] if len(why) > REASONS else []
        rows.append(
            [
                one.job.entity,
                "recorded, of the same bytes" if one.recorded else _said(one),
                None if one.recorded else one.compared,
                len(_reached(one)) if one.whole else None,
                sum(len(state.values) for state in twin.states) if one.whole else None,
                len(why),
                "; ".join([*why[:REASONS], *more]) or "none",
            ]
        )
    return Table(
        STEP,
        [
            "entity",
            "its bench",
            "values compared",
            "borders, both sides reached",
            "values of states reached",
            "cannot be reached",
            "why",
        ],
        rows,
        "A border is a value of a number at which the behaviour changes, such as the first sum "
        "that saturates. The benches are those of the library, on Icarus and on this Verilog. They "
        "need tactus, so the script does not run them: make sim SCENE= does.",
    )


def _reached(one: BenchResult) -> list[str]:
    """The borders that the bench has reached; one that leaves out a border fails."""
    borders = one.job.twin.borders if one.whole and not one.complaint else ()
    return [border.name for border in borders if not border.unreachable]


def _said(one: BenchResult) -> str:
    if one.complaint:
        return "failed"
    return "passed" if one.whole else "passed with recorded frames"


def same_bytes(job: Job, kind: str) -> dict[str, Any] | None:
    """The record of a kind that was made of the same Verilog as an entity; None without one."""
    digest = short(verilog(job))
    for record in (recorded(kind, name) for name in recorded_cases(job.block)):
        for found in record.get("runs", [record]):
            if found.get("verilog") == digest:
                return dict(found)
    return None
