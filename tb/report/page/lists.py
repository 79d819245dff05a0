"""``python -m tb.report.page.lists``: writes lists and tables that follow from the project.

It rewrites the text between the markers of README.md and of pages in ``docs``, and the pictures of
the networks of scene digit, of the cost of designs and of an engine's tanh. The rest of a page
stays as it is.
"""

import re
import sys
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path

from golden.activation.segments import GRADIENT, INTERCEPT, UPPER
from golden.cli import run, would
from golden.decisions import decisions_of, held_out_or_all
from golden.disturbance import Disturbance
from golden.engine.pipeline import Pipeline
from golden.fingerprint import ROOT
from golden.input_error import InputError
from golden.scene import (
    DEFAULT_SCENES,
    Scene,
    class_names,
    load_scene,
    scene_names,
    thesis_figures,
    thesis_table,
)
from golden.scene_errors import disturbed_errors, held_out_means, scene_errors
from hdl.synth.budget import budget_path, read_budget
from tb.commands import CLOSING, COMMANDS
from tb.report.draw import findings
from tb.report.draw.area import area
from tb.report.draw.floors import picture_of_floors
from tb.report.draw.margins import margins
from tb.report.draw.network import network
from tb.report.draw.overview import overview
from tb.report.draw.tanh_words import tanh_words as draw_tanh_words
from tb.report.measure.adder_chains import adder_chains
from tb.report.measure.clocks import clocks, clocks_per_frame
from tb.report.measure.costs import with_network_cells
from tb.report.measure.digits import digits
from tb.report.measure.left_out import left_out
from tb.report.measure.search_runs import search_runs
from tb.report.measure.sensors_dropped import EACH, IN_ORDER
from tb.report.measure.table import Cell, Table
from tb.report.measure.table_records import SEED, read
from tb.report.measure.tanh_words import tanh_words
from tb.report.measure.word_widths import word_widths
from tb.report.page import designs as compared
from tb.report.page import left_out as leaving
from tb.report.page import outside, run_time, stability
from tb.report.page.markers import put, write
from tb.report.side_by_side import side_by_side

COMMAND = "python -m tb.report.page.lists"
# The networks that the pages show.
SHOWN = "digit"
# The networks with the hidden nodes that the thesis prints, without the blocks around them.
REBUILT = "digit-thesis"
# Each wish for the project, the page that shows the result, and the picture of this page.
WISHES = (
    (
        "report error against run time",
        "error-against-run-time.md",
        "error-against-run-time/networks.svg",
    ),
    ("check numerical stability on stiff and extreme cases", "stability.md", "stability.svg"),
    ("leave out what a given scene does not need", "left-out.md", "sensors-dropped.svg"),
)
DISTURBED = ("digit", "digit-single", "digit-thesis", "swing-multiple")


def scenes() -> str:
    """Every shipped scene, with the first paragraph of its file and its parts."""
    lines = [
        "| shipped scene | what it is | design | activation | precision |",
        "|---|---|---|---|---|",
    ]
    for name in sorted([*scene_names(), *class_names()]):
        scene = load_scene(name)
        head = re.split(r"\n#?\n", scene.path.read_text(encoding="utf-8"), maxsplit=1)[0]
        text = " ".join(line.removeprefix("#").strip() for line in head.splitlines())
        row = [f"`{name}`", text, *(f"`{word}`" for word in (scene.design, scene.activation))]
        lines.append(f"| {' | '.join(row)} | `{scene.precision.name}` |")
    return "\n".join(lines)


def classes() -> str:
    """What every shipped scene of classes costs, and how often it is wrong on held-out rows."""
    lines = [
        "| scene | network | LUT | multiplier | block RAM | clocks of a frame | held-out rows | "
        "wrong | wrong in floating point |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for name in class_names():
        scene = load_scene(name)
        top = read_budget(budget_path(scene.path))["xc2v"][scene.twin().entity]
        held_out, _ = held_out_or_all(scene, decisions_of(scene))
        rows = len(held_out.actual)
        cells = [
            f"`{name}`",
            scene.describe(),
            *(top[kind] for kind in ("LUT", "multiplier", "block RAM")),
            clocks_per_frame(scene.twin()),
            rows,
            rows - held_out.right,
            rows - held_out.right_real,
        ]
        lines.append(f"| {' | '.join(map(str, cells))} |")
    return "\n".join(lines)


def commands() -> str:
    """Every command of make, with all of its variables."""
    lines = ["| command | what it does |", "|---|---|"]
    for command in COMMANDS:
        # A text between < and > would be read as HTML.
        purpose = re.sub(r"\S*<\w+>[\w/]*", r"`\g<0>`", command.purpose)
        lines.append(f"| `{command.usage.replace('|', ' or ')}` | {purpose} |")
    return "\n".join([*lines, "", CLOSING.replace("DRY=1", "`DRY=1`")])


def segments() -> str:
    """The segments of Table 4.1 of the thesis."""
    lines = ["| n | up to q_n | g_n | i_n |", "|---|---|---|---|"]
    rows = zip(UPPER, GRADIENT, INTERCEPT, strict=True)
    lines += [f"| {n} | {' | '.join(map(str, row))} |" for n, row in enumerate(rows, 1)]
    return "\n".join(lines)


def pipeline() -> str:
    """Every clock of an engine's pipeline, and what happens in it."""
    lines = ["| name | clocks | with registers | what is there |", "|---|---|---|---|"]
    forms = [Pipeline(), Pipeline(memory_registers=1)]
    for name, value in vars(Pipeline).items():
        if isinstance(value, property):
            clocks = " | ".join(str(getattr(form, name)) for form in forms)
            lines.append(f"| `{name}` | {clocks} | {' '.join((value.__doc__ or '').split())} |")
    return "\n".join(lines)


def demo() -> str:
    """The table at the end of the demo, without the line on what was compared."""
    lines = side_by_side([load_scene(name) for name in DEFAULT_SCENES])
    return "\n".join(f"    {line}".rstrip() for line in lines)


def unseen() -> str:
    """What *held out* does not say, about loads that were never trained and networks trained on.

    Figures that other pages show are taken from these pages.
    """
    scene = load_scene(SHOWN)
    held_out = dict(zip(scene.outputs, held_out_means(scene) or [], strict=True))
    width, shape = (_row("figures", "honest", "loads", output)[0] for output in ("width", "shape"))
    silent = _row("limits", "The digit at 2 mV", "width", "no")[0]
    return "\n".join(
        [
            "- On a load that was not among the training data, a network errs in width by "
            f"{width} %",
            f"  and in shape by {shape} % ([honest](figures.md#honest)). The column "
            "*held out* shows",
            f"  {held_out['width']:.2f} and {held_out['shape']:.2f}, because other rows with the "
            "same loads were trained on.",
            f"- The reason: at {silent} of {len(scene.vectors().codes)} placements no sensor feels "
            "the width. So the networks have",
            "  learnt which loads exist, and not their widths ([limits](limits.md)).",
            "- The thesis trained on half of its rows. The networks of `digit` were trained on all",
            "  rows after *held out* had been measured. So their columns *mean* and *largest* come",
            "  from rows that the networks have seen.",
        ]
    )


def headline() -> str:
    """The printed thesis, its networks rebuilt, and the default scene beside each other."""
    rebuilt, today = load_scene(REBUILT), load_scene(SHOWN)
    printed, device = thesis_table(rebuilt.reference), thesis_table("device")
    figures = thesis_figures(rebuilt.reference, len(rebuilt.outputs), rebuilt.path)

    def percents(found: Iterable[float]) -> str:
        return ", ".join(f"{value:.2f}" for value in found)

    def of_device(share: str, kind: str) -> str:
        return f"about {printed[share] * device[kind] / 100:,.0f}"

    scenes, nodes = (rebuilt, today), printed["hidden"]
    held_out = [percents(held_out_means(s) or []) for s in scenes]
    largest = [percents(e.largest_mean for e in scene_errors(s)["bit-true"]) for s in scenes]
    cells = [read_budget(budget_path(s.path))["xc2v"][s.twin().entity] for s in scenes]
    rows = [
        ("hidden nodes", ", ".join(map(str, nodes)), *(_hidden(scene) for scene in scenes)),
        (f"largest error in %, {', '.join(today.outputs)}", percents(figures), *largest),
        ("mean error on held-out rows in %", "-", *held_out),
        ("clocks behind the last sample", "-", *(str(s.twin().output_clocks[-1]) for s in scenes)),
        ("LUTs", of_device("luts_percent", "luts4"), *(f"{c['LUT']:,}" for c in cells)),
        (
            "multipliers",
            of_device("mult18x18_percent", "mult18x18"),
            *(str(c["multiplier"]) for c in cells),
        ),
        ("block RAMs", "-", *(str(c["block RAM"]) for c in cells)),
        ("proved for every frame", "-", *(f"2^{14 * len(s.sensors)}" for s in scenes)),
    ]
    heads = ["", "thesis, as printed", f"rebuilt: `{REBUILT}`", f"today: `{SHOWN}`"]
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _hidden(scene: Scene) -> str:
    return ", ".join(str(network.shape[1]) for network in scene.networks())


def disturbed() -> str:
    """The errors of some scenes with noise and drift."""
    disturbances = {
        "as recorded": Disturbance(),
        "noise 1 mV": Disturbance(noise=0.001),
        "noise 2 mV": Disturbance(noise=0.002),
        "noise 8 mV": Disturbance(noise=0.008),
        "gain drift 1 %": Disturbance(gain=0.01),
        "offset drift 10 mV": Disturbance(offset=0.01),
    }
    lines = [
        f"| scene | output | {' | '.join(disturbances)} |",
        f"|{'---|' * (2 + len(disturbances))}",
    ]
    for name in DISTURBED:
        scene = load_scene(name)
        errors = [disturbed_errors(scene, disturbance) for disturbance in disturbances.values()]
        for output, found in zip(scene.outputs, zip(*errors, strict=True), strict=True):
            lines.append(f"| {name} | {output} | {' | '.join(f'{e:.2f}' for e in found)} |")
    return "\n".join(lines)


def robustness(page: str) -> str:
    """The plot of the table of the page, at the middle of its ranges.

    The table is not measured again, because trainings end elsewhere in the ranges on another
    machine.
    """
    lines = page.partition("\n## robustness\n")[2].partition("\n## ")[0].splitlines()
    cells = [[c.strip() for c in line.strip("| ").split("|")] for line in lines if "|" in line]
    rows: list[list[Cell]] = [
        [float(row[0]), row[1], _middle(row[2]), _middle(row[3])] for row in cells[2:]
    ]
    columns = ["trained for mV", "output", "as recorded %", "2 mV %"]
    return findings.robustness_plot(Table("robustness", columns, rows, "")).draw()


def digits_rows() -> str:
    """The recorded table on weights of few digits."""
    return _table(digits(SEED))


def adder_chain_rows() -> str:
    """The recorded table on chains of adders."""
    return _table(adder_chains(SEED))


def word_width_rows() -> str:
    """What few digits and short words save and cost."""
    return _table(word_widths(SEED))


def search_run_rows() -> str:
    """What more runs of the search for shared sums save."""
    return _table(search_runs(SEED))


def _shown(cell: Cell) -> str:
    if cell is None:
        return ""
    return f"`{cell}`" if isinstance(cell, str) else f"{cell:,}"


def _table(table: Table) -> str:
    lines = [f"| {' | '.join(table.columns)} |", f"|{'---|' * len(table.columns)}"]
    for row in table.rows:
        lines.append(f"| {' | '.join(map(_shown, row))} |")
    return "\n".join(lines)


def _row(page: str, heading: str, *start: str) -> list[str]:
    """The other cells of the row in a page's table that begins with ``start``."""
    text = (ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8")
    below = text.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in below.splitlines()]
    found = [row[len(start) :] for row in rows if row[: len(start)] == list(start)]
    if len(found) != 1:
        raise InputError(
            f"docs/{page}.md: {heading}: got {len(found)} lines that begin with "
            f"{', '.join(start)}, expected one"
        )
    return found[0]


def _middle(text: str) -> float:
    ends = [float(end) for end in text.split(" to ")]
    return sum(ends) / len(ends)


def wishes(found: dict[Path, str]) -> str:
    """What tactus was asked to show, each with the headline and the picture of its page."""
    lines = ["| asked for | found | in a picture |", "|---|---|---|"]
    for wish, page, picture in WISHES:
        headline = re.search(r"\*\*(.+?)\*\*", found[ROOT / "docs" / page], re.S)
        assert headline, page
        text = " ".join(headline[1].split())
        lines.append(f"| [{wish}](docs/{page}) | {text} | ![{wish}](docs/{picture}) |")
    return "\n".join(lines)


def pages() -> dict[Path, str]:
    """The text of every file that this command writes."""
    docs = ROOT / "docs"
    cases, dropped, nodes = (read(n) for n in ("stability", "sensors_dropped", "hidden_nodes"))
    scenes_left_out, shipped = left_out(SEED), read("sensors_shipped")
    sections: list[tuple[Path, str, Callable[[], str]]] = [
        (ROOT / "README.md", "headline", headline),
        (docs / "overview.md", "side_by_side", demo),
        (docs / "overview.md", "unseen", unseen),
        (docs / "README.md", "commands", commands),
        (docs / "designs.md", "digit", partial(compared.rows, compared.CASCADE)),
        (docs / "designs.md", "digit-single", partial(compared.rows, compared.SINGLE)),
        (docs / "designs.md", "ecp5", partial(compared.rows, compared.SINGLE, "ecp5")),
        (docs / "designs.md", "learned", partial(compared.rows, compared.LEARNED)),
        (docs / "designs.md", "held-out", compared.spreads),
        (docs / "figures.md", "disturbance", disturbed),
        (docs / "figures.md", "digits", digits_rows),
        (docs / "scenes.md", "scenes", scenes),
        (docs / "scenes.md", "classes", classes),
        (docs / "left-out.md", "headline", partial(leaving.headline, scenes_left_out, shipped)),
        (docs / "left-out-tables.md", "scenes", partial(leaving.scene_rows, scenes_left_out)),
        (docs / "left-out.md", "programs", leaving.program_rows),
        (docs / "left-out.md", "shipped", partial(leaving.shipped_rows, shipped)),
        (docs / "left-out-tables.md", "each", partial(leaving.sensor_rows, dropped, EACH)),
        (docs / "left-out-tables.md", "order", partial(leaving.sensor_rows, dropped, IN_ORDER)),
        (docs / "left-out-tables.md", "nodes", partial(leaving.nodes_rows, nodes)),
        (docs / "limits.md", "outside", partial(outside.rows, read("outside"))),
        (docs / "stability.md", "headline", partial(stability.headline, cases)),
        (docs / "stability.md", "nearest", partial(stability.nearest, cases)),
        (docs / "stability-cases.md", "useless", partial(stability.useless, cases)),
        (docs / "stability-cases.md", "kinds", partial(stability.kinds, cases)),
        (docs / "stability-cases.md", "everything", partial(stability.everything, cases)),
        (docs / "blocks" / "adder_graph.md", "adder_chains", adder_chain_rows),
        (docs / "blocks" / "adder_graph.md", "word_widths", word_width_rows),
        (docs / "blocks" / "constant_matrix.md", "search_runs", search_run_rows),
        (docs / "blocks" / "gradient.md", "segments", segments),
        (docs / "blocks" / "engine.md", "pipeline", pipeline),
    ]
    found: dict[Path, str] = {}
    for page, section, text in sections:
        before = found.get(page) or page.read_text(encoding="utf-8")
        found[page] = put(page, before, text(), COMMAND, section)
    figures = (docs / "figures.md").read_text(encoding="utf-8")
    found[docs / "robustness.svg"] = robustness(figures) + "\n"
    found[docs / "digits.svg"] = findings.digits_plot(digits(SEED)).draw() + "\n"
    found[docs / "search-runs.svg"] = findings.search_plot(search_runs(SEED)).draw() + "\n"
    found[docs / "stability.svg"] = margins(cases)
    found[docs / "sensors-dropped.svg"] = leaving.sensors_plot(shipped).draw() + "\n"
    found[docs / "hidden-nodes.svg"] = leaving.nodes_plot(nodes).draw() + "\n"
    found[docs / "floors.svg"] = picture_of_floors()
    found[docs / "designs.svg"] = compared.picture()
    found[docs / "overview.svg"] = overview(load_scene(SHOWN))
    found[docs / "networks.svg"] = network(load_scene(SHOWN)) + "\n"
    networks = with_network_cells(clocks(SEED))
    found[docs / "area.svg"] = area(networks) + "\n"
    found |= run_time.pages(networks, COMMAND)
    readme = ROOT / "README.md"
    found[readme] = put(readme, found[readme], wishes(found), COMMAND, "wishes")
    found[docs / "activations" / "engine.svg"] = draw_tanh_words(tanh_words(SEED)) + "\n"
    return found


def main() -> None:
    would("write what is generated in the documentation")
    write(pages())


if __name__ == "__main__":
    sys.exit(run(main))
