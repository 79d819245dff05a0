"""What all designs compute, and a row of the table: cells in one piece, errors against floats."""

import json
import shutil
import tempfile
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from golden.networks.constants import Constants, constants_of
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.trained.dense import DenseNetwork, tanh
from tactus.report.measure.table import Cell
from tactus.scene import Scene
from tactus.synth.cells import SYNTHESISE, count, script_of
from tactus.synth.tools import run_tool

# The scene whose weights have 18 bits, and one whose weights have few signed digits.
MAIN = "comparison/digit-fast-full"
FEW = "digit-fast"
RANDOM_FRAMES = 2000
# The headings of the columns, and the family and the kind of cells that stand below them.
COLUMNS = {
    "LUT4": ("xc2v", "LUT"),
    "LUT6": ("xc7", "LUT"),
    "flip-flop": ("xc2v", "flip-flop"),
    "MULT18": ("xc2v", "multiplier"),
    "RAMB16": ("xc2v", "block RAM"),
}
# The parameters of a module are known only where it is used, so reading it is deferred until then.
SCRIPT = "read_verilog -defer *.v; {}; tee -q -o stat.json stat -json"


@dataclass(frozen=True)
class Task:
    """The task that all designs compute.

    scene: Network and frames come from it.
    mlp: The network in floating point.
    constants: The codes of its weights and biases, which are the same for all designs.
    recorded, random, shape (frames, inputs): The codes of the samples.
    """

    scene: Scene
    mlp: DenseNetwork
    constants: Constants
    recorded: Codes
    random: Codes

    @property
    def name(self) -> str:
        return self.scene.name

    @property
    def frames(self) -> Codes:
        """The recorded frames, then the random ones."""
        return np.concatenate([self.recorded, self.random])

    def errors(self, outputs: Codes) -> tuple[float, float]:
        """The mean magnitude of errors in units of 2**-13, over recorded and over random frames.

        Where a result in floating point exceeds the range of codes, its end counts as right.
        """
        if outputs.shape != (len(self.frames), self.mlp.shape[-1]):
            raise ValueError(f"outputs: got shape {outputs.shape} for {len(self.frames)} frames")
        ends = SIGNAL.to_real([SIGNAL.low, SIGNAL.high])
        real = np.clip(self.mlp.process(SIGNAL.to_real(self.frames), tanh), *ends)
        errors = np.abs(SIGNAL.to_real(outputs) - real) * (1 << SIGNAL.frac)
        cut = len(self.recorded)
        return float(errors[:cut].mean()), float(errors[cut:].mean())


def task_of(scene: Scene, seed: int) -> Task:
    """The one network of a scene, its recorded frames, and random frames of any code."""
    (mlp,) = scene.mlps()
    rng = np.random.default_rng(seed)
    random = rng.integers(SIGNAL.low, SIGNAL.high + 1, (RANDOM_FRAMES, mlp.shape[0]))
    return Task(scene, mlp, constants_of(mlp, scene.settings()), scene.vectors().codes, random)


def row(
    network: str,
    design: str,
    verilog: Path,
    top: str,
    clocks: tuple[int, int],
    errors: tuple[float, float] | None,
    right: float | None = None,
) -> dict[str, Cell]:
    """One design; errors and percentages have the digits that the page shows.

    verilog: A folder with ``.v`` and ``.mem`` files, whose module ``top`` is the design.
    clocks: From the last sample of a frame to its last output, and from one frame to the next.
    errors: See ``Task.errors``; None for a network that tells classes apart.
    right: Of such a network, how many of the rows held out from its training are decided rightly,
        in percent.
    """
    cells = {family: _counted(verilog, top, family) for family in SYNTHESISE}
    recorded, random = (round(error, 2) for error in errors) if errors else (None, None)
    return {
        "network": network,
        "design": design,
        **{column: cells[family][kind] for column, (family, kind) in COLUMNS.items()},
        "clocks": clocks[0],
        "a frame every": clocks[1],
        "recorded": recorded,
        "random": random,
        "right %": None if right is None else round(right, 2),
    }


def _counted(verilog: Path, top: str, family: str) -> dict[str, int]:
    """The cells of a design in one piece, with the same script for all projects."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file in (*verilog.glob("*.v"), *verilog.glob("*.mem")):
            shutil.copy(file, folder)
        flat = script_of(family, folder).replace("synth_xilinx", "synth_xilinx -flatten")
        script = SCRIPT.format(flat.format(family=family, top=top))
        run_tool("yosys", ["-q", "-p", script], folder)
        stat = json.loads((folder / "stat.json").read_text(encoding="utf-8"))["modules"]
    (cells,) = (module["num_cells_by_type"] for module in stat.values())
    return count(Counter(cells))
