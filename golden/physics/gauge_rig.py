"""A beam that gauges are to be placed on: the TOML file of ``make sensors``."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from golden.files import check_file, reading
from golden.input_error import InputError, MissingFileError
from golden.physics.beam import Beam
from golden.physics.strain_sensor import Loads
from golden.real import Real
from golden.table import refuse_unknown, suggest

FOLDER = Path(__file__).parent / "rigs"
OUTPUTS = ("load", "position", "width")
OBJECTIVES = ("mean", "worst")
SHAPES = {"rectangle": False, "triangle": True}
MOST_GAUGES, MOST_WIDTHS = 32, 16

# Positions along the range of the load, for each width, shape and load.
POSITIONS = 25

# Section, key: the least and the largest number, or what else it is.
_POSITIVE = (1e-6, 1e6)
KEYS: dict[str, dict[str, Any]] = {
    "beam": {
        "length_mm": _POSITIVE,
        "width_mm": _POSITIVE,
        "thickness_mm": (1e-3, 1e3),
        "elastic_modulus_gpa": (1e-6, 1e4),
    },
    "gauges": {
        "count": "whole",
        "from_mm": (0, 1e6),
        "to_mm": (0, 1e6),
        "apart_mm": (0.1, 1e6),
        "full_scale_v": _POSITIVE,
        "noise_v": (0, 1e6),
        "noise_strain": (0, 1),
        "compare_mm": "numbers",
    },
    "load_cell": {"full_scale_v": _POSITIVE, "noise_v": _POSITIVE},
    "loads": {
        "load_g": "range",
        "position_mm": "range",
        "edge_mm": (0, 1e6),
        "width_mm": "numbers",
        "shapes": tuple(SHAPES),
    },
    "errors": {"outputs": OUTPUTS, "length_mm": "lengths", "objective": "objective"},
}
OPTIONAL = {("load_cell",), ("gauges", "compare_mm")}


@dataclass(frozen=True)
class GaugeRig:
    """What ``make sensors`` is asked.

    Attributes
    ----------
    name : str
    beam : golden.physics.beam.Beam
    count : int
        Gauges to place.
    span : tuple of float
        m from the root, where a gauge may sit.
    apart : float
        m, least distance of two.
    full_scale, noise : float
        V; see the file.
    noise_strain : float
    compare : tuple of float
        m from the root; none where there is nothing to compare with.
    cell_noise : float
        Of a sensor that reads the load alone, as a part of what the heaviest load reads; infinite
        where there is none.
    masses : tuple of float
        kg, the least and the largest.
    placements : Loads
        Every placement over which errors are taken.
    known : tuple of bool
        Whether load, position and width are known beforehand: those of one value.
    spreads : float array, shape (3,)
        Standard deviation of mass, position and half-width over the placements, in SI units.
    percent : float array, shape (placements, 3)
        Error in percent for one SI unit of mass, position and half-width.
    outputs : tuple of str
        Whose errors count.
    objective : str
        "mean" or "worst".
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
    """Read a rig by its name, or by a path that ends in ``.toml``.

    Raises
    ------
    InputError
        For an unknown rig, or a file that cannot be read.
        For a fault in the file; the message names file, key, what was got and what was expected.
    """
    known = sorted(path.stem for path in FOLDER.glob("*.toml"))
    path = FOLDER / f"{name}.toml" if name in known else Path(name)
    if path.suffix != ".toml":
        raise MissingFileError(
            f"RIG={name}: no such rig, expected a path to a .toml file or one of "
            f"{', '.join(known)}{suggest(name, known)}"
        )
    check_file(path)
    with reading(path, "TOML"):
        raw = tomllib.loads(path.read_text(encoding="utf-8"))
    return _rig(_checked(raw, path), path)


def _rig(values: dict[str, dict[str, Any]], path: Path) -> GaugeRig:
    beam, gauges, loads, errors = (values[s] for s in ("beam", "gauges", "loads", "errors"))
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
    """Both ends of the loads, at every width and shape, all along what is left of the beam."""
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


def _checked(raw: dict[str, Any], path: Path) -> dict[str, dict[str, Any]]:
    """Every section with every key, of its type and within its range."""
    refuse_unknown(raw, KEYS, f"{path}: section")
    values: dict[str, dict[str, Any]] = {}
    for section, keys in KEYS.items():
        if section not in raw:
            if (section,) in OPTIONAL:
                continue
            raise InputError(f"{path}: {section}: missing, expected a section")
        given = raw[section]
        if not isinstance(given, dict):
            raise InputError(f"{path}: {section}: got {given!r}, expected a section")
        refuse_unknown(given, keys, f"{path}: {section}: key")
        values[section] = {}
        for key, kind in keys.items():
            if key not in given and (section, key) in OPTIONAL:
                values[section][key] = []
                continue
            expected = _expected(kind)
            if key not in given:
                raise InputError(f"{path}: {section}.{key}: missing, expected {expected}")
            if not _is(given[key], kind):
                raise InputError(
                    f"{path}: {section}.{key}: got {given[key]!r}, expected {expected}"
                )
            values[section][key] = given[key]
    lengths, outputs = values["errors"]["length_mm"], values["errors"]["outputs"]
    for name in outputs:
        if name != "load" and name not in lengths:
            raise InputError(
                f"{path}: errors.length_mm.{name}: missing, expected what 100 % of {name} is"
            )
    return values


def _number(value: Any, low: float = -1e6, high: float = 1e6) -> bool:
    return type(value) in (int, float) and low <= value <= high


def _is(value: Any, kind: Any) -> bool:
    if kind == "whole":
        return type(value) is int and 1 <= value <= MOST_GAUGES
    if kind == "objective":
        return value in OBJECTIVES
    if kind == "lengths":
        return isinstance(value, dict) and all(
            name in OUTPUTS[1:] and _number(size, *_POSITIVE) for name, size in value.items()
        )
    if isinstance(kind, tuple) and not isinstance(kind[0], str):
        return _number(value, *kind)
    if not isinstance(value, list) or not 1 <= len(value) <= max(MOST_GAUGES, MOST_WIDTHS):
        return False
    if isinstance(kind, tuple):
        return all(name in kind for name in value) and len(set(value)) == len(value)
    numbers = all(_number(number) for number in value)
    return numbers and (kind == "numbers" or (len(value) == 2 and value[0] <= value[1]))


def _expected(kind: Any) -> str:
    if isinstance(kind, tuple):
        return (
            f"a list of {', '.join(kind)}"
            if isinstance(kind[0], str)
            else f"a number, {kind[0]:g} to {kind[1]:g}"
        )
    said = {
        "whole": f"a whole number, 1 to {MOST_GAUGES}",
        "numbers": "a list of numbers",
        "range": "the least and the largest, such as [6.0, 23.0]",
        "lengths": "{ position = , width = } in mm",
        "objective": " or ".join(OBJECTIVES),
    }
    text: str = said[kind]
    return text
