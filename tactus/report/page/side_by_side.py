"""The table that compares the default scenes with each other and with the printed thesis.

The scenes have the same sensors and outputs. The table shows what the thesis built, that it is
reproduced here, and what the same task takes today. The cells are those that ``make synth``
recorded, so nothing is synthesised for the table.
"""

import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

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

# The cells of a column by the labels of the rows.
Column = dict[str, str]


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
    found = [_built(scene, results[scene.name] if results else None) for scene in scenes]
    columns = [_printed(first), *found]
    widths = [max(WIDTH, *map(len, column.values())) for column in columns]
    lines = [
        f"{label:{max(map(len, found[0]))}}  "
        + "  ".join(f"{c.get(label, NONE):>{w}}" for c, w in zip(columns, widths, strict=True))
        for label in found[0]
    ]
    return [
        f"same sensors: {', '.join(first.sensors)}; same outputs: {', '.join(first.outputs)}",
        "",
        *lines,
        "",
        *(line for note in _notes(scenes) for line in textwrap.wrap(note, 100)),
    ]


def _printed(scene: Scene) -> Column:
    """What the thesis prints of the networks that a scene has as reference."""
    printed, device = thesis_table(scene.reference), thesis_table("device")
    board, count = thesis_table("board"), len(scene.sensors)
    scan = 1 << board["scan_counter_bits"]
    hidden = printed.get("hidden", [])
    errors = thesis_figures(scene.reference, len(scene.outputs), scene.path)
    cells = {
        f"{kind}s": f"about {printed[share] * device[of] / 100:,.0f} ({printed[share]} %)"
        for kind, (share, of) in SHARES.items()
        if share in printed
    }
    return {
        "": "thesis, as printed",
        "networks": ", ".join(f"{count + n}:{nodes}:1" for n, nodes in enumerate(hidden)) or NONE,
        "arithmetic": "14 bits",
        "activation": "gradient",
        "folded as": "hybrid",
        "around them": "scan, profile",
        "error in %": "largest",
        **{f"  {name}": f"{error:.2f}" for name, error in zip(scene.outputs, errors, strict=True)},
        "clocks between frames": f"{scan:,} ({scan / board['clock_mhz']:.2f} us)",
        **cells,
    }


def _built(scene: Scene, results: dict[str, Any] | None) -> Column:
    """What a scene is, its bit-true errors, its clocks, and its recorded cells."""
    design, held_out = scene.twin(), held_out_means(scene)
    around = [("scan", scene.front_end), ("profile", scene.visualisation)]
    clocks, interval = clocks_per_frame(design), design.interval
    if results:
        facts = next(iter(results["facts"].values()))
        clocks, interval = facts["clocks_per_frame"], facts.get("interval", design.interval)
    found = {
        "": f"scene {scene.name}",
        "networks": scene.describe(),
        "arithmetic": f"{scene.precision.coeff_width} bits, {scene.precision.name}",
        "activation": scene.activation_text,
        "folded as": scene.design,
        "around them": ", ".join(name for name, section in around if section) or NONE,
        "error in %": f"{'mean':>5} {'largest':>8} {'held out':>9}",
    }
    for n, (name, error) in enumerate(
        zip(scene.outputs, scene_errors(scene)["bit-true"], strict=True)
    ):
        last = f"{held_out[n]:.2f}" if held_out else NONE
        found[f"  {name}"] = f"{error.mean:5.2f} {error.largest_mean:8.2f} {last:>9}"
    found["clocks a frame"] = f"{clocks:,}"
    found["  after its last element"] = f"{design.output_clocks[-1]:,}"
    found["clocks between frames"] = f"{interval:,} ({interval / scene.clock_mhz:.2f} us)"
    cells, device = read_budget(scene.path)[FAMILY], thesis_table("device")
    for kind in KINDS:
        of = device[SHARES[kind][1]] if kind in SHARES else 0
        found[f"{kind}s"] = _share(cells[design.entity][kind], of)
        if of:
            found[f"  {kind}s of networks"] = _share(cells[design.core.entity][kind], of)
    if results:
        verdict = f"{results['failed']} benches red" if results["failed"] else "none differ"
        found["values compared"] = f"{results['compared']:,}, {verdict}"
    return found


def _share(count: int, of: int) -> str:
    """Cells, and their share of the thesis' device."""
    return f"{count:,} ({100 * count / of:.0f} %)" if of else f"{count:,}"


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
