"""Records beside a shipped scene which resources of a board it takes."""

from dataclasses import asdict
from pathlib import Path

from tactus.boards import Board
from tactus.boards.bitstream import WRAPPER, Report, Sources
from tactus.core.files import read_json, write_json
from tactus.core.fingerprint import fingerprint
from tactus.scene import Scene
from tactus.synth.tools import digest


def record_path(scene: Scene, board: Board) -> Path:
    """Where the record stands."""
    return scene.path.with_suffix(f".{board.name}.json")


def state(verilog: Path, made: Sources) -> str:
    """A digest of the sources of a bitstream: code, wrapper and pins."""
    names = [file.name for file in verilog.glob("*.v") if file.name != WRAPPER]
    return fingerprint([], digest(verilog, names), made.verilog, made.pins)


def write_record(path: Path, report: Report, verilog: Path, made: Sources) -> None:
    """Record a report, and a digest of the sources that it belongs to."""
    write_json(path, {"made of": state(verilog, made), "report": asdict(report)})


def read_record(path: Path) -> tuple[Report, str]:
    """The recorded report, and the digest of its sources."""
    return read_json(
        path,
        "a recorded bitstream; RECORD=1 records it",
        make=lambda record: (Report(**record["report"]), record["made of"]),
    )
