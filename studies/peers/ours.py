"""Our designs: those that take a frame in every clock, and the engine, which folds a network."""

import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from golden.input_error import MissingFileError
from golden.networks.design import Design, Settings
from golden.networks.designs import DESIGNS
from golden.networks.table_graph import TableGraph
from studies.peers.cells import in_one_piece
from studies.peers.comparison import BEANS, FEW, WINE, Row, Task
from tactus.errors import decisions_of, held_out_or_all
from tactus.export.hierarchy import convert_hierarchy, elaborate
from tactus.scene import Scene, load_scene

# This design is compared with a peer that folds a network onto few multipliers.
FOLDED = "engine"
# The scene with the weights of ``FEW``, whose adders take three operands.
THREE = "comparison/digit-fast-ternary"
# The data of this scene may not be there.
BEANS_SCENE = "studies/beans/beans-tables.toml"
# Scenes of networks for classes whose data others have trained networks for too.
CLASSES = {
    "classes/wine-fast": WINE,
    "comparison/wine-tables": WINE,
    BEANS_SCENE: BEANS,
}


def download(folder: Path) -> Path:
    """Nothing is needed but this project."""
    return folder


def designs(task: Task) -> Iterator[tuple[Design, str]]:
    """The designs of a task, each with what its name says behind the block.

    They are the design of the task's scene, and with few digits the one with sums of three, or else
    the engine with the same weights.
    """
    yield task.scene.build(task.mlp), ""
    if task.name == FEW:
        yield load_scene(THREE).build(task.mlp), ", sums of three"
    else:
        yield DESIGNS[FOLDED].of([task.mlp], Settings(task.scene.precision)), ""


def rows(_: Path, tasks: Mapping[str, Task], _folder: Path) -> Iterator[Row]:
    """The rows of the networks for classes, and of our designs of every task."""
    for name, network in CLASSES.items():
        try:
            scene = load_scene(name)
        except MissingFileError as error:
            print(f"left out: {error}")
            continue
        held_out, _rows = held_out_or_all(scene, decisions_of(scene))
        right = 100 * held_out.right / len(held_out.actual)
        design, shape = for_classes(scene)
        yield row(network, design, f", {shape}", right=right)
    for task in tasks.values():
        for design, sums in designs(task):
            errors = task.errors(design.process(task.frames))
            yield row(task.name, design, sums, errors=errors)


def for_classes(scene: Scene) -> tuple[Design, str]:
    """The design of a scene without argmax, which the peers' rows have not, and its shape.

    The shape of learned functions is their inputs, hidden sums and outputs, as in the peers' rows.
    """
    (network,) = scene.networks()
    design = scene.build(network)
    if isinstance(design, TableGraph):
        return design, f"{design.samples}:{len(design.hidden.weights)}:{design.outputs}"
    return design, scene.describe()


def row(network: str, design: Design, shape: str = "", **measured: Any) -> Row:
    """The row of a design in one piece; ``measured`` is ``errors`` or ``right``."""
    with tempfile.TemporaryDirectory() as folder:
        convert_hierarchy(elaborate(design), Path(folder), "verilog")
        cells = in_one_piece(Path(folder), design.entity)
    clocks = design.output_clocks[-1]
    return Row(network, f"our {design.block}{shape}", cells, clocks, design.interval, **measured)
