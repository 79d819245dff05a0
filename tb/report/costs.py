"""What scenes cost, from the figures that ``make synth`` recorded beside them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from golden.activation.schemes import SCHEMES
from golden.block import walk
from golden.figures.networks import scenes
from golden.figures.table import Cell, Table
from golden.networks.network import Network
from golden.scene import Scene
from hdl.common.lookup import latency
from hdl.synth.__main__ import by_block
from hdl.synth.budget import Cells, budget_path, read_budget
from hdl.synth.cells import DEPTH, FAMILIES
from hdl.synth.netlist import KINDS
from hdl.synth.shares import shares
from hdl.synth.timing import Timing, read_timing, timing_path
from hdl.synth.tools import digest
from tb.common.runner import BUILD, export

FAMILY = "xc2v"


@dataclass(frozen=True)
class Costs:
    """What was recorded for one scene.

    Attributes
    ----------
    cells : Cells
    timing : Timing
    share : dict
        See ``shares``.
    latency_us, frames_per_second : float
        At the clock that was reached.
    current : bool
        Whether it was recorded for the Verilog that the scene exports now.
    """

    cells: Cells
    timing: Timing
    share: dict[str, Any]
    latency_us: float
    frames_per_second: float
    current: bool


def costs(scene: Scene, design: Network) -> Costs | None:
    """The recorded costs of a scene; None where none are recorded."""
    if not budget_path(scene.path).is_file() or not timing_path(scene.path).is_file():
        return None
    cells = read_budget(budget_path(scene.path))
    timing, verilog = read_timing(timing_path(scene.path))
    export(scene, "verilog")
    return Costs(
        cells,
        timing,
        shares(scene, design, cells),
        latency(design) / timing.clock_mhz,
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
        f"Of each block of scene {scene.name} the entity with the most LUTs, with all that it "
        f"contains, and how many entities there are. Yosys, hierarchy kept; {meaning}.",
    )


def activation_cells() -> dict[tuple[str, str], dict[str, int]]:
    """Virtex-II cells of the largest entity of every activation, by block and precision."""
    found: dict[tuple[str, str], dict[str, int]] = {}
    for scene in scenes():
        path = budget_path(scene.path)
        if not path.is_file():
            continue
        cells = read_budget(path)[FAMILY]
        for part in walk(scene.design()):
            key = part.block, scene.precision.name
            if part.block in SCHEMES and part.entity in cells:
                found[key] = max(found.get(key), cells[part.entity], key=_luts)
    return found


def _luts(cells: dict[str, int] | None) -> int:
    return cells["LUT"] if cells else -1


def network_cells() -> dict[str, dict[str, int]]:
    """Virtex-II cells of the whole of every scene that has a record."""
    return {
        scene.name: read_budget(budget_path(scene.path))[FAMILY][scene.design().entity]
        for scene in scenes()
        if budget_path(scene.path).is_file()
    }
