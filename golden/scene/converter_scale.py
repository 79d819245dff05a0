"""The scale of the sensors that a converter reads: it follows from the converter's data sheet.

A part has fixed codes, and the hardware turns each into one signal. So what a reading is as a
signal depends on the unit of the readings alone. There are three: signals of -1 to 1, the part's
own codes, and any unit in which the scene tells what the part's reference is. Straight binary
reaches from 0 to the reference, two's complement from minus to plus the reference.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from golden.input_error import InputError
from golden.real import Real
from golden.scene.scale import AUTO, Scale
from golden.scene.vectors import MOST_OUTSIDE, read_recorded
from golden.sensing.converter_parts import PARTS, STRAIGHT, ConverterPart

if TYPE_CHECKING:
    from golden.scene.scene import Scene

SIGNALS = Scale()


def part_scale(part: ConverterPart, reference: float = 0.0) -> Scale:
    """What the signals of a part's codes stand for.

    Parameters
    ----------
    part : ConverterPart
    reference : float
        What its reference is in the unit of the readings; 0 for readings that are its codes.
    """
    straight = part.coding == STRAIGHT
    whole = reference or float(1 << (part.bits if straight else part.bits - 1))
    return Scale(whole / 2, whole / 2) if straight else Scale(0.0, whole)


def converter_scales(scene: Scene) -> dict[str, Scale]:
    """The scale of each sensor that the scene's converter sets.

    Empty for a scene without a converter, and for readings that are signals.

    Raises
    ------
    MissingFileError
        See ``read_recorded``.
    InputError
        When a scale that the scene writes is not the converter's, or when the readings are neither
        signals nor codes of it.
    """
    front_end = scene.front_end
    if front_end is None or not front_end.converter:
        return {}
    part = PARTS[front_end.converter]
    written = {name: scene.scale[name] for name in scene.sensors if name in scene.scale}
    given = {name: scale for name, scale in written.items() if isinstance(scale, Scale)}
    if front_end.reference:
        expected = part_scale(part, front_end.reference)
        why = f"converter {part.name!r} with front_end.reference {front_end.reference:g}"
    else:
        # Where every sensor has a right scale, means of codes need not be told from other units.
        codes = len(given) == len(scene.sensors) and set(given.values()) == {part_scale(part)}
        expected, why = _unit(scene, part, AUTO if AUTO in written.values() else "none", codes)
    for name, scale in given.items():
        if scale != expected:
            raise InputError(
                f"{scene.path}: data.scale.{name}: got {_text(scale)}, expected "
                f"{_text(expected)} for each sensor, or none: {why}"
            )
    return {} if expected == SIGNALS else dict.fromkeys(scene.sensors, expected)


def codes_of(scene: Scene, readings: Real) -> Real:
    """Readings in codes as the scene's converter gives them: whole numbers that it has."""
    ends = [(s.offset - s.factor, s.offset + s.factor - 1) for s in scene.scales(scene.sensors)]
    low, high = np.array(ends).T
    return np.clip(np.rint(readings), low, high)


def _unit(scene: Scene, part: ConverterPart, got: str, codes: bool) -> tuple[Scale, str]:
    """The scale of readings whose unit the scene does not name, and why it is that.

    ``codes`` tells that the scene says them to be codes, which means of codes are not seen to be.
    """
    other = (
        "; readings in another unit, such as volts, take front_end.reference, which is what the "
        "reference of the converter is in that unit"
    )
    readings = np.concatenate([one.sensors for one in read_recorded(scene).recordings])
    outside = np.abs(readings) > 1
    scale = part_scale(part)
    low, high = scale.offset - scale.factor, scale.offset + scale.factor - 1
    within = low <= readings.min() and readings.max() <= high
    text = f"the codes {low:.0f} to {high:.0f} of converter {part.name!r}"
    whole = np.array_equal(readings, readings.round())
    if outside.any() and within and (codes or whole):
        return scale, f"the readings are {text}{other}"
    # Some outliers make signals of no other unit.
    if (outside.mean(axis=0) <= MOST_OUTSIDE).all():
        return SIGNALS, f"the readings are signals of -1 to 1{other}"
    means = f"; means of codes take {_text(scale)} for each sensor" if within else ""
    raise InputError(
        f"{scene.path}: data.scale: got {got} for readings of {readings.min():g} to "
        f"{readings.max():g} in {scene.data_text}, expected signals of -1 to 1, or {text}, whole "
        f"numbers{means}{other}"
    )


def _text(scale: Scale) -> str:
    return f"{{ offset = {scale.offset:.12g}, factor = {scale.factor:.12g} }}"
