"""The table that compares the default scenes with each other and with the printed thesis.

The scenes have the same sensors and outputs. The table shows what the thesis built, that it is
reproduced here, and what the same task takes today. The cells are those that ``make synth``
recorded, so nothing is synthesised for the table.
"""

import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.errors import held_out_means, scene_errors
from tactus.report.measure.networks import clocks_per_frame
from tactus.scene import Scene, load_scene, thesis_figures, thesis_table
from tactus.synth.budget import read_budget

FAMILY = "xc2v"
# This scene has the networks of digit, with a scan and a profile as in the thesis.
WHOLE = "digit-instrument"
KINDS = ("LUT", "multiplier", "flip-flop", "block RAM")
# For each kind of cell, the percentage of its device that the thesis prints.
SHARES = {"LUT": ("luts_percent", "luts4"), "multiplier": ("mult18x18_percent", "mult18x18")}
NONE = "-"
WIDTH = 27

Row = tuple[str, ...]


def side_by_side(
    scenes: Sequence[Scene], results: Mapping[str, dict[str, Any]] | None = None
) -> list[str]:
    """The lines of the table, and of the notes below it.

    scenes: Scenes with the same sensors, outputs and reference.
    results: The results of the benches, by the name of the scene. With them the clocks are the
        simulated ones, and there is a line about what was compared. Without them the clocks are
        those of the twins.
    """
    first = scenes[0]
    for scene in scenes:
        got = (scene.sensors, scene.outputs, scene.reference)
        expected = (first.sensors, first.outputs, first.reference)
        if got != expected:
            raise InputError(
                f"{scene.path}: got sensors, outputs and reference {got}, expected {expected}, "
                f"those of {first.name}"
            )
    rows: list[Row] = [
        ("", "thesis, as printed", *(f"scene {scene.name}" for scene in scenes)),
        ("networks", _printed_networks(first), *(scene.describe() for scene in scenes)),
        (
            "arithmetic",
            "14 bits",
            *(f"{s.precision.coeff_width} bits, {s.precision.name}" for s in scenes),
        ),
        ("activation", "gradient", *(scene.activation_text for scene in scenes)),
        ("folded as", "hybrid", *(scene.design for scene in scenes)),
        ("around them", "scan, profile", *map(_around, scenes)),
        *_errors(scenes),
        *_clocks(scenes, results),
        *_cells(scenes),
    ]
    if results is not None:
        rows.append(_compared(scenes, results))
    named = ", ".join(first.sensors), ", ".join(first.outputs)
    return [
        f"same sensors: {named[0]}; same outputs: {named[1]}",
        "",
        *_aligned(rows),
        "",
        *(line for note in _notes(scenes) for line in textwrap.wrap(note, 100)),
    ]


def _aligned(rows: Sequence[Row]) -> list[str]:
    label = max(len(row[0]) for row in rows)
    widths = [max(WIDTH, *(len(row[n]) for row in rows)) for n in range(1, len(rows[0]))]
    return [
        "  ".join(
            [f"{row[0]:{label}}", *(f"{c:>{w}}" for c, w in zip(row[1:], widths, strict=True))]
        ).rstrip()
        for row in rows
    ]


def _printed_networks(scene: Scene) -> str:
    hidden = thesis_table(scene.reference).get("hidden", [])
    inputs = len(scene.sensors)
    return ", ".join(f"{inputs + n}:{nodes}:1" for n, nodes in enumerate(hidden)) or NONE


def _around(scene: Scene) -> str:
    has = [("scan", scene.front_end), ("profile", scene.visualisation)]
    return ", ".join(name for name, section in has if section) or NONE


def _errors(scenes: Sequence[Scene]) -> list[Row]:
    """The bit-true errors in percent, beside those of the simulation in the thesis."""
    first = scenes[0]
    printed = thesis_figures(first.reference, len(first.outputs), first.path)
    head = f"{'mean':>5} {'largest':>8} {'held out':>9}"
    rows: list[Row] = [("error in %", "largest", *(head for _ in scenes))]
    found = [scene_errors(scene)["bit-true"] for scene in scenes]
    held_out = [held_out_means(scene) for scene in scenes]
    for n, name in enumerate(first.outputs):
        cells = []
        for errors, means in zip(found, held_out, strict=True):
            last = f"{means[n]:.2f}" if means else NONE
            cells.append(f"{errors[n].mean:5.2f} {errors[n].largest_mean:8.2f} {last:>9}")
        rows.append((f"  {name}", f"{printed[n]:.2f}", *cells))
    return rows


def _clocks(scenes: Sequence[Scene], results: Mapping[str, dict[str, Any]] | None) -> list[Row]:
    """The clocks of a frame and from one frame to the next, also in microseconds."""
    frames, behind, between = [], [], []
    for scene in scenes:
        design = scene.twin()
        clocks, interval = clocks_per_frame(design), design.interval
        if results is not None:
            facts = next(iter(results[scene.name]["facts"].values()))
            clocks, interval = facts["clocks_per_frame"], facts["interval"]
        frames.append(f"{clocks:,}")
        behind.append(f"{design.output_clocks[-1]:,}")
        between.append(f"{interval:,} ({interval / scene.clock_mhz:.2f} us)")
    board = thesis_table("board")
    scan = 1 << board["scan_counter_bits"]
    return [
        ("clocks a frame", NONE, *frames),
        ("  after its last sample", NONE, *behind),
        ("clocks between frames", f"{scan:,} ({scan / board['clock_mhz']:.2f} us)", *between),
    ]


def _cells(scenes: Sequence[Scene]) -> list[Row]:
    """The recorded cells of the scene and its networks, and their share of the thesis' device."""
    device, printed = thesis_table("device"), thesis_table(scenes[0].reference)
    rows: list[Row] = []
    cells = [read_budget(scene.path)[FAMILY] for scene in scenes]
    tops = [(scene.twin(), scene.twin().core) for scene in scenes]
    for kind in KINDS:
        share, count = SHARES.get(kind, ("", ""))
        of = device[count] if count else 0
        thesis = NONE
        if share in printed:
            thesis = f"about {printed[share] * of / 100:,.0f} ({printed[share]} %)"
        whole = [_share(c[top.entity][kind], of) for c, (top, _) in zip(cells, tops, strict=True)]
        rows.append((f"{kind}s", thesis, *whole))
        if kind in SHARES:
            inner = [c[core.entity][kind] for c, (_, core) in zip(cells, tops, strict=True)]
            rows.append(("  of these, networks", NONE, *(_share(n, of) for n in inner)))
    return rows


def _share(count: int, of: int) -> str:
    return f"{count:,} ({100 * count / of:.0f} %)" if of else f"{count:,}"


def _compared(scenes: Sequence[Scene], results: Mapping[str, dict[str, Any]]) -> Row:
    """What both simulators compared with the twins, which shows that the thesis is reproduced."""
    cells = []
    for scene in scenes:
        found = results[scene.name]
        verdict = f"{found['failed']} benches red" if found["failed"] else "none differ"
        cells.append(f"{found['compared']:,}, {verdict}")
    return ("values compared", NONE, *cells)


def _notes(scenes: Sequence[Scene]) -> list[str]:
    """The notes that say what the figures refer to."""
    device = thesis_table("device")["name"]
    again = "frames held back before the networks were trained again on all"
    held_out = [f"for {s.name} {again if s.training.refit else 'the test frames'}" for s in scenes]
    measured = thesis_table(scenes[0].reference).get("real_time", [])
    said = ", ".join(f"{one:.2f}" for one in measured)
    real_time = f"; with real sensors {said} %" if measured else ""
    notes = [
        "error: bit-true, on all recorded frames. largest is the largest of the mean errors at "
        "each position. held out is the mean on frames that the networks had not seen: "
        + ", ".join(held_out)
        + f". The errors of the thesis are those of its simulation (Table 5.4){real_time}.",
        "cells: Virtex-II, entity by entity, as make synth recorded them with Yosys, without "
        f"inverters; in brackets in percent of an {device}. The thesis prints percentages of its "
        "placed design only (Table 5.3), and does not say whether they include the profile.",
    ]
    bare = [scene for scene in scenes if not (scene.front_end or scene.visualisation)]
    whole = load_scene(WHOLE)
    for scene in bare:
        if _weights(scene) == _weights(whole):
            notes.append(_with_all_around(scene, whole))
    return notes


def _weights(scene: Scene) -> list[Path]:
    return [path.resolve() for path in scene.weights_paths]


def _with_all_around(scene: Scene, whole: Scene) -> str:
    cells = read_budget(whole.path)[FAMILY][whole.twin().entity]
    counts = ", ".join(f"{cells[kind]:,} {kind}s" for kind in KINDS)
    return f"Scene {whole.name} is {scene.name} with scan and profile: {counts}."
