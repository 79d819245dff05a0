"""Our designs with the same weights: those that take a whole frame per clock, and the engine."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from golden.decisions import decisions_of, held_out_or_all
from golden.networks.design import Design
from golden.networks.designs import DESIGNS
from golden.networks.settings import Settings
from golden.scene import Scene, load_scene
from hdl.export.elaborate import elaborate
from hdl.export.hierarchy import convert_hierarchy
from tb.peers.cells import in_one_piece
from tb.peers.comparison import WINE, Row, Task

VERSION = "tactus"
# This design is compared with a peer that folds a network onto few multipliers.
FOLDED = "engine"
# The scene of a network for classes whose data others have trained networks for too.
CLASSES = "wine-fast"


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


def rows(_: Path, tasks: Mapping[str, Task], _folder: Path) -> Iterator[Row]:
    """The rows of our designs of every task, and of the network for classes.

    Raises
    ------
    InputError
        When Yosys fails.
    """
    for task in tasks.values():
        for name, design in designs(load_scene(task.scene), task):
            yield row(task.scene, name, design, errors=task.errors(design.process(task.frames)))
    scene = load_scene(CLASSES)
    (network,) = scene.networks()
    held_out, _rows = held_out_or_all(scene, decisions_of(scene))
    right = 100 * held_out.right / len(held_out.actual)
    # No argmax, because the peers' rows have none.
    yield row(WINE, f"{scene.design}, {scene.describe()}", scene.build(network), right=right)


def row(network: str, name: str, design: Design, **measured: Any) -> Row:
    """The row of a design in one piece; ``measured`` is ``errors`` or ``right``.

    Raises
    ------
    InputError
        When Yosys fails.
    """
    with tempfile.TemporaryDirectory() as folder:
        convert_hierarchy(elaborate(design), Path(folder), "verilog")
        cells = in_one_piece(Path(folder), design.entity)
    clocks = design.output_clocks[-1]
    return Row(network, f"our {name}", cells, clocks, design.interval, **measured)
