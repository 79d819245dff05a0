"""The costs of scenes, from the figures that ``make synth`` recorded."""

from dataclasses import dataclass
from typing import Any

from golden.networks.network import Network
from tactus.core.folders import BUILD
from tactus.report.measure.table import Cell, Table
from tactus.scene import Scene
from tactus.synth.budget import TIMING, Cells, by_block, is_recorded, read_budget, shares
from tactus.synth.cells import DEPTH, FAMILIES, KINDS
from tactus.synth.timing import Timing, read_timing
from tactus.synth.tools import digest
from tactus.verify.benches.runner import export


@dataclass(frozen=True)
class Costs:
    """The recorded costs of one scene.

    share: See ``shares``.
    frames_per_second: The rate at the clock that was reached.
    current: Whether the record belongs to the Verilog that the scene exports now.
    """

    cells: Cells
    timing: Timing
    share: dict[str, Any]
    frames_per_second: float
    current: bool


def costs(scene: Scene, design: Network) -> Costs | None:
    """The recorded costs of a scene, or None if there are none."""
    if not is_recorded(scene.path) or not is_recorded(scene.path, TIMING):
        return None
    cells = read_budget(scene.path)
    timing, verilog = read_timing(scene.path)
    export(scene, "verilog")
    return Costs(
        cells,
        timing,
        shares(scene, design, cells),
        1e6 * timing.clock_mhz / design.interval,
        verilog == digest(BUILD / scene.name / "verilog"),
    )


def blocks(scene: Scene, design: Network, found: Costs) -> Table:
    """The cells of every block of the scene."""
    columns = [*KINDS, DEPTH]
    rows: list[list[Cell]] = [
        [family, name, count, *(cells[column] for column in columns)]
        for family in FAMILIES
        for name, count, cells in by_block(design, found.cells, family)
    ]
    meaning = "; ".join(f"{family} is {text}" for family, text in FAMILIES.items())
    return Table(
        "blocks",
        ["family", "largest entity", "entities", *columns],
        rows,
        f"For each block of scene {scene.name}, the entity with the most LUTs, with everything "
        f"that it contains, and the number of entities. Yosys counted the cells and kept the "
        f"hierarchy; {meaning}.",
    )
