"""The section ``[visualisation]`` of a scene, which says what is drawn, and where."""

from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from golden.input_error import InputError, suggest
from golden.visualisation.load_profile import SHAPE_THRESHOLD, LoadProfile, load_profile, width_gain
from tactus.core.finding import Finding, fault, refuse
from tactus.core.schema import Key, KeyTable, Number, Span, Text
from tactus.scene.scale import AUTO

RESULTS = ("load", "position", "width", "shape")

# The forms in which a profile can leave for an oscilloscope, besides its codes.
ANALOGUE = ("pulse_density",)
VISUALISATION = KeyTable(
    {
        **{
            name: Key(Text(), name, f"Which output is the {name}. The four outputs must differ.")
            for name in RESULTS
        },
        "start": Key(Number(), 0.0, "The first position of the ramp. It must be -1 or more."),
        "stop": Key(
            Number(),
            0.8,
            "The last position of the ramp. It must lie a whole number of steps above `start`, and "
            "below 1.",
        ),
        "step": Key(
            Number(),
            0.05,
            "The distance of two positions. It must be larger than half an LSB, 2^-14, and the "
            "ramp can have 1023 points at most.",
        ),
        "shape_threshold": Key(
            Number(Span(-1, below=1)),
            SHAPE_THRESHOLD,
            "A load whose shape is above this value is drawn as a triangle, any other as a "
            "rectangle.",
        ),
        "analogue": Key(
            Text(ANALOGUE),
            "",
            "How the profile leaves for an oscilloscope. `pulse_density` adds two bits, `dac_x` "
            "and `dac_y`, whose density of ones gives the point of the profile. Each bit needs a "
            "low pass in front of the x-y input ([uart_instrument](blocks/uart_instrument.md)). It "
            "needs a section [uart](#uart).",
        ),
    },
    name="a section",
)


@dataclass(frozen=True)
class Visualisation:
    """The profile that a scene describes.

    results: Indices of the scene's outputs that are load, position, width and shape.
    analogue: One of ``ANALOGUE``, or empty.
    """

    load_profile: LoadProfile
    results: tuple[int, int, int, int]
    analogue: str = ""


def visualisation(scene: dict[str, Any], path: Path) -> Visualisation | None:
    """The profile, if the scene has that section. Lengths of position and width determine C."""
    if "visualisation" not in scene:
        return None
    values, data = scene["visualisation"], scene["data"]
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
        elif (first := RESULTS[names.index(name)]) != key:
            text = f"which is visualisation.{first} too, expected four different outputs"
            found.append(fault(f"{place}, {text}"))
    units = []
    for key in ("position", "width"):
        name = values[key]
        if name in data["length_mm"]:
            length, scale = (Fraction(str(data[k][name])) for k in ("length_mm", "full_scale"))
            units.append(length / scale)
        elif name in outputs:
            text = f"expected the length of the output that is the {key} of the visualisation"
            found.append(fault(f"{path}: data.length_mm: {name!r} is missing, {text}"))
    refuse(found)
    drawn = {key: values[key] for key in ("start", "stop", "step", "shape_threshold")}
    try:
        profile = load_profile(gain=width_gain(*units), **drawn)
    except InputError as error:
        raise InputError(f"{path}: visualisation: {error}") from None
    first, second, third, fourth = (outputs.index(name) for name in names)
    return Visualisation(profile, (first, second, third, fourth), values["analogue"])
