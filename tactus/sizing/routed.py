"""Estimates what a design takes of an ECP5, and the clock that it reaches there.

An ECP5 has LUTs of four inputs too, and its tools put registers into multipliers and memories. So
each kind of design has its own ratio to the cells of a Virtex-II, and its own slowest path;
``routed.csv`` holds those that were placed and routed.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from golden.input_error import InputError
from tactus.core.table import read_csv_file
from tactus.sizing.model import Size, held_out, recorded

# Designs that have a register after some adders.
GRAPHS = ("adder_graph", "table_graph")
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

    network, design: As in ``tactus.sizing.model.Recorded``.
    path: See ``path_of``.
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

    spread: See ``spread_of``.
    clock_mhz: None where it is unknown; see ``clock_of``.
    """

    size: Size
    spread: float | None
    clock_mhz: float | None


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
    return count if design in GRAPHS and isinstance(count, int) else 0


def routed_size(design: str, options: Mapping[str, object], size: Size) -> Routed | None:
    """The estimate for a network whose cells on a Virtex-II are estimated."""
    rows = [row for row in placed() if row.design == design]
    if not rows:
        return None
    known = virtex()
    flip_flops = np.median([row.flip_flops / known[row.network].flip_flops for row in rows])
    found = Size(_ratio(rows) * size.luts, float(flip_flops) * size.flip_flops)
    return Routed(found, spread_of(design), clock_of(rows, path_of(design, options)))


def clock_of(rows: Sequence[Placed], path: int) -> float | None:
    """The expected clock in MHz; None where no path as short or none as long was recorded."""
    paths = [row.path for row in rows]
    return 1000 / period(rows, path) if min(paths) <= path <= max(paths) else None


def _ratio(rows: Iterable[Placed]) -> float:
    """The usual ratio of LUTs to those of a Virtex-II."""
    known = virtex()
    return float(np.median([row.luts / known[row.network].luts for row in rows]))


@cache
def spread_of(design: str) -> float | None:
    """The largest error of LUTs in per cent, where both estimates did not know the network.

    None if no network of the design can be held out.
    """
    rows = [row for row in placed() if row.design == design]
    estimated = {one.network: one.estimated for one in held_out()}
    errors = []
    for row in rows:
        others = [other for other in rows if other.network != row.network]
        if row.network in estimated and others:
            errors.append(abs(100 * (_ratio(others) * estimated[row.network] / row.luts - 1)))
    return max(errors) if errors else None


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
