"""``make bitstream``: makes a file with which a board is programmed.

``build/<scene>/bitstream/<board>`` gets the bitstream, the Verilog and the pins file that it was
made of, and ``bitstream.json`` with the resources that it takes, the versions of the tools and a
digest. The same tools give the same bytes on every run. A design that does not fit, or whose clock
is not met, is an error.
"""

import hashlib
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path

from golden.networks.network import Network
from tactus.boards import Board, load_board
from tactus.boards.bitstream import (
    FAMILIES,
    Report,
    Sources,
    build,
    record_path,
    sources,
    write_record,
)
from tactus.core.cli import stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.files import replace_folder, write_json
from tactus.core.progress import Progress
from tactus.export.exporter import export
from tactus.scene import load_scene


def main() -> None:
    arguments = arguments_of("bitstream", __doc__)
    scene = load_scene(arguments.scene)
    board = load_board(arguments.board, arguments.device or "")
    design = scene.twin()
    made = sources(scene, design, board)
    own = board.device == board.devices[0]
    place = board.name if own else f"{board.name}-{board.device}"
    folder = arguments.build / scene.name / "bitstream" / place
    name = f"{scene.name}{FAMILIES[board.family].suffix}"
    stop_if_dry_run(f"synthesise, place and route scene {scene.name} and write {folder / name}")
    with (
        replace_folder(folder) as temporary,
        Progress(f"{scene.name} on {board.title}", 2, "steps", alike=False) as progress,
    ):
        verilog = temporary / "verilog"
        with progress.running("export"):
            export(scene, "verilog", verilog)
        progress.step()
        bitstream, report = build(verilog, made, board, progress.running)
        progress.step("synthesised, placed, routed and packed")
        (temporary / name).write_bytes(bitstream)
        (temporary / FAMILIES[board.family].pins_name).write_text(made.pins, encoding="utf-8")
        facts = {
            "scene": scene.name,
            "board": board.name,
            "device": board.device,
            "sha256": hashlib.sha256(bitstream).hexdigest(),
            "versions": {tool: version(tool) for tool in FAMILIES[board.family].packages},
            "report": asdict(report),
        }
        write_json(temporary / "bitstream.json", facts)
        if arguments.record:
            write_record(record_path(scene, board), report, verilog, made)
    tell(design, board, made, report, folder / name)
    if arguments.record:
        print(f"wrote {record_path(scene, board)}")


def tell(design: Network, board: Board, made: Sources, report: Report, file: Path) -> None:
    """Print which resources the design takes, and how the board is programmed."""
    print(f"\n{design.entity} on {board.title}, {board.device}")
    for name, used in report.used.items():
        available = report.available[name]
        print(f"{name:14}{used:7} of {available:6}  {100 * used / available:5.1f} %")
    source = f"by a PLL from {board.clock_mhz:g} MHz" if made.pll else "the oscillator"
    print(f"clock: {report.needed_mhz:g} MHz, {source}; {report.clock_mhz:g} MHz would do")
    clocks = design.output_clocks[-1]
    print(f"{clocks / report.needed_mhz:.2f} us from the last bit of a scan to the last output")
    print(f"\nwrote {file}")
    if board.load:
        print(f"until the supply is cut:  {board.load} {file}")
    print(f"for good:                 {board.flash} {file}")
