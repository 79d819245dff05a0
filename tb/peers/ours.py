"""Our designs with the same weights: those that take a whole frame per clock, and the engine."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

from golden.networks.design import Design
from golden.networks.designs import DESIGNS
from golden.networks.settings import Settings
from golden.scene import Scene
from hdl.export.elaborate import elaborate
from hdl.export.hierarchy import convert_hierarchy
from hdl.synth.cells import synthesise
from tb.peers.cells import FAMILY, in_one_piece
from tb.peers.comparison import Row, Task

# This design is compared with a peer that folds a network onto few multipliers.
FOLDED = "engine"


def designs(scene: Scene, task: Task) -> Iterator[tuple[str, Design]]:
    """Each design whose stream is words, and then the engine.

    A design has the scene's activation, or comes with each of those that it knows.
    """
    words = [name for name, design in DESIGNS.items() if design.stream == "words"]
    for name in (*words, FOLDED):
        design = DESIGNS[name]
        fits = "single" in design.arrangements
        if fits and scene.precision.name in design.precisions:
            for activation in design.known_activations or (scene.activation,):
                made = design.of([task.mlp], Settings(scene.precision, activation))
                yield f"{name}, {activation}", made


def rows(name: str, design: Design, task: Task) -> list[Row]:
    """The rows of a design as it is exported, with a module for each entity, and in one piece.

    Raises
    ------
    InputError
        When Yosys fails.
    """
    errors = task.errors(design.process(task.frames))
    with tempfile.TemporaryDirectory() as folder:
        verilog = Path(folder)
        convert_hierarchy(elaborate(design), verilog, "verilog")
        parts = synthesise(verilog, design.entity, FAMILY)[design.entity]
        whole = in_one_piece(verilog, design.entity)
    clocks = design.output_clocks[-1]
    return [
        Row(f"{name}, as exported", parts, clocks, design.interval, errors),
        Row(f"{name}, in one piece", whole, clocks, design.interval, errors),
    ]
