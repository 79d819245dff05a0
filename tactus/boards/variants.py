"""``python -m tactus.boards.variants SCENE BOARD``: show what each option of a scene costs on a
board.

The scene is built without some of its options, and also with the multiplier that it does not
choose.
"""

import argparse
import tempfile
from dataclasses import asdict, replace
from pathlib import Path

from tactus.boards import Board, load_board
from tactus.boards.bitstream import Report, build, sources
from tactus.core.cli import run_repeatable, stop_if_dry_run
from tactus.core.files import read_json, write_json
from tactus.core.progress import Progress
from tactus.export.exporter import export
from tactus.scene import Scene, load_scene


def variants(scene: Scene) -> dict[str, Scene]:
    """The variants, by names that say how the engine multiplies and what stands beside it."""
    kinds = {"one multiplier": 1, "no multiplier": 0}
    found = {}
    for name, lanes in kinds.items():
        options = {"lanes": lanes}
        bare = replace(scene, design_options=options, visualisation=None)
        found[name] = bare
        found[f"{name}, profile"] = replace(bare, visualisation=scene.visualisation)
        if lanes:
            loaded = {**options, **scene.design_options}
            found[f"{name}, reload"] = replace(bare, design_options=loaded)
    return found | {"as it is": scene}


def variants_path(scene: Scene, board: Board) -> Path:
    """Where the variants are recorded."""
    return scene.path.with_suffix(f".{board.name}.variants.json")


def read_variants(path: Path) -> dict[str, tuple[Report, int]]:
    """By name: nextpnr's report, and the clocks from the last bit of a scan to the last output."""
    return read_json(
        path,
        "recorded variants",
        make=lambda record: {
            name: (Report(**one["report"]), one["clocks"]) for name, one in record.items()
        },
    )


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tactus.boards.variants", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("board")
    parser.add_argument("--record", action="store_true", help="write them beside the scene")
    arguments = parser.parse_args()
    scene, board = load_scene(arguments.scene), load_board(arguments.board)
    wanted = variants(scene)
    stop_if_dry_run(f"place {len(wanted)} variants of scene {scene.name} on {board.title}")
    found = {}
    with Progress(f"{scene.name} on {board.title}", len(wanted), "variants") as progress:
        for name, variant in wanted.items():
            design = variant.twin()
            with tempfile.TemporaryDirectory() as folder:
                verilog = Path(folder) / "verilog"
                export(variant, "verilog", verilog)
                _, report = build(verilog, sources(variant, design, board), board)
            found[name] = {"report": asdict(report), "clocks": design.output_clocks[-1]}
            counted = ", ".join(f"{used} {kind}" for kind, used in report.used.items())
            progress.say(f"{name}: {counted}; {report.clock_mhz:g} MHz")
            progress.step(name)
    if arguments.record:
        path = variants_path(scene, board)
        write_json(path, found)
        print(f"wrote {path}")


if __name__ == "__main__":
    run_repeatable("tactus.boards.variants", main)
