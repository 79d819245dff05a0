"""Our designs with the same weights: those that take a whole frame per clock, and the engine."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path

from golden.networks.design import Design
from golden.networks.designs import DESIGNS
from golden.networks.settings import Settings
from golden.scene import Scene, load_scene
from hdl.export.elaborate import elaborate
from hdl.export.hierarchy import convert_hierarchy
from tb.peers.cells import in_one_piece
from tb.peers.comparison import Row, Task

VERSION = "tactus"
# This design is compared with a peer that folds a network onto few multipliers.
FOLDED = "engine"


def brought(folder: Path) -> Path:
    """Nothing is needed but this project."""
    return folder


def designs(scene: Scene, task: Task) -> Iterator[tuple[str, Design]]:
    """Each design whose stream is words, and then the engine.

    A scene of such a design is built as that alone. A design has the scene's activation, or comes
    with each of those that it knows.
    """
    words = [name for name, design in DESIGNS.items() if design.stream == "words"]
    if scene.design in words:
        yield f"{scene.design}, {scene.activation}", scene.build(task.mlp)
        return
    for name in (*words, FOLDED):
        design = DESIGNS[name]
        fits = "single" in design.arrangements
        if fits and scene.precision.name in design.precisions:
            for activation in design.known_activations or (scene.activation,):
                made = design.of([task.mlp], Settings(scene.precision, activation))
                yield f"{name}, {activation}", made


def rows(_: Path, tasks: Mapping[str, Task], folder: Path) -> Iterator[Row]:
    """The rows of our designs of every task.

    Raises
    ------
    InputError
        When Yosys fails.
    """
    for scene, task in tasks.items():
        for name, design in designs(load_scene(scene), task):
            yield row(name, design, task)


def row(name: str, design: Design, task: Task) -> Row:
    """The row of a design in one piece.

    Raises
    ------
    InputError
        When Yosys fails.
    """
    errors = task.errors(design.process(task.frames))
    with tempfile.TemporaryDirectory() as folder:
        convert_hierarchy(elaborate(design), Path(folder), "verilog")
        cells = in_one_piece(Path(folder), design.entity)
    clocks = design.output_clocks[-1]
    return Row(task.scene, f"our {name}", cells, clocks, design.interval, errors)
