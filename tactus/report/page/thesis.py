"""``python -m tactus.report.page.thesis``: writes printed figures of the thesis beside measured
ones.

It rewrites the text between its markers in ``docs/thesis*.md`` and in the pages of ``ELSEWHERE``,
and the pictures in ``docs/thesis``. The rest of a page stays as it is.
"""

import math
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from golden.common.block import walk
from tactus.core.cli import run
from tactus.core.fingerprint import ROOT
from tactus.report.draw import along, multipliers, profiles, rigs, series
from tactus.report.draw.convergence import convergence_plot
from tactus.report.measure import table_records
from tactus.report.measure.camera import camera
from tactus.report.measure.low_pass import low_pass
from tactus.report.measure.printed import (
    ALONG,
    CASCADE_B,
    PARALLEL,
    SINGLE,
    along_beam,
    largest,
    printed,
    widths,
)
from tactus.report.measure.table import Cell, Table
from tactus.report.measure.table_records import SEED
from tactus.report.page.markers import put, write
from tactus.scene import load_scene, thesis_table
from tactus.synth.budget import budget_path, read_budget

COMMAND = "python -m tactus.report.page.thesis"
DOCS = ROOT / "docs"
PICTURES = DOCS / "thesis"
# The table of the printed figures, the scene of the same form, and the scene on an engine.
RESOURCES = {
    "2:6:2, gradient": ("parallel_2_6_2.gradient", "digit-parallel", ""),
    **{
        f"2:6:2, {name}": (f"parallel_2_6_2.{name}", f"comparison/digit-parallel-{name}", "")
        for name in ("polynomial", "pade", "lut")
    },
    "digit, single": ("digit.hybrid", "digit-single-thesis", "comparison/digit-single-engine"),
    "digit, cascade": ("digit.cascade_b", "digit-thesis", "digit"),
    **{
        f"swing, {n}": (f"swing.{n}", f"comparison/swing-{n}-thesis", f"swing-{n}")
        for n in ("single", "multiple", "cascade")
    },
}


def errors() -> str:
    """The table ``printed``."""
    table = printed(SEED)
    heads = [
        *("network", "output", "printed, float", "bit-true", "real time"),
        *("ours, 14 bits", "as in real time at mV", "ours, float", "18 bits"),
    ]
    return _table(heads, table.rows)


def summary() -> str:
    """How many of our figures are below the printed ones, and the noise as in real time."""
    table = printed(SEED)
    told = [_below(table, *compared) for compared in COMPARED]
    noises = [noise for _, _, noise in _pairs(table, *MEASURED)]
    return (
        f"Our errors against those of the thesis: {'; '.join(told)}. "
        f"With noise of {min(noises):.2g} to {max(noises):.2g} mV on every reading, ours are as "
        "large as those that it measured in real time."
    )


# The printed column, our column beside it, and the words for both in a sentence.
COMPARED = [
    (
        "printed, simulation %",
        "thesis arithmetic, bit-true %",
        "in 14 bits are below its simulated errors",
    ),
    (
        "printed, floating point %",
        "floating point %",
        "in floating point are below its own errors in floating point",
    ),
]
MEASURED = ("printed, real time %", "as in real time with noise of mV")


def _pairs(table: Table, one: str, other: str) -> list[tuple[str, float, float]]:
    """The subject and the figures of both columns, for the rows that have both."""
    a, b = (list(table.columns).index(name) for name in (one, other))
    return [
        (
            f"the {row[1]} of {str(row[0]).replace(', ', ' with ')}",
            float(str(row[a])),
            float(str(row[b])),
        )
        for row in table.rows
        if row[a] is not None and row[b] is not None
    ]


def _below(table: Table, theirs: str, ours: str, text: str) -> str:
    pairs = _pairs(table, theirs, ours)
    above = [what for what, limit, own in pairs if own >= limit]
    but = f", all but {', '.join(above)}" if above else ""
    return f"{len(pairs) - len(above)} of {len(pairs)} {text}{but}"


def resources() -> str:
    """The printed slices, LUTs, multipliers and gates, beside the shares of our scenes."""
    heads = [
        *("network", "printed slices %", "LUTs %", "multipliers %", "gates"),
        *("ours", "slices %, at least", "LUTs %", "multipliers", "multipliers %"),
        *("engine", "slices %, at least", "LUTs %", "multipliers", "multipliers %"),
    ]
    rows: list[list[Cell]] = []
    for name, (key, same, engine) in RESOURCES.items():
        figures = thesis_table(key)
        kinds = ("slices_percent", "luts_percent", "mult18x18_percent", "gates")
        rows.append([name, *(figures[kind] for kind in kinds), *_shares(same), *_shares(engine)])
    return _table(heads, rows, 1)


def _shares(name: str) -> list[Cell]:
    """The scene, its shares of slices, LUTs and multipliers of the thesis' device in %; a count."""
    if not name:
        return [None] * 5
    scene, device = load_scene(name), thesis_table("device")
    top = read_budget(budget_path(scene.path))["xc2v"][scene.twin().entity]
    # A slice has two LUTs and two flip-flops, so it takes at least half of the larger number.
    slices = -(-max(top["LUT"], top["flip-flop"]) // 2)
    count = top["multiplier"]
    shares = (slices / device["slices"], top["LUT"] / device["luts4"], count / device["mult18x18"])
    slice_share, lut_share, share = (round(100 * share, 1) for share in shares)
    return [scene.path.stem, slice_share, lut_share, count, share]


def folded() -> list[multipliers.Pair]:
    """The networks that are folded as in the thesis, with their shares of its multipliers."""
    found = []
    for name, (key, same, _) in RESOURCES.items():
        if load_scene(same).design == "hybrid":
            count, share = _shares(same)[-2:]
            figures, of = thesis_table(key), thesis_table("device")["mult18x18"]
            ruled = 3 * sum(figures["hidden"]) + len(load_scene(same).members)
            found.append(
                multipliers.Pair(
                    name,
                    float(figures["mult18x18_percent"]),
                    100 * ruled / of,
                    int(str(count)),
                    float(str(share)),
                )
            )
    return found


def claims() -> str:
    """What the text of the thesis claims beside its tables, and our figures."""
    printed, cascade = thesis_table("claims"), thesis_table("digit.cascade_b")
    real = cascade["real_time"]
    ours = largest(load_scene(CASCADE_B.alike))[1]
    single = load_scene(SINGLE.alike)
    (shape,) = (mlp.shape for mlp in single.mlps())
    inputs, hidden, outputs = shape
    top = read_budget(budget_path(single.path))["xc2v"][single.twin().entity]
    rows = [
        [
            f"{printed['accuracy_percent']} % are acceptable in a clinic (section 1.2.1)",
            f"{_floor(100 - max(real))} % and more, cascade B in real time",
            f"{_floor(100 - max(ours))} % and more, `{CASCADE_B.alike}` on recorded rows; far less "
            "in width and shape on a load that was never trained ([honest](figures.md#honest))",
        ],
        [
            f"Ma and others reached errors of {_listed(printed['ma_percent'])} % (chapter 7)",
            f"{_listed(real)} %, cascade B in real time",
            f"{_listed([round(error, 2) for error in ours])} %, `{CASCADE_B.alike}`",
        ],
        [
            "folding 4:16:4 saves three quarters of the multiplications (section 5.4.1)",
            f"{printed['folded_multiplications']} instead of {printed['parallel_multiplications']}",
            f"{2 * hidden} instead of {hidden * (inputs + outputs)} for both layers; "
            f"with activations and factors {top['multiplier']}",
        ],
    ]
    return _table(["claim", "printed", "here"], rows)


def _floor(share: float) -> float:
    """To a tenth that it reaches, because it is said that others are as large or larger."""
    return math.floor(10 * share) / 10


def _listed(figures: Sequence[float]) -> str:
    return ", ".join(f"{figure:g}" for figure in figures)


def cells() -> str:
    """The printed gates of each activation of the thesis, and our recorded cells."""
    kinds = ("LUT", "flip-flop", "multiplier", "block RAM")
    rows: list[list[Cell]] = []
    for pair in PARALLEL:
        scene = load_scene(pair.alike)
        budget = read_budget(budget_path(scene.path))["xc2v"]
        own = [budget[part.entity] for part in walk(scene.twin()) if part.block == scene.activation]
        largest = max(own, key=lambda found: found["LUT"])
        gates = thesis_table(f"activation.{scene.activation}")["gate_count"]
        rows.append([scene.activation, gates, *(largest[kind] for kind in kinds)])
    return _table(["scheme", "printed gates", *kinds], rows)


def lengths() -> str:
    """The table ``camera``, and which printed figures lie below the error of the cameras."""
    table = camera(SEED)
    heads = [name.replace("swing-", "") for name in table.columns]
    named = [name for name in table.columns if name.startswith("printed")]
    rows = [[f"way in {row[0]}", f"{row[1]}", *row[2:]] for row in table.rows]
    below = [
        f"{row[0]} by {name.removeprefix('printed ').removesuffix(' mm')}"
        for row in table.rows
        for name in named
        if float(str(row[list(table.columns).index(name)])) < float(str(row[1]))
    ]
    return (
        f"{_table(heads, rows)}\n\nThese printed errors are below the error of the "
        f"cameras: {', '.join(below)}."
    )


def settling() -> str:
    """The table ``low_pass`` and its note."""
    table = low_pass(SEED)
    return f"{_table(table.columns, table.rows, 1)}\n\n{table.note}"


def _table(heads: Sequence[str], rows: Sequence[Sequence[Cell]], digits: int = 2) -> str:
    lines = [f"| {' | '.join(heads)} |", f"|{'---|' * len(heads)}"]
    for row in rows:
        lines.append(f"| {' | '.join(_shown(cell, digits) for cell in row)} |")
    return "\n".join(lines)


def _shown(cell: Cell, digits: int) -> str:
    if cell is None:
        return ""
    if isinstance(cell, float):
        return f"{cell:.{digits}f}"
    return f"{cell:,}" if isinstance(cell, int) else cell


def drawn() -> dict[str, tuple[str, str]]:
    """Each picture, by its name, with the sentence below it."""
    beam, width = along_beam(SEED), along.widths_plot(widths(SEED))
    training = convergence_plot(table_records.read("convergence"))
    sagging, swinging = rigs.deflections(), rigs.forces()
    found = {
        along.name_of(kind): (along.along_beam(beam, kind), along.along_sentence(beam, kind))
        for kind in ALONG
    }
    pairs, shown = folded(), profiles.unit()
    return found | {
        "multipliers": (
            multipliers.drawn(pairs, thesis_table("device")["mult18x18"]),
            multipliers.sentence(pairs),
        ),
        "widths": (width.draw(), width.sentence),
        "convergence": (training.draw(), training.sentence),
        "taylor": (series.drawn(), series.sentence()),
        "functions": (profiles.functions_drawn(), profiles.functions_sentence()),
        "profiles": (profiles.unit_drawn(shown), profiles.unit_sentence(shown)),
        "gauges": (rigs.gauges(), rigs.gauges_sentence()),
        "deflections": (rigs.deflections_drawn(sagging), rigs.deflections_sentence(sagging)),
        "forces": (rigs.forces_drawn(swinging), rigs.forces_sentence(swinging)),
    }


def pages() -> dict[Path, str]:
    """The text of every file that this command writes."""
    pictures = drawn()
    sections: list[tuple[str, str, Callable[[], str]]] = [
        ("thesis", "summary", summary),
        ("thesis-tables", "errors", errors),
        ("thesis-tables", "resources", resources),
        ("thesis", "claims", claims),
        ("activations", "cells", cells),
        ("physics", "low-pass", settling),
        ("physics", "camera", lengths),
    ]
    found: dict[Path, str] = {}
    for page, section, text in sections:
        path = DOCS / f"{page}.md"
        before = found.get(path) or path.read_text(encoding="utf-8")
        found[path] = put(path, before, text(), COMMAND, section)
    for name, (svg, sentence) in pictures.items():
        path = DOCS / f"{ELSEWHERE.get(name, 'thesis-tables')}.md"
        before = found.get(path) or path.read_text(encoding="utf-8")
        found[path] = put(path, before, sentence, COMMAND, name)
        found[PICTURES / f"{name}.svg"] = svg + "\n"
    return found


# The pages with the sentences of these pictures; those of the others are in docs/thesis-tables.md.
ELSEWHERE = {
    "multipliers": "thesis",
    "deflections": "physics",
    "forces": "physics",
    "taylor": "activations",
    "functions": "visualisation",
    "profiles": "visualisation",
}


def main() -> None:
    PICTURES.mkdir(exist_ok=True)
    write(pages())


if __name__ == "__main__":
    sys.exit(run(main))
