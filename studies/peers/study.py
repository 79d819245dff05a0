"""Our hardware and that of other projects for the same weights, counted by one tool.

Each project comes into a folder of its own below ``build/peers``. Where it cannot be had, its rows
are left out, and the reason is printed. A peer is a module: ``download`` brings what it needs into
a folder, and ``rows`` yields its rows.
"""

import shutil
from collections.abc import Iterator

from golden.input_error import InputError
from studies.peers import alkaid_rows, avr_rows, kanele_rows, ours, serv_rows
from studies.peers.comparison import COLUMNS, FEW, MAIN, task_of
from tactus.core.folders import BUILD
from tactus.report.measure.table import Cell
from tactus.scene import load_scene

PEERS = {
    "ours": ours,
    "alkaid": alkaid_rows,
    "kanele": kanele_rows,
    "serv": serv_rows,
    "avr": avr_rows,
}
SEED = 1


def rows() -> Iterator[dict[str, Cell]]:
    """Cells, clocks and errors of each design."""
    tasks = {name: task_of(load_scene(name), SEED) for name in (MAIN, FEW)}
    for name, peer in PEERS.items():
        folder = BUILD / "peers" / "verilog" / name
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        try:
            place = peer.brought(BUILD / "peers" / name)
        except InputError as error:
            print(f"{name} is left out: {error}")
            continue
        for row in peer.rows(place, tasks, folder):
            cells = row.cells
            yield {
                "network": row.network,
                "design": row.name,
                **{c: cells[f][kind] if cells else None for c, (f, kind) in COLUMNS.items()},
                "clocks": row.clocks,
                "a frame every": row.interval,
                "recorded": rounded(row.errors[0]),
                "random": rounded(row.errors[1]),
                "right %": rounded(row.right),
            }


def rounded(value: float | None) -> float | None:
    """As the page shows it."""
    return None if value is None else round(value, 2)
