"""What every shipped scene leaves out, in blocks, cells, clocks and words of memory."""

from golden.activation.bipartite import Bipartite
from golden.activation.bipartite_pair import BipartitePair
from golden.activation.lut import Lut
from golden.activation.precise import Precise
from golden.activation.rom import Rom
from golden.common.block import Block, walk
from golden.engine.program_memory import ProgramMemory
from golden.engine.program_ram import ProgramRam
from golden.networks.engine import Engine
from tactus.report.measure.networks import clocks_per_frame
from tactus.report.measure.table import Cell, Table
from tactus.scene import Scene, load_scene, scene_names
from tactus.synth import budget
from tactus.synth.cells import KINDS
from tactus.synth.lean import FAMILY, Lean, read_lean

WHOLE, LEAN = "whole", "as it is"


def words(block: Block) -> int:
    """The words of all programs and tables in a block, counted as often as they are built."""
    return _words(block) + sum(map(words, block.parts()))


def _words(part: Block) -> int:
    if isinstance(part, Engine) and part.alone:
        return part.program.rows + len(part.program.words)
    if isinstance(part, ProgramRam):
        return 1 << part.addr_width
    if isinstance(part, ProgramMemory | Rom | Lut):
        return len(part.words)
    if isinstance(part, Precise):
        return part.words
    if isinstance(part, BipartitePair):
        return _words(part.activation)
    if isinstance(part, Bipartite):
        return len(part.bases) + len(part.corrections)
    return 0


def recorded_cells(scene: Scene) -> Lean | None:
    """The record that ``make lean RECORD=1`` made for a scene, or None if there is none."""
    return read_lean(scene.path) if budget.is_recorded(scene.path, budget.LEAN) else None


def left_out(_: int) -> Table:
    """Every shipped scene with every segment, node and bit, and with only what it needs."""
    rows: list[list[Cell]] = []
    for name in sorted(scene_names()):
        scene = load_scene(name)
        whole, lean = scene.twin(lean=False), scene.twin()
        found = recorded_cells(scene)
        cells: list[Cell] = []
        for kind in KINDS:
            cells += [None, None] if found is None else [found.whole[kind], found.lean[kind]]
        rows.append(
            [
                name,
                scene.design,
                len({part.block for part in walk(lean)}),
                *cells,
                clocks_per_frame(whole),
                clocks_per_frame(lean),
                words(whole),
                words(lean),
            ]
        )
    kinds = [*KINDS, "clocks a frame", "words"]
    return Table(
        "left_out",
        ["scene", "design", "blocks", *(f"{k}, {how}" for k in kinds for how in (WHOLE, LEAN))],
        rows,
        f"'{WHOLE}' has every segment of every activation, every hidden node and every bit of a "
        f"sum. '{LEAN}' is what the hardware of the scene holds. The cells are those of Yosys, "
        f"synth_xilinx -family {FAMILY}, as make lean RECORD=1 recorded them. The words are those "
        "of programs, and of the tables of activations and of exp.",
    )
