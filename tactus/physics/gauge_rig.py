"""A beam on which gauges are to be placed: the TOML file of ``make sensors``."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from golden.input_error import InputError
from golden.numbers.real import Real
from tactus.core.files import named_file
from tactus.core.schema import (
    REQUIRED,
    Key,
    KeyTable,
    Kind,
    List,
    Map,
    Number,
    Span,
    Text,
    Whole,
    read_checked,
)
from tactus.physics.beam import Beam
from tactus.physics.strain_sensor import Loads

FOLDER = Path(__file__).parent / "rigs"
OUTPUTS = ("load", "position", "width")
OBJECTIVES = ("mean", "worst")
SHAPES = {"rectangle": False, "triangle": True}
MOST_GAUGES = 32

# Number of positions along the range of the load, for each width, shape and load.
POSITIONS = 25


def _number(least: float, most: float) -> Key:
    span = Span(least, most)
    return Key(Number(span, f"a number, {span}"))


def _list(of: Kind, said: str, default: Any = REQUIRED, **counts: Any) -> Key:
    return Key(List(of, said, said, **{"most": MOST_GAUGES, **counts}), default)


def _names(known: tuple[str, ...]) -> Key:
    return _list(Text(known), f"a list of {', '.join(known)}", once=True)


_ANY = Number(Span(-1e6, 1e6))
_COUNT = Span(1, MOST_GAUGES)
_POSITIVE = _number(1e-6, 1e6)
_RANGE = _list(_ANY, "the least and the largest, such as [6.0, 23.0]", least=2, most=2, rising=True)
_LENGTHS = Map(_POSITIVE.kind, OUTPUTS[1:], "{ position = , width = } in mm")
_SECTIONS = {
    "beam": {
        "length_mm": _POSITIVE,
        "width_mm": _POSITIVE,
        "thickness_mm": _number(1e-3, 1e3),
        "elastic_modulus_gpa": _number(1e-6, 1e4),
    },
    "gauges": {
        "count": Key(Whole(_COUNT, f"a whole number, {_COUNT}")),
        "from_mm": _number(0, 1e6),
        "to_mm": _number(0, 1e6),
        "apart_mm": _number(0.1, 1e6),
        "full_scale_v": _POSITIVE,
        "noise_v": _number(0, 1e6),
        "noise_strain": _number(0, 1),
        "compare_mm": _list(_ANY, "a list of numbers", []),
    },
    "load_cell": {"full_scale_v": _POSITIVE, "noise_v": _POSITIVE},
    "loads": {
        "load_g": _RANGE,
        "position_mm": _RANGE,
        "edge_mm": _number(0, 1e6),
        "width_mm": _list(_ANY, "a list of numbers"),
        "shapes": _names(tuple(SHAPES)),
    },
    "errors": {
        "outputs": _names(OUTPUTS),
        "length_mm": Key(_LENGTHS),
        "objective": Key(Text(OBJECTIVES, said=" or ".join(OBJECTIVES))),
    },
}
OPTIONAL = ("load_cell",)
RIG = KeyTable(
    {
        section: Key(KeyTable(keys, name="a section"), None if section in OPTIONAL else REQUIRED)
        for section, keys in _SECTIONS.items()
    },
    noun="section ",
)


@dataclass(frozen=True)
class GaugeRig:
    """The question that is put to ``make sensors``.

    count: Number of gauges to place.
    span: Range in m from the root in which a gauge may be.
    apart: Least distance of two gauges in m.
    full_scale, noise: In V; see the file.
    compare: Places in m from the root to compare with; may be empty.
    cell_noise: Noise of a sensor that reads only the load, as a part of its reading for the
        heaviest load; infinite where there is no such sensor.
    masses: The least and the largest mass in kg.
    placements: All placements over which errors are computed.
    known: Whether load, position and width are known beforehand, which holds for a range of one
        value.
    spreads, shape (3,): Standard deviations of mass, position and half-width over the placements,
        in SI units.
    percent, shape (placements, 3): Error in percent for one SI unit of mass, position and
        half-width.
    outputs: The outputs whose errors count.
    objective: "mean" or "worst".
    """

    name: str
    beam: Beam
    count: int
    span: tuple[float, float]
    apart: float
    full_scale: float
    noise: float
    noise_strain: float
    compare: tuple[float, ...]
    cell_noise: float
    masses: tuple[float, float]
    placements: Loads
    known: tuple[bool, ...]
    spreads: Real
    percent: Real
    outputs: tuple[str, ...]
    objective: str


def load_rig(name: str) -> GaugeRig:
    """Read a rig by its name, or by a path that ends in ``.toml``."""
    known = {path.stem: path for path in sorted(FOLDER.glob("*.toml"))}
    path = named_file("rig", name, known, list(known))
    return _rig(read_checked(path, RIG), path)


def _rig(values: dict[str, dict[str, Any]], path: Path) -> GaugeRig:
    beam, gauges, loads, errors = (values[s] for s in ("beam", "gauges", "loads", "errors"))
    for name in errors["outputs"]:
        if name != "load" and name not in errors["length_mm"]:
            raise InputError(
                f"{path}: errors.length_mm.{name}: missing, expected what 100 % of {name} is"
            )
    length = beam["length_mm"]
    low, high = loads["position_mm"]
    widths = loads["width_mm"]
    _refuse(
        path,
        (
            gauges["from_mm"] + (gauges["count"] - 1) * gauges["apart_mm"]
            > min(gauges["to_mm"], length),
            "gauges.to_mm",
            gauges["to_mm"],
            f"room for {gauges['count']} gauges {gauges['apart_mm']:g} mm apart from "
            f"{gauges['from_mm']:g} on, on a beam of {length:g} mm",
        ),
        (
            not gauges["noise_v"] and not gauges["noise_strain"],
            "gauges.noise_v",
            gauges["noise_v"],
            "above 0, or noise_strain above 0",
        ),
        (
            any(not 0 <= place <= length for place in gauges["compare_mm"]),
            "gauges.compare_mm",
            gauges["compare_mm"],
            f"places on the beam, 0 to {length:g}",
        ),
        (
            low - max(widths) / 2 < 0
            or low > length - loads["edge_mm"] - max(widths) / 2
            or high > length - loads["edge_mm"] - min(widths) / 2 + 1e-6,
            "loads.position_mm",
            [low, high],
            f"loads {min(widths):g} to {max(widths):g} mm wide that lie between root and tip",
        ),
        (min(widths) <= 0 or loads["load_g"][0] <= 0, "loads", "0", "loads and widths above 0"),
    )
    placements = _placements(loads, length)
    ranges = np.array([np.ptp(loads["load_g"]) / 1e3, (high - low) / 1e3, np.ptp(widths) / 2e3])
    full = [errors["length_mm"].get(name, 0.0) / 1e3 for name in OUTPUTS[1:]]
    scale = np.stack(
        [placements.mass, *(np.full(len(placements.mass), f or np.inf) for f in full)], axis=-1
    )
    cell = values.get("load_cell")
    return GaugeRig(
        name=path.stem,
        beam=Beam(
            length / 1e3,
            beam["width_mm"] / 1e3,
            beam["thickness_mm"] / 1e3,
            beam["elastic_modulus_gpa"] * 1e9,
        ),
        count=gauges["count"],
        span=(gauges["from_mm"] / 1e3, min(gauges["to_mm"], length) / 1e3),
        apart=gauges["apart_mm"] / 1e3,
        full_scale=gauges["full_scale_v"],
        noise=gauges["noise_v"],
        noise_strain=gauges["noise_strain"],
        compare=tuple(sorted(place / 1e3 for place in gauges["compare_mm"])),
        cell_noise=cell["noise_v"] / cell["full_scale_v"] if cell else math.inf,
        masses=(loads["load_g"][0] / 1e3, loads["load_g"][1] / 1e3),
        placements=placements,
        known=tuple(not size for size in ranges),
        spreads=ranges / math.sqrt(12),
        percent=100 / scale * np.array([1, 1, 2]),
        outputs=tuple(errors["outputs"]),
        objective=errors["objective"],
    )


def _placements(loads: dict[str, Any], length: float) -> Loads:
    """The least and the largest load, with all widths and shapes, along the free beam."""
    low, high = loads["position_mm"]
    rows = [
        (mass / 1e3, place / 1e3, width / 2e3, SHAPES[shape])
        for mass in dict.fromkeys(loads["load_g"])
        for width in loads["width_mm"]
        for shape in loads["shapes"]
        for place in np.linspace(low, high, POSITIONS if high > low else 1)
        if place <= length - loads["edge_mm"] - width / 2
    ]
    return Loads(*np.array(rows, dtype=np.float64).T)


def _refuse(path: Path, *faults: tuple[bool, str, Any, str]) -> None:
    for fault, key, got, expected in faults:
        if fault:
            raise InputError(f"{path}: {key}: got {got!r}, expected {expected}")
