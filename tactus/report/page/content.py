"""The content of the report of a scene."""

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from golden.common.block import walk
from golden.networks.network import Network
from golden.networks.table_sums import learned
from tactus.core.templates import environment
from tactus.report.designs import designs, picture_of, refused_lines, sentence
from tactus.report.draw.datapath import datapath
from tactus.report.draw.learned import learned_curves
from tactus.report.draw.load import load_profile
from tactus.report.draw.network import network
from tactus.report.draw.outcome import (
    along_plot,
    confusion,
    disturbance_plots,
    predicted_plots,
)
from tactus.report.draw.svg import Picture
from tactus.report.measure.networks import FAMILY
from tactus.report.measure.outcome import (
    Outcome,
    accuracy,
    along,
    confidence,
    noise_and_drift,
    outcome,
    per_class,
    sensors,
    telling,
    worst_rows,
    wrong_rows,
)
from tactus.report.measure.table import SEED, Cell, Table
from tactus.report.page import summary
from tactus.report.page.summary import Costs, blocks, costs, frame
from tactus.scene import Scene
from tactus.scene.building import compared
from tactus.verify.benches.results import stored_results
from tactus.verify.benches.runner import scene_variable
from tactus.verify.benches.tools import SIMULATORS, version
from tactus.verify.prove import proof_line


@dataclass(frozen=True)
class Section:
    """A part of the page.

    name: The name of the anchor.
    text, points: The paragraphs, and the list below them.
    tables: The tables that are shown in full.
    folded: The tables that are shown when the reader opens them, and in print.
    """

    name: str
    title: str
    text: Sequence[str] = ()
    points: Sequence[str] = ()
    pictures: Sequence[Picture] = ()
    tables: Sequence[Table] = ()
    folded: Sequence[Table] = ()


@dataclass(frozen=True)
class Page:
    """The whole report.

    built: The lines that say what was built.
    tables: Those of the first screen.
    made: The lines that say with which tools the report was made.
    """

    title: str
    built: Sequence[str]
    tables: Sequence[Table]
    sections: Sequence[Section]
    made: Sequence[str] = ()

    def render(self) -> str:
        templates = environment("tactus.report.page", escapes=True)
        return templates.get_template("page.html.jinja").render(page=self)

    def lines(self) -> list[str]:
        """The first screen as text."""
        told = [line for text in self.built for line in textwrap.wrap(text, 100)]
        return [
            self.title,
            "",
            *told,
            *(line for table in self.tables for line in ("", *table.lines())),
        ]


def content(scene: Scene) -> Page:
    """The report of a scene."""
    design, cost, found = scene.twin(), costs(scene), outcome(scene)
    disturbed = noise_and_drift(scene, SEED)
    places = along(found) if scene.group_by else None
    told = telling(scene)
    if scene.labels:
        errors = [confusion(scene, found.decisions)]
    else:
        errors = [plot.draw() for plot in predicted_plots(found)]
    if places:
        errors.append(along_plot(found, places).draw())
    sections = [
        _verified(scene),
        _errors(found, errors, places),
        Section(
            "sensors",
            "What the sensors do to it",
            pictures=[plot.draw() for plot in disturbance_plots(disturbed)],
            tables=[disturbed, sensors(found), *([told] if told else [])],
        ),
        Section(
            "left-out",
            "Left out",
            text=["What the project has and this scene does not need is not built:"],
            points=summary.left_out(scene, design),
        ),
        Section("pictures", "Pictures", pictures=list(pictures(scene)), folded=frame(scene)),
        _resources(scene, design, cost),
        _designs(scene),
    ]
    return Page(
        f"tactus: {scene.name}",
        summary.built(scene, design),
        [
            *([accuracy(found)] if scene.labels else []),
            summary.errors(found),
            summary.cost_table(scene, design, cost),
            *summary.in_units(scene),
        ],
        [section for section in sections if section is not None],
    )


def _errors(found: Outcome, pictures: list[Picture], places: Table | None) -> Section:
    tables = [worst_rows(found)]
    if found.scene.labels:
        wrong = wrong_rows(found)
        tables = [per_class(found), *([wrong] if wrong.rows else [])]
    return Section(
        "outputs",
        "Decisions" if found.scene.labels else "Errors row by row",
        pictures=pictures,
        tables=[*tables, confidence(found)],
        folded=[places] if places else [],
    )


def pictures(scene: Scene) -> Iterator[Picture]:
    hidden = sum(sum(network.shape[1:-1]) for network in scene.networks())
    nodes = network(scene)
    yield Picture(
        "network",
        "Networks",
        nodes,
        f"{hidden} hidden nodes in all; drawn from the weights that the hardware holds.",
        wide="min-width" in nodes,
    )
    if all(map(learned, scene.networks())):
        yield Picture(
            "functions",
            "Learned functions",
            learned_curves(scene),
            "Each function over the range that its input has on the recorded rows, without its "
            "mean. Blue ones are curved and take a table, grey ones are straight.",
            wide=True,
        )
    yield Picture(
        "datapath",
        "Datapath",
        datapath(scene),
        f"{len(list(walk(scene.twin())))} entities, drawn from the design that is exported.",
        wide=True,
    )
    if scene.visualisation:
        yield Picture(
            "load_profile",
            "Load profile of a recorded frame",
            load_profile(scene),
            "As the hardware computes it from the recorded readings, beside equation 3.18 in real "
            "arithmetic for the load that was recorded.",
        )


def _verified(scene: Scene) -> Section:
    """The section on what the benches compared, if they have run on the present files."""
    results, proof = stored_results(scene), proof_line(scene, ask=False)
    prove = f"make prove {scene_variable(scene)}"
    proved = (
        f"Verilog, {proof}; {prove} proves the VHDL too."
        if proof
        else f"The present export was not proved for every frame: {prove} does it."
    )
    if results is None:
        text = (
            "The benches have not run since something that they depend on changed: make demo "
            f"{scene_variable(scene)} runs them."
        )
        return Section("verified", "Verified", text=[proved, text])
    said = [
        proved,
        f"{results['benches']} benches, {results['failed']} failed, {results['compared']:,} values "
        "compared bit for bit.",
    ]
    said += results["left_out"]
    return Section("verified", "Verified", text=said, folded=[bench_table(results)])


def bench_table(results: dict[str, Any]) -> Table:
    """The numbers of entities and of compared values of each block."""
    rows: list[list[Cell]] = [
        [block, *(number for s in SIMULATORS for number in cells[s])]
        for block, cells in results["blocks"].items()
    ]
    heading = ["block"]
    heading += [f"{s}, {what}" for s in SIMULATORS for what in ("entities", "values compared")]
    return Table(
        "benches",
        heading,
        rows,
        "Each entity was simulated on the exported files themselves and compared with its twin, "
        "without any tolerance, in " + " and ".join(version(s) for s in SIMULATORS) + ".",
    )


def _designs(scene: Scene) -> Section:
    """The section on what other designs of the same networks would cost."""
    rows, refused = compared(scene)
    title, said = "Other designs: LUTs against clocks", sentence(scene, rows, FAMILY)
    drawn = picture_of(scene, rows, FAMILY)
    return Section(
        "designs",
        "Other designs",
        text=[f"make designs {scene_variable(scene)} prints this table."],
        points=refused_lines(refused),
        pictures=[Picture("designs", title, drawn, said, wide=True)],
        tables=[designs(scene, rows, FAMILY)],
    )


def _resources(scene: Scene, design: Network, found: Costs | None) -> Section | None:
    if found is None:
        return None
    return Section(
        "resources",
        "Resources",
        text=[
            f"ECP5, placed and routed: LUTs {found.timing.luts:,}, flip-flops "
            f"{found.timing.flip_flops:,}, multipliers {found.timing.multipliers}, block RAMs "
            f"{found.timing.block_rams}; {found.timing.clock_mhz} MHz. Slowest path: "
            f"{found.timing.slowest}."
        ],
        folded=[blocks(scene, design, found)],
    )
