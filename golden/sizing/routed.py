"""Estimates what a design takes of an ECP5, and the clock that it reaches there.

An ECP5 has LUTs of four inputs too, and its tools put registers into multipliers and memories. So
each kind of design has its own ratio to the cells of a Virtex-II, and its own slowest path;
``routed.csv`` holds those that were placed and routed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from golden.input_error import InputError
from golden.networks.network import Network
from golden.sizing.model import Size, recorded
from golden.table import read_csv_file

ROUTED = Path(__file__).with_name("routed.csv")
COLUMNS: tuple[str, ...] = (
    "network",
    "design",
    "path",
    "luts",
    "flip_flops",
    "multipliers",
    "block_rams",
    "clock_mhz",
)


@dataclass(frozen=True)
class Placed:
    """A network that was placed and routed.

    Attributes
    ----------
    network, design : str
        As in ``golden.sizing.model.Recorded``.
    path : int
        See ``path_of``.
    luts, flip_flops, multipliers, block_rams : int
    clock_mhz : float
    """

    network: str
    design: str
    path: int
    luts: int
    flip_flops: int
    multipliers: int
    block_rams: int
    clock_mhz: float


@dataclass(frozen=True)
class Routed:
    """An estimate.

    Attributes
    ----------
    size : Size
    spread : float
        The largest error of LUTs in per cent over the recorded networks of the design, with the
        recorded cells of a Virtex-II as given.
    clock_mhz : float
    """

    size: Size
    spread: float
    clock_mhz: float


@cache
def placed() -> tuple[Placed, ...]:
    """The rows of ``routed.csv``."""
    read = read_csv_file(ROUTED)
    if tuple(read.names) != COLUMNS:
        raise InputError(f"{ROUTED}: got columns {read.names}, expected {COLUMNS}")
    found = []
    for network, design, *numbers, clock in read.rows:
        path, luts, flip_flops, multipliers, block_rams = map(int, numbers)
        cells = luts, flip_flops, multipliers, block_rams
        found.append(Placed(network, design, path, *cells, float(clock)))
    return tuple(found)


def path_of(design: str, options: Mapping[str, object]) -> int:
    """What the longest path of a design depends on: adders in series, or registers at memories."""
    if design.startswith("engine"):
        return int(options.get("pipeline") == "deep")
    count = options.get("adders_per_clock")
    return count if design == "adder_graph" and isinstance(count, int) else 0


def routed_size(
    design: str, options: Mapping[str, object], network: Network, size: Size
) -> Routed | None:
    """The estimate for a network whose cells on a Virtex-II are known or estimated."""
    rows = [row for row in placed() if row.design == design]
    return _routed(rows, path_of(design, options), size) if rows else None


def _routed(rows: list[Placed], path: int, size: Size) -> Routed:
    known = virtex()
    luts = [row.luts / known[row.network].luts for row in rows]
    flip_flops = [row.flip_flops / known[row.network].flip_flops for row in rows]
    ratio = float(np.median(luts))
    away = max(abs(ratio / one - 1) for one in luts)
    found = Size(ratio * size.luts, float(np.median(flip_flops)) * size.flip_flops)
    return Routed(found, 100 * away, 1000 / period(rows, path))


def period(rows: Iterable[Placed], path: int) -> float:
    """The expected period of a clock in ns: a start, and a part for each step of the path."""
    steps = [(1, row.path) for row in rows]
    periods = [1000 / row.clock_mhz for row in rows]
    start, each = np.linalg.lstsq(np.array(steps), np.array(periods), rcond=None)[0]
    return float(start + each * path)


@cache
def virtex() -> dict[str, Size]:
    """The recorded cells of each network on a Virtex-II."""
    found: dict[str, Size] = {}
    for row in recorded():
        own = Size(row.luts, row.flip_flops).times(row.count)
        found[row.network] = found.get(row.network, Size(0, 0)) + own
    return found
