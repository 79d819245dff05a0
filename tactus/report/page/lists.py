"""``python -m tactus.report.page.lists``: writes lists and tables that follow from the project.

It rewrites the text between the markers of README.md and of the pages with results, the pictures of
pages, and the schema of a scene for editors. The rest of a page stays as it is. Whatever else a
program knows is written as the site is built (``made``).
"""

import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from golden.input_error import InputError
from golden.networks.engine import Engine
from golden.numbers.real import Real
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.files import replace_file
from tactus.core.fingerprint import ROOT
from tactus.core.schema import json_schema
from tactus.errors import held_out_means, scene_errors
from tactus.report.draw.overview import overview
from tactus.report.draw.overview import wishes as draw_wishes
from tactus.report.draw.run_time import (
    AFTER,
    PRINTED,
    SCAN_CLOCKS,
    WORST,
    area,
    network_rows,
    scene_of,
)
from tactus.report.draw.run_time import networks as draw_networks
from tactus.report.measure.left_out import LEAN, WHOLE, left_out, words
from tactus.report.measure.networks import clocks, clocks_per_frame
from tactus.report.measure.table import SEED, Row, Table, markdown, number, read_csv, rows_of
from tactus.scene import load_scene, thesis_table
from tactus.scene.reading import EDITOR_SCHEMA, SCENE
from tactus.synth.budget import read_budget

COMMAND = "python -m tactus.report.page.lists"
# The networks that the pages show.
SHOWN = "digit"
# The networks with the hidden nodes that the thesis prints, without the blocks around them.
REBUILT = "digit-thesis"
# The same networks with a scan and a profile around them.
INSTRUMENTS = ("thesis", "digit-instrument")
# Each wish for the project, and the page that shows the result.
WISHES = {
    "Report error against run time": "error-against-run-time.md",
    "Check numerical stability on stiff and extreme cases": "stability.md",
    "Leave out what a given scene does not need": "left-out.md",
}
ONE_OUTPUT = "digit-load"
PRUNED = (0.1, 0.25, 0.5)
HELD_OUT = "held out %"


def headline() -> str:
    """The printed thesis, its networks rebuilt, and the default scene beside each other."""
    rebuilt, today = load_scene(REBUILT), load_scene(SHOWN)
    printed = thesis_table(rebuilt.reference)
    luts, multipliers = _printed_cells(printed)

    def worst(found: Iterable[float]) -> str:
        return f"{max(found):.2f} %"

    scenes = (rebuilt, today)
    held_out = [worst(held_out_means(s) or []) for s in scenes]
    largest = [worst(e.largest_mean for e in scene_errors(s)["bit-true"]) for s in scenes]
    cells, whole = (
        [read_budget(s.path)["xc2v"][s.twin().entity] for s in some]
        for some in (scenes, [load_scene(name) for name in INSTRUMENTS])
    )
    rows = [
        ("error on held-out rows", "-", *held_out),
        ("mean error at the worst position", worst(printed["simulation"]), *largest),
        ("the same, with real sensors", worst(printed["real_time"]), "-", "-"),
        ("clocks after the last sample", "-", *(str(s.twin().output_clocks[-1]) for s in scenes)),
        ("LUTs", luts, *(f"{c['LUT']:,}" for c in cells)),
        ("LUTs with scan and profile", "not said", *(f"{c['LUT']:,}" for c in whole)),
        ("multipliers", multipliers, *(str(c["multiplier"]) for c in cells)),
        ("block RAMs", "-", *(str(c["block RAM"]) for c in cells)),
        ("proved for", "-", *(f"all 2^{14 * len(s.sensors)} frames" for s in scenes)),
    ]
    return markdown(" | thesis, printed | thesis, rebuilt | our own", rows)


def against_run_time(networks: Table) -> Iterator[str]:
    """The default network beside the thesis' cascade, by the same measures; and the scan."""
    default, rebuilt = (_network(networks, scene) for scene in (SHOWN, REBUILT))
    clock = float(thesis_table("board")["clock_mhz"])
    ratio = number(default, AFTER) / number(rebuilt, AFTER)

    def told(row: Row) -> str:
        return (
            f"errs by {number(row, HELD_OUT):.2f} % on held-out rows, in {_us(row, clock)} µs on "
            f"{number(row, 'multiplier'):.0f} multiplier{'s' * (number(row, 'multiplier') != 1)}, "
            f"{number(row, 'block RAM'):.0f} block RAMs and {number(row, 'LUT'):,.0f} LUTs"
        )

    yield (
        f"**The default network (scene `{SHOWN}`) {told(default)}; the thesis' cascade, rebuilt "
        f"(`{REBUILT}`), {told(rebuilt)}.** So the default is {ratio:.1f} times as slow, and "
        "both are much faster than the scan of the sensors, for which they wait."
    )
    yield ""
    printed = thesis_table(PRINTED["cascade"][0])
    rows = [
        [
            name,
            f"{number(row, HELD_OUT):.2f}",
            f"{number(row, WORST):.2f}",
            f"{number(row, AFTER):,.0f}",
            _us(row, clock),
            f"{number(row, 'LUT'):,.0f}",
            f"{number(row, 'multiplier'):.0f}",
            f"{number(row, 'block RAM'):.0f}",
        ]
        for name, row in ((f"`{SHOWN}`", default), (f"`{REBUILT}`", rebuilt))
    ]
    error = f"{max(printed['simulation']):.2f}; {max(printed['real_time']):.2f} with real sensors"
    rows.append(["cascade, as printed", "", error, "", "", *_printed_cells(printed), ""])
    scan = f"{SCAN_CLOCKS:,}", f"{SCAN_CLOCKS / clock:g}"
    rows.append(["scan of the sensors", "", "", *scan, "", "", ""])
    heads = f" | error held out, % | error on recorded rows, % | clocks | µs at {clock:g} MHz"
    yield markdown(f"{heads} | LUTs, entity by entity | multipliers | block RAMs", rows)
    yield ""
    yield (
        "Held out is the mean error of the worst output on rows that no training had seen: for "
        f"`{SHOWN}` stretches, which is harder, and for `{REBUILT}` rows drawn at random. After "
        f"that `{SHOWN}` was trained further on all rows. The error on recorded rows is the mean "
        "at the worst position, as the thesis prints it. Clocks count from the last sample to the "
        "last output; the thesis prints no time for a frame. A vendor's tool placed its LUTs, "
        "Yosys maps ours and counts no inverters."
    )


def _printed_cells(printed: Mapping[str, Any]) -> Iterator[str]:
    """LUTs and multipliers of a network that the thesis prints in percent of its device."""
    device = thesis_table("device")
    for share, kind in (("luts_percent", "luts4"), ("mult18x18_percent", "mult18x18")):
        yield f"about {printed[share] * device[kind] / 100:,.0f}"


def _network(networks: Table, scene: str) -> Row:
    (found,) = (row for row in rows_of(networks) if scene_of(row) == scene)
    return found


def _us(row: Row, clock: float) -> str:
    return f"{number(row, AFTER) / clock:.2f}"


def kept(scenes: Table) -> dict[str, tuple[float, float]]:
    """How much of the whole is built, by kind, for a picture of the page's headline."""
    (row,) = rows_of(scenes, scene=REBUILT)
    one, every = (clocks_per_frame(load_scene(name).twin()) for name in (ONE_OUTPUT, SHOWN))
    return {
        "LUTs": (number(row, f"LUT, {LEAN}"), number(row, f"LUT, {WHOLE}")),
        "words of ROM": (number(row, f"words, {LEAN}"), number(row, f"words, {WHOLE}")),
        "clocks for load": (one, every),
    }


def headline_left_out(scenes: Table) -> str:
    """How much of the whole is built, in a sentence."""
    luts, rom, clocks = (f"{part:,.0f} of {whole:,.0f}" for part, whole in kept(scenes).values())
    return (
        f"**Built as in the thesis, `{REBUILT}` takes {luts} LUTs and {rom} words of ROM. Asked "
        f"for the load alone, `{SHOWN}` takes {clocks} clocks.**"
    )


def program_rows() -> str:
    """Words and clocks of the program of the default scene, and of programs that need less."""
    scene = load_scene(SHOWN)
    networks = scene.mlps()
    asked = [", ".join(scene.outputs[:count]) for count in range(len(networks), 0, -1)]
    programs = {f"{names} asked for": networks[: names.count(",") + 1] for names in asked}
    for part in PRUNED:
        programs[f"the least {part:.0%} of the weights of each layer are 0"] = [
            replace(one, w1=_pruned(one.w1, part), w2=_pruned(one.w2, part)) for one in networks
        ]
    programs["a node of each network is dead: no output reads it"] = [
        replace(one, w2=np.where(np.arange(one.w2.shape[1]) == 0, 0.0, one.w2)) for one in networks
    ]
    rows = []
    for name, these in programs.items():
        engine = Engine.of(these, scene.settings(True, these), scene.arrangement)
        rows.append([name, words(engine), clocks_per_frame(engine)])
    return markdown("scene `digit` with | words | clocks", rows)


def _pruned(weights: Real, part: float) -> Real:
    return np.where(np.abs(weights) < np.quantile(np.abs(weights), part), 0.0, weights)


def wishes(found: dict[Path, str]) -> str:
    """What tactus was asked to show, each with the headline of its page."""
    lines = ["![What was asked for, each in a picture](docs/wishes.svg)", ""]
    for wish, page in WISHES.items():
        path = ROOT / "docs" / page
        text = found.get(path) or path.read_text(encoding="utf-8")
        headline = re.search(r"\*\*(.+?)\*\*", text, re.S)
        assert headline, page
        lines.append(f"- [{wish}](docs/{page}): {' '.join(headline[1].split())}")
    return "\n".join(lines)


def parts_of_bounds() -> list[float]:
    """The figure of each stiff or extreme case as a part of its bound, where that is above 0."""
    columns, rows = read_csv(ROOT / "studies" / "stability" / "result.csv")
    value, bound = columns.index("value"), columns.index("bound")
    return [float(row[value] or 0) / float(row[bound] or 0) for row in rows if row[bound]]


def editor_schema() -> str:
    """The schema by which an editor completes a scene."""
    return json_schema(SCENE, "A scene of tactus")


def pages() -> dict[Path, str]:
    """The text of every file that this command writes."""
    docs = ROOT / "docs"
    networks = clocks(SEED)
    lean = left_out(SEED)
    sections: list[tuple[Path, str, Callable[[], str]]] = [
        (ROOT / "README.md", "headline", headline),
        (
            docs / "error-against-run-time.md",
            "headline",
            lambda: "\n".join(against_run_time(networks)),
        ),
        (docs / "left-out.md", "headline", lambda: headline_left_out(lean)),
        (docs / "left-out.md", "programs", program_rows),
    ]
    found: dict[Path, str] = {}
    for page, section, text in sections:
        before = found.get(page) or page.read_text(encoding="utf-8")
        found[page] = put(page, before, text(), COMMAND, section)
    found[EDITOR_SCHEMA] = editor_schema()
    found[docs / "overview.svg"] = overview(load_scene(SHOWN))
    found[docs / "area.svg"] = area(networks) + "\n"
    found[docs / "wishes.svg"] = draw_wishes(
        network_rows(networks),
        (SHOWN, REBUILT),
        float(thesis_table("board")["clock_mhz"]),
        parts_of_bounds(),
        kept(lean),
    )
    found[docs / "error-against-run-time" / "networks.svg"] = draw_networks(networks) + "\n"
    readme = ROOT / "README.md"
    found[readme] = put(readme, found[readme], wishes(found), COMMAND, "wishes")
    return found


def main() -> None:
    stop_if_dry_run("write what is generated in the documentation")
    write(pages())


END = "<!-- to here -->"


def begin(command: str, section: str = "") -> str:
    """The first marker, which names the command that writes the text, and the section."""
    return f"<!-- {section and section + ', '}from here: {command} -->"


def put(page: Path, old: str, text: str, command: str, section: str = "") -> str:
    """The page's text ``old`` with ``text`` between its markers.

    page: The page, which the message names.
    command, section: See ``begin``.
    """
    first = begin(command, section)
    head, _, rest = old.partition(first)
    if old.count(first) != 1 or END not in rest:
        raise InputError(f"{page}: expected the markers {first} and {END} once each")
    return f"{head}{first}\n\n{text}\n\n{END}{rest.partition(END)[2]}"


def write(pages: Mapping[Path, str]) -> None:
    """Write the pages that differ or do not exist, and say which."""
    for page, text in pages.items():
        if not page.exists() or page.read_text(encoding="utf-8") != text:
            with replace_file(page) as temporary:
                temporary.write_text(text, encoding="utf-8")
            print(f"wrote {page.relative_to(ROOT)}")


if __name__ == "__main__":
    sys.exit(run(main))
