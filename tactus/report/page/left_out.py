"""What leaving out saves, for the headline and a table of docs/left-out.md and a picture."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from golden.networks.engine import Engine
from golden.numbers.real import Real
from tactus.report.measure.left_out import LEAN, WHOLE, words
from tactus.report.measure.networks import clocks_per_frame
from tactus.report.measure.table import Table, number, rows_of
from tactus.scene import load_scene

SCENE = "digit"
# The networks of the default scene in the thesis' form, and one with the first output alone.
FORM, ONE_OUTPUT = "digit-thesis", "digit-load"
PRUNED = (0.1, 0.25, 0.5)


def kept(scenes: Table) -> dict[str, tuple[float, float]]:
    """How much of the whole is built, by kind, for a picture of the page's headline."""
    (row,) = rows_of(scenes, scene=FORM)
    one, every = (clocks_per_frame(load_scene(name).twin()) for name in (ONE_OUTPUT, SCENE))
    return {
        "LUTs": (number(row, f"LUT, {LEAN}"), number(row, f"LUT, {WHOLE}")),
        "words of ROM": (number(row, f"words, {LEAN}"), number(row, f"words, {WHOLE}")),
        "clocks for load": (one, every),
    }


def headline(scenes: Table) -> str:
    """How much of the whole is built, in a sentence."""
    luts, rom, clocks = (f"{part:,.0f} of {whole:,.0f}" for part, whole in kept(scenes).values())
    return (
        f"**Built as in the thesis, `{FORM}` takes {luts} LUTs and {rom} words of ROM. Asked for "
        f"the load alone, `{SCENE}` takes {clocks} clocks.**"
    )


def program_rows() -> str:
    """Words and clocks of the program of the default scene, and of programs that need less."""
    scene = load_scene(SCENE)
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
    lines = [_row(["scene `digit` with", "words", "clocks"]), "|---|---|---|"]
    for name, these in programs.items():
        engine = Engine.of(these, scene.settings(True, these), scene.arrangement)
        lines.append(_row([name, str(words(engine)), str(clocks_per_frame(engine))]))
    return "\n".join(lines)


def _pruned(weights: Real, part: float) -> Real:
    return np.where(np.abs(weights) < np.quantile(np.abs(weights), part), 0.0, weights)


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"
