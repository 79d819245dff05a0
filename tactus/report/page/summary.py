"""The first screen of the report: what was built, its errors, its costs, what was left out."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from golden.common.block import walk
from golden.networks.network import Network
from golden.numbers.precision import SIGNAL
from tactus.core.folders import BUILD
from tactus.errors import (
    UNKNOWN,
    held_out_means,
    held_out_text,
    millimetres,
    scene_errors,
    unit_errors,
)
from tactus.report.measure.networks import clocks_per_frame
from tactus.report.measure.outcome import Outcome
from tactus.report.measure.table import Cell, Row, Table
from tactus.scene import Scene, thesis_figures
from tactus.scene.codes import quantised_lines, range_lines, ranges
from tactus.synth.budget import TIMING, Cells, by_block, is_recorded, read_budget, shares
from tactus.synth.cells import FAMILIES, KINDS
from tactus.synth.timing import DEVICE_NAME, Timing, read_timing
from tactus.synth.tools import digest
from tactus.train.split import unused_text
from tactus.verify.benches.blocks import block_names
from tactus.verify.benches.runner import export, scene_variable


@dataclass(frozen=True)
class Costs:
    """The recorded costs of one scene.

    share: See ``shares``.
    frames_per_second: The rate at the clock that was reached.
    current: Whether the record belongs to the Verilog that the scene exports now.
    """

    cells: Cells
    timing: Timing
    share: dict[str, Any]
    frames_per_second: float
    current: bool


def costs(scene: Scene) -> Costs | None:
    design = scene.twin()
    if not is_recorded(scene.path) or not is_recorded(scene.path, TIMING):
        return None
    cells = read_budget(scene.path)
    timing, verilog = read_timing(scene.path)
    export(scene, "verilog")
    return Costs(
        cells,
        timing,
        shares(scene, design, cells),
        1e6 * timing.clock_mhz / design.interval,
        verilog == digest(BUILD / scene.name / "verilog"),
    )


def blocks(scene: Scene, design: Network, found: Costs) -> Table:
    rows: list[list[Cell]] = [
        [family, name, count, *(cells[column] for column in KINDS)]
        for family in FAMILIES
        for name, count, cells in by_block(design, found.cells, family)
    ]
    meaning = "; ".join(f"{family} is {text}" for family, text in FAMILIES.items())
    return Table(
        "blocks",
        ["family", "largest entity", "entities", *KINDS],
        rows,
        f"For each block of scene {scene.name}, the entity with the most LUTs, with everything "
        f"that it contains, and the number of entities. Yosys counted the cells and kept the "
        f"hierarchy; {meaning}.",
    )


def built(scene: Scene, design: Network) -> list[str]:
    """Sentences that say what the scene is."""
    entities = list(walk(design))
    blocks = {part.block for part in entities}
    vectors, unused = scene.vectors(), unused_text(scene)
    saturated = scene.twin().core.saturations(vectors.codes)
    told = [
        *(scene.choice.lines() if scene.choice else []),
        *ranges(scene),
        *range_lines(scene, saturated),
    ]
    return [
        f"From {', '.join(scene.sensors)} to {', '.join(scene.outputs)}: {scene.arrangement} "
        f"network {scene.describe()} (inputs, hidden nodes, outputs), {scene.chosen.design}, "
        f"activation {scene.chosen.hidden_text()}, {scene.precision.name} precision. Top entity "
        f"{design.entity}, {len(entities)} entities of {len(blocks)} blocks, exported as "
        "VHDL-93 and as Verilog.",
        f"{len(vectors.codes)} recorded frames; {vectors.saturated} of {vectors.samples} "
        f"samples saturated.{f' {unused}.' if unused else ''}",
        *(f"{design.core.entity}: {fact}." for fact in design.core.facts()),
        *(f"{line[0].upper()}{line[1:]}." for line in told),
        # These begin with the path of a file.
        *(f"{line}." for line in quantised_lines(scene)),
    ]


def parts_of(scene: Scene) -> str:
    """A sentence on what the errors in percent are parts of."""
    if scene.labels:
        return "The error of a class is the part of the rows decided wrongly about it."
    told = [f"{scene.full_scale[n]:g} for {n}" for n in scene.outputs if n in scene.full_scale]
    others = ", ".join(name for name in scene.outputs if name not in scene.full_scale)
    return f"100 % is {', '.join([*told, *([f'the recorded value for {others}'] * bool(others))])}."


def errors(found: Outcome) -> Table:
    """The errors of every output, as recorded and with noise, and those of the reference."""
    scene = found.scene
    known = scene_errors(scene)
    means: Sequence[Cell] = held_out_means(scene) or [UNKNOWN] * len(scene.outputs)
    rows: list[Row] = []
    for c, (name, real, error) in enumerate(
        zip(scene.outputs, known["float"], known["bit-true"], strict=True)
    ):
        largest: Row = {"largest %": error.largest_mean} if scene.group_by else {}
        row: Row = {"output": name, "held out %": means[c], "mean %": error.mean, **largest}
        noisy = {f"noise {noise:g}, %": float(e[:, c].mean()) for noise, e in found.noisy.items()}
        rows.append({**row, "worst %": error.worst, **noisy, "float %": real.mean})
    note = (
        "The errors are bit-true, which means those of the hardware, on the recorded rows. "
        f"{parts_of(scene)} "
        + (f"Largest is the largest mean at one {scene.group_by}. " if scene.group_by else "")
        + "Worst is that of a single row. Held out is the mean on held-out rows; rows: "
        f"{held_out_text(scene)}. Noise is the mean with noise of this size on every reading, in "
        "its unit; float that of the networks in floating point."
    )
    if scene.reference:
        printed = thesis_figures(scene.reference, len(scene.outputs), scene.path)
        for row, figure in zip(rows, printed, strict=True):
            row["thesis %"] = figure
        note += (
            " Thesis: its largest, in bit-true simulation of the design that this one reproduces."
        )
    return Table.of("errors", rows, note)


def in_units(scene: Scene) -> list[Table]:
    """The errors of lengths in millimetres, and of outputs with a scale or a unit in their unit."""
    known = zip(scene.outputs, scene_errors(scene)["bit-true"], strict=True)
    found = [
        (name, "mm", millimetres(error, scene.length_mm[name]))
        for name, error in known
        if name in scene.length_mm
    ]
    found += [
        (name, scene.units.get(name, "its unit"), error)
        for name, error in unit_errors(scene).items()
    ]
    rows: list[Row] = []
    for name, unit, error in found:
        largest: Row = {"largest": error.largest_mean} if scene.group_by else {}
        mean: Row = {"output": name, "in": unit, "mean": error.mean}
        rows.append({**mean, **largest, "worst": error.worst})
    note = "Bit-true errors on the recorded rows; the columns are those of the errors in percent."
    return [Table.of("errors_in_units", rows, note)] if rows else []


def cost_table(scene: Scene, design: Network, found: Costs | None) -> Table:
    """The clocks and, if ``make synth`` recorded them, the frequency and the cells.

    The figures of a reference stand beside them, and the shares of its device.
    """
    compared = bool(scene.reference)
    clocks = clocks_per_frame(design)
    rows: list[list[Cell]] = [
        ["clocks from first sample to last output", clocks, None],
        ["clocks from frame to frame", design.interval, None],
        [
            f"microseconds from first sample to last output at {scene.clock_mhz:g} MHz",
            clocks / scene.clock_mhz,
            None,
        ],
    ]
    note = f"No costs are recorded; make synth {scene_variable(scene)} RECORD=1 records them."
    if found is not None:
        top = {family: cells[design.entity] for family, cells in found.cells.items()}
        rows += [
            ["clock reached on ECP5 MHz", found.timing.clock_mhz, 64.0],
            ["frames a second at that clock", round(found.frames_per_second), None],
            ["Virtex-II LUTs", top["xc2v"]["LUT"], None],
            *(_share(found, "LUTs", "luts_percent") if compared else []),
            ["Virtex-II multipliers", top["xc2v"]["multiplier"], None],
            *(_share(found, "multipliers", "mult18x18_percent") if compared else []),
            ["Virtex-II flip-flops", top["xc2v"]["flip-flop"], None],
            ["Virtex-II block RAMs", top["xc2v"]["block RAM"], None],
            ["Series 7 LUTs", top["xc7"]["LUT"], None],
        ]
        note = (
            "make synth recorded this for "
            f"{'this' if found.current else 'ANOTHER, OLDER'} Verilog. "
            f"The clock is that of {DEVICE_NAME} after placing and routing."
        )
        if compared:
            note += (
                " The column of the thesis is from its Tables 5.1, 5.3 and 6.1, with the clock of "
                "its board."
            )
    if scene.front_end:
        note = f"The front end: {scene.front_end.describe()}. {note}"
    if not compared:
        return Table("costs", ["what", "tactus"], [row[:2] for row in rows], note)
    return Table("costs", ["what", "tactus", "thesis"], rows, note)


def _share(found: Costs, what: str, key: str) -> list[list[Cell]]:
    """The share of the reference's device."""
    figure = found.share.get("thesis", {}).get(key)
    return [[f"Virtex-II {what}, % of XC2V3000", found.share[key], figure]]


def frame(scene: Scene) -> list[Table]:
    """When the samples and the outputs of a recorded frame come, as soon as they may.

    There is none where the stream may pause, or where a scan takes the samples.
    """
    design, vectors = scene.twin(), scene.vectors()
    if design.stream not in ("serial", "words"):
        return []
    words, last = design.stream == "words", design.frame_clocks - 1
    # The frames before it fill the past.
    samples = vectors.recordings[0][design.past]
    outputs = design.core.process(vectors.codes[:1])[0]
    begun = [0 if words else n for n in range(len(samples))]
    ended = [last + clocks for clocks in design.output_clocks]
    rows: list[list[Cell]] = [
        [clock, f"{port}_{n}" if words else port, name, int(code), float(SIGNAL.to_real(code))]
        for port, *columns in (
            ("in_data", begun, scene.sensors, samples),
            ("out_data", ended, scene.outputs, outputs),
        )
        for n, (clock, name, code) in enumerate(zip(*columns, strict=True))
    ]
    slots = 0 if words else design.frame_clocks - len(samples)
    note = (
        f"The first recorded frame{' that has a whole past' if design.past else ''}, as the twin "
        "computes it, with an element in each clock. The benches compare codes and clocks with the "
        "exported files."
    )
    if slots:
        note += f" Behind the samples come {slots} elements whose data do not count."
    return [Table("frame", ["clock", "port", "what", "code", "value"], rows, note)]


def left_out(scene: Scene, design: Network) -> list[str]:
    """Sentences on what the project has and this scene does not build."""
    lines = design.left_out()
    if scene.front_end is None:
        lines.append("the scan sequencer: the scene has no front_end")
    if scene.visualisation is None:
        lines.append("the load profile: the scene has no visualisation")
    if scene.interface == "stream":
        lines.append("the AXI4-Stream interface")
    others = set(block_names()) - {part.block for part in walk(design)}
    lines.append(f"{len(others)} of the {len(block_names())} blocks that docs/blocks describes")
    return lines
