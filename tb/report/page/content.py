"""What stands in the report of a scene."""

from __future__ import annotations

from golden.fingerprint import fingerprint, sources
from golden.networks.network import Network
from golden.scene import Scene
from tb.common.results import stored_results
from tb.common.tools import SIMULATORS, version
from tb.report.draw import area, findings, tanh_words
from tb.report.draw.pictures import draw
from tb.report.draw.plots import Plot
from tb.report.measure.activation_errors import thesis_figure
from tb.report.measure.costs import (
    Costs,
    blocks,
    costs,
    with_activation_cells,
    with_network_cells,
)
from tb.report.measure.engines import engines
from tb.report.measure.steps import measured, measuring
from tb.report.measure.store import Progress, once, packed, unpacked
from tb.report.measure.table import Cell, Table
from tb.report.page import summary
from tb.report.page.page import Page, Picture, Section


def content(scene: Scene, tell: Progress) -> Page:
    """The report of a scene; ``tell`` hears of each part that is ready."""
    design = scene.twin()
    tools = [version(s) for s in SIMULATORS]
    state = fingerprint([*measuring("golden", "hdl", "tb"), *scene.files], *tools)
    drawing = fingerprint([*sources("golden", "hdl", "tb"), *scene.files], *tools)
    found = costs(scene, design)
    tables = measured(tell)
    speed = unpacked(once(f"engines-{scene.name}", state, tell, lambda: packed(engines(scene))))
    activations = with_activation_cells(tables["activations"])
    networks = with_network_cells(tables["clocks"])
    tables |= {activations.name: activations, networks.name: networks}
    plots = [
        *findings.activation_plots(activations),
        findings.iterations_plot(tables, thesis_figure("pade")),
        *findings.network_plots(networks),
        *findings.training_plots(tables),
        *findings.swing_plots(tables),
        findings.damping_plot(tables),
        findings.plate_plot(tables),
        findings.series_plot(tables),
        findings.engines_plot(speed),
    ]
    *costly, fast = _drawn(scene, plots, drawing, tell)
    costly += [
        Picture(
            "networks_area",
            "Networks: area, clocks and error",
            area.area(networks),
            area.sentence(networks),
        ),
        Picture(
            "tanh_words",
            "Engine: error of tanh against words",
            tanh_words.tanh_words(tables["tanh_words"]),
            tanh_words.sentence(tables["tanh_words"]),
        ),
    ]
    shown = {"stability"}
    sections = [
        _verified(scene),
        _pictures(scene, drawing, tell),
        Section(
            "error-against-cost",
            "Error against cost",
            pictures=costly,
        ),
        _stability(tables["stability"]),
        Section(
            "engines",
            "Simulation speed",
            pictures=[fast],
            tables=[speed],
        ),
        _resources(scene, design, found),
        Section(
            "figures",
            "Every table",
            text=["The same tables as make figures prints; docs/figures.md tells of each."],
            folded=[table for name, table in tables.items() if name not in shown],
        ),
    ]
    return Page(
        f"tactus: {scene.name}",
        summary.built(scene, design),
        summary.errors(scene, tables["motions"]),
        summary.cost_table(scene, design, found),
        summary.left_out(scene, design),
        [section for section in sections if section is not None],
    )


def _pictures(scene: Scene, state: str, tell: Progress) -> Section:
    found = once(f"pictures-{scene.name}", state, tell, lambda: draw(scene))
    skipped = "; ".join(f"{title}: {why}" for title, why in found["skipped"])
    return Section(
        "pictures",
        "Pictures",
        text=[f"Not drawn for this scene. {skipped}."] if skipped else [],
        pictures=[Picture(**part) for part in found["drawn"]],
    )


def _drawn(scene: Scene, plots: list[Plot], state: str, tell: Progress) -> list[Picture]:
    """The plots as pictures, drawn again when their figures or what draws them have changed."""
    figures = fingerprint([], state, repr(plots))
    drawn = once(f"plots-{scene.name}", figures, tell, lambda: [plot.draw() for plot in plots])
    return [
        Picture(plot.name, plot.title, svg, plot.sentence)
        for plot, svg in zip(plots, drawn, strict=True)
    ]


def _verified(scene: Scene) -> Section:
    """What the benches compared, if they have run on what is there now."""
    results = stored_results(scene)
    if results is None:
        text = (
            "The benches have not run since something that they depend on changed: make demo "
            f"SCENE={scene.name} runs them."
        )
        return Section("verified", "Verified", text=[text])
    rows: list[list[Cell]] = [
        [block, *(number for s in SIMULATORS for number in cells[s])]
        for block, cells in results["blocks"].items()
    ]
    heading = ["block"]
    heading += [f"{s}, {what}" for s in SIMULATORS for what in ("entities", "values compared")]
    table = Table(
        "benches",
        heading,
        rows,
        "Each entity on the exported files themselves, against its twin, with no tolerance: "
        + ", ".join(version(s) for s in SIMULATORS)
        + ".",
    )
    text = (
        f"{results['benches']} benches, {results['failed']} failed, {results['compared']:,} values "
        "compared bit for bit."
    )
    return Section("verified", "Verified", text=[text], folded=[table])


def _stability(table: Table) -> Section:
    held = sum(row[-1] == "yes" for row in table.rows)
    text = f"{held} of {len(table.rows)} stiff and extreme cases hold; each was run for this table."
    return Section("stability", "Stability", text=[text], tables=[table])


def _resources(scene: Scene, design: Network, found: Costs | None) -> Section | None:
    if found is None:
        return None
    return Section(
        "resources",
        "Resources",
        text=[
            f"ECP5, placed and routed: {found.timing.luts:,} LUTs, {found.timing.flip_flops:,} "
            f"flip-flops, {found.timing.multipliers} multipliers, {found.timing.block_rams} block "
            f"RAMs; {found.timing.clock_mhz} MHz. Slowest path: {found.timing.slowest}."
        ],
        folded=[blocks(scene, design, found)],
    )
