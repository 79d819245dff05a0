"""``python -m tactus.report.page.lists``: writes lists and tables that follow from the project.

It rewrites the text between the markers of README.md and of the pages with results, the pictures of
pages, and the schema of a scene for editors. The rest of a page stays as it is. Whatever else a
program knows is written as the site is built (``made``).
"""

import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from golden.activation.bipartite import Bipartite, BipartitePair
from golden.activation.lut import Lut
from golden.activation.precise import Precise
from golden.activation.rom import Rom
from golden.common.block import Block
from golden.engine.memories import ProgramMemory, ProgramRam
from golden.input_error import InputError
from golden.networks.engine import Engine
from golden.trained.dense import Dense, DenseNetwork
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.files import replace_file
from tactus.core.fingerprint import ROOT
from tactus.core.schema import json_schema
from tactus.report.draw import run_time
from tactus.report.measure.networks import FAMILY, clocks_per_frame
from tactus.report.measure.table import markdown
from tactus.report.page.headline import REBUILT, SHOWN, against_run_time, headline
from tactus.scene import load_scene
from tactus.scene.keys import EDITOR_SCHEMA, SCENE
from tactus.synth.budget import read_budget

COMMAND = "python -m tactus.report.page.lists"
# Each wish for the project, and the page that shows the result.
WISHES = {
    "Report error against run time": "error-against-run-time.md",
    "Check numerical stability on stiff and extreme cases": "stability.md",
    "Leave out what a given scene does not need": "left-out.md",
}
# The LUTs that `make lean` counts of the rebuilt networks if they are built whole: test_pages.py
# counts them again.
WHOLE = 3163
ONE_OUTPUT = "digit-load"
PRUNED = (0.1, 0.25, 0.5)


def table() -> str:
    found = headline()
    return markdown(" | ".join(found.columns), found.rows)


def headline_left_out() -> str:
    """How much of the whole is built, in a sentence."""
    rebuilt = load_scene(REBUILT)
    lean = read_budget(rebuilt.path)[FAMILY][rebuilt.twin().entity]["LUT"]
    rom, every = words(rebuilt.twin()), words(rebuilt.twin(lean=False))
    one, four = (clocks_per_frame(load_scene(name).twin()) for name in (ONE_OUTPUT, SHOWN))
    return (
        f"**Built as in the thesis, `{REBUILT}` takes {lean:,} of {WHOLE:,} LUTs and {rom} of "
        f"{every} words of ROM. Asked for the load alone, `{SHOWN}` takes {one} of {four} clocks.**"
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
            DenseNetwork(tuple(_pruned(layer, part) for layer in one.layers)) for one in networks
        ]
    programs["a node of each network is dead: no output reads it"] = [
        DenseNetwork(
            (first, replace(second, weights=second.weights * (np.arange(first.nodes) > 0)))
        )
        for first, second in (one.layers for one in networks)
    ]
    rows = []
    for name, these in programs.items():
        engine = Engine.of(these, scene.settings(True, these), scene.arrangement)
        rows.append([name, words(engine), clocks_per_frame(engine)])
    return markdown("scene `digit` with | words | clocks", rows)


def _pruned(layer: Dense, part: float) -> Dense:
    sizes = np.abs(layer.weights)
    return replace(layer, weights=np.where(sizes < np.quantile(sizes, part), 0.0, layer.weights))


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
    told = f"{against_run_time()}\n\n{table()}\n\n{headline().note}"
    sections: list[tuple[Path, str, Callable[[], str]]] = [
        (ROOT / "README.md", "headline", table),
        (docs / "error-against-run-time.md", "headline", lambda: told),
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
