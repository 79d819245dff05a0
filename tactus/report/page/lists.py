"""``python -m tactus.report.page.lists``: writes lists and tables that follow from the project.

It rewrites the text between the markers of README.md and of the pages with results, the pictures of
pages, and the schema of a scene for editors. The rest of a page stays as it is. Whatever else a
program knows is written as the site is built (``made``).
"""

import re
import sys
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path

from tactus.core.cli import run, stop_if_dry_run
from tactus.core.fingerprint import ROOT
from tactus.core.schema import json_schema
from tactus.errors.scene_errors import held_out_means, scene_errors
from tactus.report.draw import findings
from tactus.report.draw.area import area
from tactus.report.draw.margins import margins
from tactus.report.draw.overview import overview
from tactus.report.draw.overview import wishes as draw_wishes
from tactus.report.draw.run_time import network_rows
from tactus.report.draw.tanh_words import tanh_words as draw_tanh_words
from tactus.report.measure.clocks import clocks
from tactus.report.measure.costs import with_network_cells
from tactus.report.measure.digits import digits
from tactus.report.measure.left_out import left_out
from tactus.report.measure.sensors_dropped import EACH, IN_ORDER
from tactus.report.measure.stability.margins import cases as margin_cases
from tactus.report.measure.table import Cell, Table
from tactus.report.measure.table_records import SEED, read
from tactus.report.measure.tanh_words import tanh_words
from tactus.report.page import left_out as leaving
from tactus.report.page import run_time, stability
from tactus.report.page.markers import put, write
from tactus.scene import load_scene, thesis_figures, thesis_table
from tactus.scene.schema import EDITOR_SCHEMA, SCENE
from tactus.synth.budget import budget_path, read_budget

COMMAND = "python -m tactus.report.page.lists"
# The networks that the pages show.
SHOWN = "digit"
# The networks with the hidden nodes that the thesis prints, without the blocks around them.
REBUILT = "digit-thesis"
# Each wish for the project, and the page that shows the result.
WISHES = {
    "Report error against run time": "error-against-run-time.md",
    "Check numerical stability on stiff and extreme cases": "stability.md",
    "Leave out what a given scene does not need": "left-out.md",
}


def headline() -> str:
    """The printed thesis, its networks rebuilt, and the default scene beside each other."""
    rebuilt, today = load_scene(REBUILT), load_scene(SHOWN)
    printed, device = thesis_table(rebuilt.reference), thesis_table("device")
    figures = thesis_figures(rebuilt.reference, len(rebuilt.outputs), rebuilt.path)

    def worst(found: Iterable[float]) -> str:
        return f"{max(found):.2f} %"

    def of_device(share: str, kind: str) -> str:
        return f"about {printed[share] * device[kind] / 100:,.0f}"

    scenes = (rebuilt, today)
    held_out = [worst(held_out_means(s) or []) for s in scenes]
    largest = [worst(e.largest_mean for e in scene_errors(s)["bit-true"]) for s in scenes]
    cells = [read_budget(budget_path(s.path))["xc2v"][s.twin().entity] for s in scenes]
    rows = [
        ("error on held-out rows", "-", *held_out),
        ("largest error at a position", worst(figures), *largest),
        ("clocks after the last sample", "-", *(str(s.twin().output_clocks[-1]) for s in scenes)),
        ("LUTs", of_device("luts_percent", "luts4"), *(f"{c['LUT']:,}" for c in cells)),
        (
            "multipliers",
            of_device("mult18x18_percent", "mult18x18"),
            *(str(c["multiplier"]) for c in cells),
        ),
        ("block RAMs", "-", *(str(c["block RAM"]) for c in cells)),
        ("frames proved", "none", *(f"all 2^{14 * len(s.sensors)}" for s in scenes)),
    ]
    heads = ["", "thesis, printed", "thesis, rebuilt", "today"]
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


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


def _middle(text: str) -> float:
    ends = [float(end) for end in text.split(" to ")]
    return sum(ends) / len(ends)


def wishes(found: dict[Path, str]) -> str:
    """What tactus was asked to show, each with the headline of its page."""
    lines = ["![What was asked for, each in a picture](docs/wishes.svg)", ""]
    for wish, page in WISHES.items():
        headline = re.search(r"\*\*(.+?)\*\*", found[ROOT / "docs" / page], re.S)
        assert headline, page
        lines.append(f"- [{wish}](docs/{page}): {' '.join(headline[1].split())}")
    return "\n".join(lines)


def editor_schema() -> str:
    """The schema by which an editor completes a scene."""
    return json_schema(SCENE, "A scene of tactus")


def pages() -> dict[Path, str]:
    """The text of every file that this command writes."""
    docs = ROOT / "docs"
    cases, dropped, nodes = (read(n) for n in ("stability", "sensors_dropped", "hidden_nodes"))
    scenes_left_out, shipped = left_out(SEED), read("sensors_shipped")
    sections: list[tuple[Path, str, Callable[[], str]]] = [
        (ROOT / "README.md", "headline", headline),
        (docs / "left-out.md", "headline", partial(leaving.headline, scenes_left_out, shipped)),
        (docs / "left-out-tables.md", "scenes", partial(leaving.scene_rows, scenes_left_out)),
        (docs / "left-out.md", "programs", leaving.program_rows),
        (docs / "left-out.md", "shipped", partial(leaving.shipped_rows, shipped)),
        (docs / "left-out-tables.md", "each", partial(leaving.sensor_rows, dropped, EACH)),
        (docs / "left-out-tables.md", "order", partial(leaving.sensor_rows, dropped, IN_ORDER)),
        (docs / "left-out-tables.md", "nodes", partial(leaving.nodes_rows, nodes)),
        (docs / "stability.md", "headline", partial(stability.headline, cases)),
        (docs / "stability.md", "nearest", partial(stability.nearest, cases)),
        (docs / "stability-cases.md", "useless", partial(stability.useless, cases)),
        (docs / "stability-cases.md", "kinds", partial(stability.kinds, cases)),
        (docs / "stability-cases.md", "everything", partial(stability.everything, cases)),
    ]
    found: dict[Path, str] = {}
    for page, section, text in sections:
        before = found.get(page) or page.read_text(encoding="utf-8")
        found[page] = put(page, before, text(), COMMAND, section)
    figures = (docs / "figures.md").read_text(encoding="utf-8")
    found[EDITOR_SCHEMA] = editor_schema()
    found[docs / "robustness.svg"] = robustness(figures) + "\n"
    found[docs / "digits.svg"] = findings.digits_plot(digits(SEED)).draw() + "\n"
    found[docs / "stability.svg"] = margins(cases)
    found[docs / "sensors-dropped.svg"] = leaving.sensors_plot(shipped).draw() + "\n"
    found[docs / "hidden-nodes.svg"] = leaving.nodes_plot(nodes).draw() + "\n"
    found[docs / "overview.svg"] = overview(load_scene(SHOWN))
    networks = with_network_cells(clocks(SEED))
    found[docs / "area.svg"] = area(networks) + "\n"
    found[docs / "wishes.svg"] = draw_wishes(
        [row for row in network_rows(networks) if row["outputs"] == 4],
        (SHOWN, REBUILT),
        float(thesis_table("board")["clock_mhz"]),
        margin_cases(cases),
        leaving.kept(scenes_left_out),
    )
    found |= run_time.pages(networks, COMMAND)
    readme = ROOT / "README.md"
    found[readme] = put(readme, found[readme], wishes(found), COMMAND, "wishes")
    found[docs / "activations" / "engine.svg"] = draw_tanh_words(tanh_words(SEED)) + "\n"
    return found


def main() -> None:
    stop_if_dry_run("write what is generated in the documentation")
    write(pages())


if __name__ == "__main__":
    sys.exit(run(main))
