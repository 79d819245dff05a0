"""The section ``[visualisation]`` of a scene: which outputs are drawn, and where."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from golden.finding import Finding, fault, refuse
from golden.input_error import InputError
from golden.scene.scale import AUTO
from golden.table import suggest
from golden.visualisation.load_profile import SHAPE_THRESHOLD, LoadProfile, load_profile, width_gain

RESULTS = ("load", "position", "width", "shape")

# Key, type, default; see ``golden.scene``.
KEYS: dict[str, tuple[Any, Any]] = {
    **{name: (str, name) for name in RESULTS},
    "start": (float, 0.0),
    "stop": (float, 0.8),
    "step": (float, 0.05),
    "shape_threshold": (float, SHAPE_THRESHOLD),
    "analogue": (str, ""),
}
# How a profile leaves for an oscilloscope, beside its codes.
ANALOGUE = ("pulse_density",)


@dataclass(frozen=True)
class Visualisation:
    """What a scene says of its profile.

    Attributes
    ----------
    load_profile : LoadProfile
    results : tuple of int
        Which outputs of the scene are load, position, width and shape.
    analogue : str
        One of ``ANALOGUE``, or nothing.
    """

    load_profile: LoadProfile
    results: tuple[int, int, int, int]
    analogue: str = ""


def visualisation(values: dict[str, Any], data: dict[str, Any], path: Path) -> Visualisation:
    """The section's values, types checked and defaults filled in, as blocks.

    Parameters
    ----------
    values : dict
        The keys of ``KEYS``.
    data : dict
        The checked section ``[data]``; the lengths of position and width set C.
    path : Path
        The scene's file, for messages.

    Raises
    ------
    InputError
        For an output that the scene has not, that is named twice or that has a scale, an output
        whose length in millimetres is not known, a ramp or a threshold outside the format, or a C
        too large.
    """
    outputs = data["outputs"]
    scaled = outputs if data["scale"] == AUTO else data["scale"]
    names = [values[key] for key in RESULTS]
    found: list[Finding] = []
    for key, name in zip(RESULTS, names, strict=True):
        place = f"{path}: visualisation.{key}: got {name!r}"
        if name not in outputs:
            known = f"{', '.join(outputs)}{suggest(name, outputs)}"
            found.append(fault(f"{place}, expected one of the outputs {known}"))
        elif name in scaled:
            text = "which has a data.scale, expected an output that has none: the profile is drawn"
            found.append(fault(f"{place}, {text} from signals"))
        elif names.count(name) > 1 and names.index(name) == RESULTS.index(key):
            found.append(fault(f"{place}, expected four different outputs"))
    threshold = values["shape_threshold"]
    if not -1 <= threshold < 1:
        text = f"got {threshold!r}, expected -1 to below 1"
        found.append(fault(f"{path}: visualisation.shape_threshold: {text}"))
    units = []
    for key in ("position", "width"):
        name = values[key]
        if name in data["length_mm"]:
            length, scale = (Fraction(str(data[k][name])) for k in ("length_mm", "full_scale"))
            units.append(length / scale)
        elif name in outputs:
            text = f"expected that of the output which is the {key} of the visualisation"
            found.append(fault(f"{path}: data.length_mm: got none of {name!r}, {text}"))
    refuse(found)
    ramp = {key: values[key] for key in ("start", "stop", "step")}
    try:
        profile = load_profile(gain=width_gain(*units), shape_threshold=threshold, **ramp)
    except InputError as error:
        raise InputError(f"{path}: visualisation: {error}") from None
    first, second, third, fourth = (outputs.index(name) for name in names)
    return Visualisation(profile, (first, second, third, fourth), values["analogue"])
