"""Our hardware and alkaid's for the same weights, counted by one tool.

alkaid comes into an environment of its own below ``build/peers``. Where it cannot be had, its rows
are left out, and the reason is printed.
"""

import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from golden.input_error import InputError, MissingFileError
from golden.networks.design import Design, Settings
from golden.networks.designs import DESIGNS
from golden.networks.table_graph import TableGraph
from studies.peers import alkaid
from studies.peers.task import FEW, MAIN, Task, row, task_of
from tactus.core.folders import BUILD
from tactus.errors import decisions_of, held_out_or_all
from tactus.export.hierarchy import convert_hierarchy, elaborate
from tactus.report.measure.table import Cell
from tactus.scene import Scene, load_scene

SEED = 1
# The scene with the weights of ``FEW``, whose adders take three operands.
THREE = "comparison/digit-fast-ternary"
# Scenes of networks for classes whose data others have trained networks for too. The data of the
# last may not be there.
CLASSES = {
    "classes/wine-fast": "wine",
    "comparison/wine-tables": "wine",
    "studies/beans/beans-tables.toml": "beans",
}


def rows() -> Iterator[dict[str, Cell]]:
    """Cells, clocks and errors of each design."""
    tasks = [task_of(load_scene(name), SEED) for name in (MAIN, FEW)]
    yield from for_classes()
    for task in tasks:
        for design, sums in designs(task):
            yield our_row(task.name, design, sums, errors=task.errors(design.process(task.frames)))
    folder = BUILD / "peers" / "verilog"
    shutil.rmtree(folder, ignore_errors=True)
    try:
        python = alkaid.installed(BUILD / "peers" / "alkaid")
    except InputError as error:
        print(f"alkaid is left out: {error}")
        return
    for task in tasks:
        yield from alkaid.rows(python, task, folder / task.name)


def for_classes() -> Iterator[dict[str, Cell]]:
    """The rows of the networks for classes, whose designs have no argmax, as those of peers."""
    for name, data in CLASSES.items():
        try:
            scene = load_scene(name)
        except MissingFileError as error:
            print(f"left out: {error}")
            continue
        held_out, _rows = held_out_or_all(scene, decisions_of(scene))
        right = 100 * held_out.right / len(held_out.actual)
        (network,) = scene.networks()
        design = scene.build(network)
        yield our_row(data, design, f", {shape_of(scene, design)}", right=right)


def shape_of(scene: Scene, design: Design) -> str:
    """Of learned functions the inputs, hidden sums and outputs, as in the rows of peers."""
    if isinstance(design, TableGraph):
        return f"{design.samples}:{len(design.hidden.weights)}:{design.outputs}"
    return scene.describe()


def designs(task: Task) -> Iterator[tuple[Design, str]]:
    """The designs of a task, each with what its name says behind the block.

    They are the design of the task's scene, and with few digits the one with sums of three, or else
    the engine with the same weights.
    """
    yield task.scene.build(task.mlp), ""
    if task.name == FEW:
        yield load_scene(THREE).build(task.mlp), ", sums of three"
    else:
        yield DESIGNS["engine"].of([task.mlp], Settings(task.scene.precision)), ""


def our_row(
    network: str,
    design: Design,
    shape: str,
    errors: tuple[float, float] | None = None,
    right: float | None = None,
) -> dict[str, Cell]:
    with tempfile.TemporaryDirectory() as name:
        convert_hierarchy(elaborate(design), Path(name), "verilog")
        clocks = design.output_clocks[-1], design.interval
        label = f"our {design.block}{shape}"
        return row(network, label, Path(name), design.entity, clocks, errors, right)
