"""``python -m tactus.report.page.lists``: writes lists and tables that follow from the project.

It rewrites the text between the markers of README.md and of the pages with results, the pictures of
pages, and the schema of a scene for editors. The rest of a page stays as it is. Whatever else a
program knows is written as the site is built (``made``).
"""

import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from golden.activation.bipartite import Bipartite, BipartitePair
from golden.activation.lut import Lut
from golden.activation.precise import Precise
from golden.activation.rom import Rom
from golden.common.block import Block
from golden.engine.program_memory import ProgramMemory, ProgramRam
from golden.input_error import InputError
from golden.networks.engine import Engine
from golden.numbers.real import Real
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.files import replace_file
from tactus.core.fingerprint import ROOT
from tactus.core.schema import json_schema
from tactus.errors import held_out_means, scene_errors
from tactus.report.draw import run_time
from tactus.report.draw.run_time import PRINTED, SCAN_CLOCKS, Design
from tactus.report.measure.networks import clocks_per_frame
from tactus.report.measure.table import markdown
from tactus.scene import load_scene, thesis_table
from tactus.scene.reading import EDITOR_SCHEMA, SCENE
from tactus.synth.budget import read_budget
from tactus.synth.lean import read_lean

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
        (
            "clocks after the last sample",
            "-",
            *(str(s.twin().clocks_after_samples) for s in scenes),
        ),
        ("LUTs", luts, *(f"{c['LUT']:,}" for c in cells)),
        ("LUTs with scan and profile", "not said", *(f"{c['LUT']:,}" for c in whole)),
        ("multipliers", multipliers, *(str(c["multiplier"]) for c in cells)),
        ("block RAMs", "-", *(str(c["block RAM"]) for c in cells)),
        ("proved for", "-", *(f"all 2^{14 * len(s.sensors)} frames" for s in scenes)),
    ]
    return markdown(" | thesis, printed | thesis, rebuilt | our own", rows)


def against_run_time(networks: Sequence[Design]) -> Iterator[str]:
    """The default network beside the thesis' cascade, by the same measures; and the scan."""
    named = {one.name: one for one in networks}
    default, rebuilt = named[SHOWN], named[REBUILT]
    clock = float(thesis_table("board")["clock_mhz"])

    def told(one: Design) -> str:
        return (
            f"errs by {one.held_out:.2f} % on held-out rows, in {one.clocks / clock:.2f} µs on "
            f"{one.multipliers} multiplier{'s' * (one.multipliers != 1)}, "
            f"{one.block_rams} block RAMs and {one.luts:,.0f} LUTs"
        )

    yield (
        f"**The default network (scene `{SHOWN}`) {told(default)}; the thesis' cascade, rebuilt "
        f"(`{REBUILT}`), {told(rebuilt)}.** So the default is "
        f"{default.clocks / rebuilt.clocks:.1f} times as slow, and "
        "both are much faster than the scan of the sensors, for which they wait."
    )
    yield ""
    printed = thesis_table(PRINTED["cascade"][0])
    rows: list[list[object]] = [
        [
            f"`{one.name}`",
            f"{one.held_out:.2f}",
            f"{one.error:.2f}",
            f"{one.clocks:,.0f}",
            f"{one.clocks / clock:.2f}",
            f"{one.luts:,.0f}",
            one.multipliers,
            one.block_rams,
        ]
        for one in (default, rebuilt)
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


def headline_left_out() -> str:
    """How much of the whole is built, in a sentence."""
    rebuilt = load_scene(REBUILT)
    cells = read_lean(rebuilt.path)
    rom, every = words(rebuilt.twin()), words(rebuilt.twin(lean=False))
    one, four = (clocks_per_frame(load_scene(name).twin()) for name in (ONE_OUTPUT, SHOWN))
    return (
        f"**Built as in the thesis, `{REBUILT}` takes {cells.lean['LUT']:,} of "
        f"{cells.whole['LUT']:,} LUTs and {rom} of {every} words of ROM. Asked for the load alone, "
        f"`{SHOWN}` takes {one} of {four} clocks.**"
    )


def words(block: Block) -> int:
    """The words of all programs and tables in a block, counted as often as they are built."""
    return _words(block) + sum(map(words, block.parts()))


def _words(part: Block) -> int:
    if isinstance(part, Engine) and part.alone:
        return part.program.rows + len(part.program.words)
    if isinstance(part, ProgramRam):
        return 1 << part.addr_width
    if isinstance(part, ProgramMemory | Rom | Lut):
        return len(part.words)
    if isinstance(part, Precise):
        return part.words
    if isinstance(part, BipartitePair):
        return _words(part.activation)
    if isinstance(part, Bipartite):
        return len(part.bases) + len(part.corrections)
    return 0


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
    lines = []
    for wish, page in WISHES.items():
        path = ROOT / "docs" / page
        text = found.get(path) or path.read_text(encoding="utf-8")
        headline = re.search(r"\*\*(.+?)\*\*", text, re.S)
        assert headline, page
        lines.append(f"- [{wish}](docs/{page}): {' '.join(headline[1].split())}")
    return "\n".join(lines)


def editor_schema() -> str:
    """The schema by which an editor completes a scene."""
    return json_schema(SCENE, "A scene of tactus")


def pages() -> dict[Path, str]:
    """The text of every file that this command writes."""
    docs = ROOT / "docs"
    networks = run_time.measured()
    sections: list[tuple[Path, str, Callable[[], str]]] = [
        (ROOT / "README.md", "headline", headline),
        (
            docs / "error-against-run-time.md",
            "headline",
            lambda: "\n".join(against_run_time(networks)),
        ),
        (docs / "left-out.md", "headline", headline_left_out),
        (docs / "left-out.md", "programs", program_rows),
    ]
    found: dict[Path, str] = {}
    for page, section, text in sections:
        before = found.get(page) or page.read_text(encoding="utf-8")
        found[page] = put(page, before, text(), COMMAND, section)
    found[EDITOR_SCHEMA] = editor_schema()
    found[docs / "area.svg"] = run_time.area(networks) + "\n"
    found[docs / "error-against-run-time" / "networks.svg"] = run_time.networks(networks) + "\n"
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
