"""What programs know, for the pages of the site that ask for it with ``<!-- made: name -->``.

It is written when the site is built and committed nowhere, so it cannot be out of date.
"""

import re
import tomllib
from collections.abc import Callable
from functools import cache, partial
from itertools import zip_longest

from golden.activation.schemes import forms
from golden.activation.segments import GRADIENT, INTERCEPT, UPPER
from golden.engine.pipeline import LanePipeline, Pipeline
from tactus.core.fingerprint import ROOT
from tactus.core.schema import KeyTable, key_rows
from tactus.errors import decisions_of, held_out_or_all
from tactus.report.activations import plot, plot_file
from tactus.report.draw.network import network
from tactus.report.measure.activation_errors import activation_table
from tactus.report.measure.networks import clocks_per_frame
from tactus.report.measure.table import markdown
from tactus.report.page import blocks, boards, datasheets, designs, sign_off
from tactus.report.page.side_by_side import side_by_side
from tactus.scene import DEFAULT_SCENES, class_names, load_scene, scene_names
from tactus.scene.reading import SCENE
from tactus.synth.budget import read_budget

ROOMS = ("golden", "hdl", "tb", "tactus")


def scenes() -> str:
    """Every shipped scene, with the first paragraph of its file and its parts."""
    rows = []
    for name in sorted([*scene_names(), *class_names()]):
        scene = load_scene(name)
        head = re.split(r"\n#?\n", scene.path.read_text(encoding="utf-8"), maxsplit=1)[0]
        text = " ".join(line.removeprefix("#").strip() for line in head.splitlines())
        parts = scene.design, scene.activation, scene.precision.name
        rows.append([f"`{name}`", text, *(f"`{word}`" for word in parts)])
    return markdown("shipped scene | what it is | design | activation | precision", rows)


def classes() -> str:
    """What every shipped scene of classes costs, and how often it is wrong on held-out rows."""
    heads = (
        "scene | network | LUT | multiplier | block RAM | clocks of a frame | held-out rows | "
        "wrong | wrong in floating point"
    )
    table = []
    for name in class_names():
        scene = load_scene(name)
        top = read_budget(scene.path)["xc2v"][scene.twin().entity]
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
        table.append(cells)
    return markdown(heads, table)


def keys(section: str) -> str:
    """The keys of a section of a scene."""
    table = SCENE.keys[section].kind
    assert isinstance(table, KeyTable), section
    return key_rows(table)


def floors() -> str:
    """The packages of the four rooms, from the top floor down: contracts of import-linter."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    rooms = [
        [", ".join(f"`{one}`" for one in layer.split(" | ")) for layer in contract["layers"][::-1]]
        for room in ROOMS
        for contract in contracts
        if contract.get("containers") == [room]
    ]
    rows = [*zip_longest(*rooms, fillvalue="")][::-1]
    return markdown(" | ".join(f"{room}/" for room in ROOMS), rows)


def segments() -> str:
    """The segments of Table 4.1 of the thesis."""
    rows = zip(range(1, len(UPPER) + 1), UPPER, GRADIENT, INTERCEPT, strict=True)
    return markdown("n | up to q_n | g_n | i_n", rows)


def pipeline() -> str:
    """Every clock of an engine's pipeline, and what happens in it."""
    rows = []
    forms = [LanePipeline(), LanePipeline(memory_registers=1)]
    for name, value in (vars(LanePipeline) | vars(Pipeline) | vars(LanePipeline)).items():
        if isinstance(value, property) and name != "table":
            clocks = [getattr(form, name) for form in forms]
            rows.append([f"`{name}`", *clocks, " ".join((value.__doc__ or "").split())])
    return markdown("name | clocks | with registers | what is there", rows)


def activation_errors() -> str:
    """The table of make activations."""
    table = activation_table()
    return f"{markdown(' | '.join(table.columns), table.shown)}\n\n{table.note}"


def demo() -> str:
    """The table at the end of the demo, without the line on what was compared."""
    lines = side_by_side([load_scene(name) for name in DEFAULT_SCENES])
    return "\n".join(f"    {line}".rstrip() for line in lines)


def picture(draw: Callable[[], str]) -> str:
    """An SVG within the page."""
    return f"<div>\n{draw().strip()}\n</div>"


MADE: dict[str, Callable[[], str]] = {
    **{name: partial(keys, name) for name in SCENE.keys},
    "scenes": scenes,
    "classes": classes,
    "side_by_side": demo,
    "blocks": blocks.block_table,
    "sign-off": sign_off.overview,
    "synthesis": datasheets.scene_table,
    "converters": boards.converters,
    "wiring": boards.wiring,
    "sources": boards.pin_sources,
    "resources": boards.resources,
    "digit": partial(designs.rows, designs.CASCADE),
    "digit-single": partial(designs.rows, designs.SINGLE),
    "ecp5": partial(designs.rows, designs.SINGLE, "ecp5"),
    "learned": partial(designs.rows, designs.LEARNED),
    "held-out": designs.spreads,
    "picture-of-designs": partial(picture, designs.picture),
    "floors": floors,
    "networks": partial(picture, lambda: network(load_scene("digit"))),
    "segments": segments,
    "activation-errors": activation_errors,
    **{
        f"errors-of-{plot_file(name).removesuffix('.svg')}": partial(
            picture, partial(plot, name, scheme)
        )
        for name, scheme in forms().items()
    },
    "pipeline": pipeline,
}
MARK = re.compile(r"<!-- made: ([\w-]+) -->")


@cache
def made(name: str) -> str:
    """The text of this name. A name that does not exist stops the building of the site."""
    return MADE[name]()
