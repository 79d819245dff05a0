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

import numpy as np

from golden.input_error import InputError
from golden.numbers.real import Real
from tactus.core.table import read_csv_file
from tactus.sizing.features import FLIP_FLOPS, LUTS

# Designs that have a register after some adders.
GRAPHS = ("adder_graph", "table_graph")
CELLS = Path(__file__).with_name("cells.csv")
COLUMNS: tuple[str, ...] = (
    "network",
    "weights",
    "design",
    "path",
    "luts",
    "flip_flops",
    "ecp5_luts",
    "ecp5_flip_flops",
    "ecp5_mhz",
    "features",
)


@dataclass(frozen=True)
class Size:
    luts: float
    flip_flops: float


@dataclass(frozen=True)
class Routed:
    """Cells of an ECP5 and the clock there, which is None where no such path was recorded."""

    size: Size
    clock_mhz: float | None


@dataclass(frozen=True)
class Recorded:
    """The cells of a network that was synthesised.

    network: The scene, or the scene and the design that was made of its networks.
    weights: The first file of the network's weights; networks that share it are held out together.
    design: The design as ``tactus.sizing.candidates`` names it.
    path: See ``path_of``.
    size: Of a Virtex-II.
    routed: None where the network was not placed and routed.
    """

    network: str
    weights: str
    design: str
    path: int
    size: Size
    routed: Routed | None
    features: Mapping[str, int]


# The coefficients of LUTs, and those of flip-flops.
Model = tuple[Real, Real]


@cache
def recorded() -> tuple[Recorded, ...]:
    read = read_csv_file(CELLS)
    if tuple(read.names) != COLUMNS:
        raise InputError(f"{CELLS}: got columns {read.names}, expected {COLUMNS}")
    found = []
    for network, weights, design, path, luts, flip_flops, *placed, features in read.rows:
        size = Size(int(luts), int(flip_flops))
        routed = Routed(Size(*map(int, placed[:2])), float(placed[2])) if all(placed) else None
        pairs = (pair.split("=") for pair in features.split())
        numbers = {name: int(number) for name, number in pairs}
        found.append(Recorded(network, weights, design, int(path), size, routed, numbers))
    return tuple(found)


def fitted(rows: Iterable[Recorded]) -> Model:
    """The coefficients, by least squares of the relative errors over different networks."""
    known = list(rows)
    return (
        _least({(_numbers(row.features, LUTS), row.size.luts) for row in known}),
        _least({(_numbers(row.features, FLIP_FLOPS), row.size.flip_flops) for row in known}),
    )


def _numbers(features: Mapping[str, int], names: Sequence[str]) -> tuple[int, ...]:
    return tuple(features.get(name, 0) for name in names)


def _least(found: set[tuple[tuple[int, ...], float]]) -> Real:
    ordered = sorted(found)
    given = np.array([np.array(numbers) / cells for numbers, cells in ordered])
    coefficients: Real = np.linalg.lstsq(given, np.ones(len(ordered)), rcond=None)[0]
    return coefficients


@cache
def model() -> Model:
    """The coefficients that fit all rows of ``cells.csv``."""
    return fitted(recorded())


def size_of(features: Mapping[str, int], known: Model | None = None) -> Size:
    """The estimated cells of a network with these features."""
    pairs = zip((LUTS, FLIP_FLOPS), known or model(), strict=True)
    return Size(*(float(np.dot(_numbers(features, names), each)) for names, each in pairs))


@dataclass(frozen=True)
class Held:
    """A recorded network, and what the model says of it that was fitted to all others."""

    network: str
    design: str
    recorded: Size
    estimated: Size

    @property
    def percent(self) -> float:
        return 100 * (self.estimated.luts / self.recorded.luts - 1)


@cache
def held_out() -> tuple[Held, ...]:
    """Every recorded network, estimated by a model that knows no network with its weights.

    A network is left out if it has something of which the others know nothing.
    """
    found = []
    for weights in sorted({row.weights for row in recorded()}):
        others = [row for row in recorded() if row.weights != weights]
        known, met = fitted(others), {name for row in others for name in row.features}
        found += [
            Held(row.network, row.design, row.size, size_of(row.features, known))
            for row in recorded()
            if row.weights == weights and row.features.keys() <= met
        ]
    return tuple(found)


def spread(design: str) -> float | None:
    """The largest error of an estimate of LUTs in per cent, over networks that were held out.

    None if no network of the design can be held out.
    """
    return max((abs(one.percent) for one in held_out() if one.design == design), default=None)


def placed(design: str) -> list[Recorded]:
    return [row for row in recorded() if row.design == design and row.routed]


def path_of(design: str, options: Mapping[str, object]) -> int:
    """What the longest path of a design depends on: adders in series, or registers at memories."""
    if design.startswith("engine"):
        return int(options.get("pipeline") == "deep")
    count = options.get("adders_per_clock")
    return count if design.startswith(GRAPHS) and isinstance(count, int) else 0


def routed_size(design: str, path: int, size: Size) -> Routed | None:
    """The estimate on an ECP5 for a network whose cells on a Virtex-II are estimated.

    None where no network of the design was placed and routed.
    """
    rows = placed(design)
    if not rows:
        return None
    found = Size(size.luts * ratio(rows, "luts"), size.flip_flops * ratio(rows, "flip_flops"))
    return Routed(found, clock_of(rows, path))


def ratio(rows: Iterable[Recorded], cell: str) -> float:
    """The usual ratio of a kind of cells to those of a Virtex-II."""
    pairs = ((row.routed.size, row.size) for row in rows if row.routed)
    return float(np.median([getattr(here, cell) / getattr(there, cell) for here, there in pairs]))


def routed_spread(design: str) -> float | None:
    """As ``spread`` on an ECP5, where both estimates did not know the network."""
    rows = placed(design)
    estimated = {one.network: one.estimated.luts for one in held_out()}
    errors = []
    for row in rows:
        others = [other for other in rows if other.network != row.network]
        if row.network in estimated and others and row.routed:
            found = ratio(others, "luts") * estimated[row.network]
            errors.append(abs(100 * (found / row.routed.size.luts - 1)))
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
