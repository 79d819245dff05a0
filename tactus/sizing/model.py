"""Estimates LUTs and flip-flops of a network, from a model that is fitted to recorded syntheses.

The cells of a network are a sum of a few numbers that its twin knows (``tactus.sizing.features``),
each times a coefficient. ``cells.csv`` holds these numbers and the cells that Yosys made of the
recorded networks; the coefficients are their least squares. So a new record changes the estimates,
and no coefficient stands anywhere by itself.

An ECP5 has LUTs of four inputs as a Virtex-II has, and its tools put registers into multipliers and
memories. So each kind of design has its own ratio to the cells of a Virtex-II, and its own slowest
path, from the networks that were placed and routed.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from statistics import median

import numpy as np

from golden.input_error import InputError
from golden.numbers.real import Real
from tactus.core.table import read_csv_file
from tactus.sizing.features import FLIP_FLOPS, LUTS

# Designs that have a register after some adders.
GRAPHS = ("adder_graph", "table_graph")
CELLS = Path(__file__).with_name("cells.csv")
COLUMNS = (
    *("network", "weights", "design", "path", "luts", "flip_flops"),
    *("ecp5_luts", "ecp5_flip_flops", "ecp5_mhz", "features"),
)


@dataclass(frozen=True)
class Size:
    """Cells, and the clock where it is known."""

    luts: float
    flip_flops: float
    clock_mhz: float | None = None


@dataclass(frozen=True)
class Recorded:
    """The cells of a network that was synthesised.

    network: The scene, or the scene and the design that was made of its networks.
    weights: The first file of the network's weights; networks that share it are held out together.
    design: The design as ``tactus.sizing.candidates`` names it.
    path: See ``path_of``.
    size: Of a Virtex-II.
    routed: Of an ECP5; None where the network was not placed and routed.
    """

    network: str
    weights: str
    design: str
    path: int
    size: Size
    routed: Size | None
    features: Mapping[str, int]


@cache
def recorded() -> tuple[Recorded, ...]:
    read = read_csv_file(CELLS)
    if tuple(read.names) != COLUMNS:
        raise InputError(f"{CELLS}: got columns {read.names}, expected {COLUMNS}")
    found = []
    for network, weights, design, path, luts, flip_flops, *placed, features in read.rows:
        size = Size(int(luts), int(flip_flops))
        routed = Size(*map(float, placed)) if all(placed) else None
        pairs = (pair.split("=") for pair in features.split())
        numbers = {name: int(number) for name, number in pairs}
        found.append(Recorded(network, weights, design, int(path), size, routed, numbers))
    return tuple(found)


@cache
def model(without: str = "") -> tuple[Real, Real]:
    """The coefficients of LUTs and of flip-flops that fit the recorded networks.

    They are least squares of the relative errors over different networks. Networks with the weights
    ``without`` are left out.
    """
    rows = [row for row in recorded() if row.weights != without]
    return (
        _least({(_numbers(row.features, LUTS), row.size.luts) for row in rows}),
        _least({(_numbers(row.features, FLIP_FLOPS), row.size.flip_flops) for row in rows}),
    )


def _numbers(features: Mapping[str, int], names: Sequence[str]) -> tuple[int, ...]:
    return tuple(features.get(name, 0) for name in names)


def _least(found: set[tuple[tuple[int, ...], float]]) -> Real:
    ordered = sorted(found)
    given = np.array([np.array(numbers) / cells for numbers, cells in ordered])
    coefficients: Real = np.linalg.lstsq(given, np.ones(len(ordered)), rcond=None)[0]
    return coefficients


def size_of(features: Mapping[str, int], without: str = "") -> Size:
    """The estimated cells of a network with these features."""
    pairs = zip((LUTS, FLIP_FLOPS), model(without), strict=True)
    return Size(*(float(np.dot(_numbers(features, names), each)) for names, each in pairs))


@dataclass(frozen=True)
class Held:
    """A recorded network, and what the model says of it that was fitted to all others."""

    recorded: Recorded
    estimated: Size

    @property
    def percent(self) -> float:
        return 100 * (self.estimated.luts / self.recorded.size.luts - 1)


@cache
def held_out() -> tuple[Held, ...]:
    """Every recorded network, estimated by a model that knows no network with its weights.

    A network is left out if it has something of which the others know nothing.
    """
    found = []
    for row in sorted(recorded(), key=lambda row: row.weights):
        others = (other for other in recorded() if other.weights != row.weights)
        if row.features.keys() <= {name for other in others for name in other.features}:
            found.append(Held(row, size_of(row.features, without=row.weights)))
    return tuple(found)


def spread(design: str) -> float | None:
    """The largest error of an estimate of LUTs in per cent, over networks that were held out.

    None if no network of the design can be held out.
    """
    held = (abs(one.percent) for one in held_out() if one.recorded.design == design)
    return max(held, default=None)


def placed(design: str) -> list[Recorded]:
    return [row for row in recorded() if row.design == design and row.routed]


def path_of(design: str, options: Mapping[str, object]) -> int:
    """What the longest path of a design depends on: adders in series, or registers at memories."""
    if design.startswith("engine"):
        return int(options.get("pipeline") == "deep")
    count = options.get("adders_per_clock")
    return count if design.startswith(GRAPHS) and isinstance(count, int) else 0


def routed_size(design: str, path: int, size: Size) -> Size:
    """The estimate on an ECP5 for a network whose cells on a Virtex-II are estimated."""
    rows = placed(design)
    luts, flip_flops = (ratio(rows, cell) for cell in ("luts", "flip_flops"))
    return Size(size.luts * luts, size.flip_flops * flip_flops, clock_of(rows, path))


def ratio(rows: Iterable[Recorded], cell: str) -> float:
    """The usual ratio of a kind of cells to those of a Virtex-II."""
    return median(getattr(row.routed, cell) / getattr(row.size, cell) for row in rows)


def routed_spread(design: str) -> float | None:
    """As ``spread`` on an ECP5, where both estimates did not know the network."""
    errors = []
    for one in held_out():
        row, others = one.recorded, [r for r in placed(design) if r != one.recorded]
        if row.design == design and row.routed and others:
            luts = ratio(others, "luts") * one.estimated.luts
            errors.append(abs(100 * (luts / row.routed.luts - 1)))
    return max(errors, default=None)


def clock_of(rows: Iterable[Recorded], path: int) -> float | None:
    """The expected clock in MHz; None where no path as short or none as long was recorded.

    Its period is a start, and a part for each step of the path.
    """
    known = [(row.path, row.routed.clock_mhz) for row in rows if row.routed]
    paths, clocks = map(np.array, zip(*known, strict=True))
    if not paths.min() <= path <= paths.max():
        return None
    steps = np.stack([np.ones(len(paths)), paths], axis=1)
    start, each = np.linalg.lstsq(steps, 1000 / clocks, rcond=None)[0]
    return float(1000 / (start + each * path))
