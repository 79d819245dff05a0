"""The report's first screen: what was built, how far off, what it costs, what was left out."""

from __future__ import annotations

from pathlib import Path

from golden.block import walk
from golden.errors import scene_errors
from golden.networks.network import Network
from golden.scene import Scene, thesis_figures
from hdl.synth.timing import DEVICE_NAME
from tb.common.runner import ROOT
from tb.report.draw.findings import number, rows_of
from tb.report.measure.clocks import clocks_per_frame
from tb.report.measure.costs import Costs
from tb.report.measure.table import Cell, Table


def built(scene: Scene, design: Network) -> list[str]:
    """What the scene is, in sentences."""
    entities = list(walk(design))
    blocks = {part.block for part in entities}
    vectors = scene.vectors()
    return [
        f"From {', '.join(scene.sensors)} to {', '.join(scene.outputs)}: {scene.arrangement} "
        f"network {scene.describe()} (inputs, hidden nodes, outputs), {scene.design}, activation "
        f"{scene.activation_text}, {scene.precision.name} precision. Top entity {design.entity}, "
        f"{len(entities)} entities of {len(blocks)} blocks, exported as VHDL-93 and as Verilog.",
        f"{len(vectors.codes)} recorded frames; {vectors.saturated} of {vectors.codes.size} "
        "samples saturated.",
    ]


def errors(scene: Scene, motions: Table) -> Table:
    """Errors of every output beside those of the thesis."""
    if any(row[0] == scene.name for row in motions.rows):
        return _motion_errors(scene, motions)
    found = scene_errors(scene)
    printed: list[float] | list[None] = [None] * len(scene.outputs)
    if scene.reference:
        printed = thesis_figures(scene.reference, len(scene.outputs), scene.path)
    rows: list[list[Cell]] = [
        [
            name,
            found["float"][c].largest_mean,
            found["bit-true"][c].largest_mean,
            found["bit-true, held out"][c].mean,
            printed[c],
        ]
        for c, name in enumerate(scene.outputs)
    ]
    return Table(
        "errors",
        ["output", "float %", "bit-true %", "held out %", "thesis %"],
        rows,
        "Largest mean over the positions (equations 3.15, 3.16); bit-true is what the hardware "
        "computes. Held out: mean of the frames that neither trained nor chose the network. "
        "Thesis: bit-true simulation of the design that this one reproduces.",
    )


def _motion_errors(scene: Scene, motions: Table) -> Table:
    rows: list[list[Cell]] = []
    for output in scene.outputs:
        runs = rows_of(motions, scene=scene.name, output=output)
        worst = max(runs, key=lambda row: number(row, "bit-true %"))
        rows.append([output, *(worst[key] for key in ("float %", "bit-true %", "printed %"))])
    return Table(
        "errors",
        ["output", "float %", "bit-true %", "thesis %"],
        rows,
        "Equation 6.6 on the worse of two runs that the networks were not trained on. The thesis "
        "measured on another rig (Table 6.2).",
    )


def cost_table(scene: Scene, design: Network, found: Costs | None) -> Table:
    """Clocks and, where ``make synth`` recorded them, clock and cells."""
    clocks = clocks_per_frame(design)
    rows: list[list[Cell]] = [
        ["clocks from first sample to last output", clocks, None],
        ["clocks from frame to frame", design.interval, None],
        [f"microseconds a frame at {scene.clock_mhz:g} MHz", clocks / scene.clock_mhz, None],
    ]
    note = "No costs are recorded: make synth RECORD=1."
    if found is not None:
        thesis = found.share.get("thesis", {})
        top = {family: cells[design.entity] for family, cells in found.cells.items()}
        rows += [
            ["clock reached on ECP5 MHz", found.timing.clock_mhz, 64.0],
            ["frames a second at that clock", round(found.frames_per_second), None],
            ["Virtex-II LUTs", top["xc2v"]["LUT"], None],
            [
                "Virtex-II LUTs, % of XC2V3000",
                found.share["luts_percent"],
                thesis.get("luts_percent"),
            ],
            ["Virtex-II multipliers", top["xc2v"]["multiplier"], None],
            [
                "Virtex-II multipliers, % of XC2V3000",
                found.share["mult18x18_percent"],
                thesis.get("mult18x18_percent"),
            ],
            ["Virtex-II flip-flops", top["xc2v"]["flip-flop"], None],
            ["Series 7 LUTs", top["xc7"]["LUT"], None],
        ]
        note = (
            f"Recorded by make synth for {'this' if found.current else 'ANOTHER, OLDER'} Verilog; "
            f"clock: {DEVICE_NAME}, placed and routed. Thesis: its Tables 5.1, 5.3 and 6.1, and "
            "the clock of its board."
        )
    return Table("costs", ["what", "tactus", "thesis"], rows, note)


def left_out(scene: Scene, design: Network) -> list[str]:
    """What the project has and this scene does not build."""
    lines = list(design.left_out())
    if scene.front_end is None:
        lines.append("the scan sequencer: the scene has no front_end")
    if scene.visualisation is None:
        lines.append("the load profile: the scene has no visualisation")
    if scene.interface == "stream":
        lines.append("the AXI4-Stream interface")
    here = {part.block for part in walk(design)}
    others = sorted(name for name in every_block() if name not in here)
    lines.append(f"{len(others)} of {len(every_block())} blocks: {', '.join(others)}")
    return lines


def every_block() -> list[str]:
    """The blocks of the project: those with a datasheet."""
    return sorted(path.stem for path in Path(ROOT, "docs", "blocks").glob("*.md"))
