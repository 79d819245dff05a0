"""Our hardware in one piece, counted as the designs of other projects beside it were."""

import json
import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from golden.input_error import MissingFileError
from golden.networks.design import Design, Settings
from golden.networks.designs import DESIGNS
from golden.networks.table_graph import TableGraph
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.trained.dense import DenseNetwork, tanh
from tactus.errors import decisions_of, held_out_or_all
from tactus.export.hierarchy import convert_hierarchy, elaborate
from tactus.report.measure.table import Cell
from tactus.scene import Scene, load_scene
from tactus.synth.cells import SYNTHESISE, count, script_of
from tactus.synth.tools import run_tool

SEED, RANDOM_FRAMES = 1, 2000
# The scene whose weights have 18 bits, one whose weights have few signed digits, and one with the
# same weights whose adders take three operands.
MAIN, FEW, THREE = "comparison/digit-fast-full", "digit-fast", "comparison/digit-fast-ternary"
# Scenes of networks for classes whose data others have trained networks for too. The data of the
# last may not be there.
CLASSES = {
    "classes/wine-fast": "wine",
    "comparison/wine-tables": "wine",
    "studies/beans/beans-tables.toml": "beans",
}
# The headings of the columns, and the family and the kind of cells that stand below them.
COLUMNS = {
    "LUT4": ("xc2v", "LUT"),
    "LUT6": ("xc7", "LUT"),
    "flip-flop": ("xc2v", "flip-flop"),
    "MULT18": ("xc2v", "multiplier"),
    "RAMB16": ("xc2v", "block RAM"),
}


def rows() -> Iterator[dict[str, Cell]]:
    """Cells, clocks and errors of each design."""
    for name, data in CLASSES.items():
        try:
            yield for_classes(load_scene(name), data)
        except MissingFileError as error:
            print(f"left out: {error}")
    for name in (MAIN, FEW):
        scene = load_scene(name)
        (mlp,) = scene.mlps()
        rng = np.random.default_rng(SEED)
        random = rng.integers(SIGNAL.low, SIGNAL.high + 1, (RANDOM_FRAMES, mlp.shape[0]))
        other, shape = DESIGNS["engine"].of([mlp], Settings(scene.precision)), ""
        if name == FEW:
            other, shape = load_scene(THREE).build(mlp), ", sums of three"
        for design, label in ((scene.build(mlp), ""), (other, shape)):
            recorded, drawn = (
                mean_error(mlp, design, frames) for frames in (scene.vectors().codes, random)
            )
            yield {**row(scene.name, design, label), "recorded": recorded, "random": drawn}


def for_classes(scene: Scene, data: str) -> dict[str, Cell]:
    """A network for classes without argmax, as those of others."""
    held_out, _ = held_out_or_all(scene, decisions_of(scene))
    (network,) = scene.networks()
    design, shape = scene.build(network), scene.describe()
    if isinstance(design, TableGraph):
        # Of learned functions the inputs, hidden sums and outputs.
        shape = f"{design.samples}:{len(design.hidden.weights)}:{design.outputs}"
    right = round(100 * held_out.right / len(held_out.actual), 2)
    return {**row(data, design, f", {shape}"), "right %": right}


def mean_error(mlp: DenseNetwork, design: Design, frames: Codes) -> float:
    """The mean magnitude of errors in units of 2**-13.

    Where a result in floating point exceeds the range of codes, its end counts as right.
    """
    ends = SIGNAL.to_real([SIGNAL.low, SIGNAL.high])
    real = np.clip(mlp.process(SIGNAL.to_real(frames), tanh), *ends)
    errors = np.abs(SIGNAL.to_real(design.process(frames)) - real) * (1 << SIGNAL.frac)
    return round(float(errors.mean()), 2)


def row(network: str, design: Design, shape: str) -> dict[str, Cell]:
    """The cells of a design in one piece, and its clocks from the last sample of a frame."""
    cells = {family: counted(design, family) for family in SYNTHESISE}
    return {
        "network": network,
        "design": f"our {design.block}{shape}",
        **{column: cells[family][kind] for column, (family, kind) in COLUMNS.items()},
        "clocks": design.output_clocks[-1],
        "a frame every": design.interval,
        "recorded": None,
        "random": None,
        "right %": None,
    }


def counted(design: Design, family: str) -> dict[str, int]:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        convert_hierarchy(elaborate(design), folder, "verilog")
        flat = script_of(family, folder).replace("synth_xilinx", "synth_xilinx -flatten")
        script = flat.format(family=family, top=design.entity)
        script = f"read_verilog -defer *.v; {script}; tee -q -o stat.json stat -json"
        run_tool("yosys", ["-q", "-p", script], folder)
        stat = json.loads((folder / "stat.json").read_text(encoding="utf-8"))["modules"]
    (cells,) = (module["num_cells_by_type"] for module in stat.values())
    return count(Counter(cells))
