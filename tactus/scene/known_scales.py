"""The scales of a scene that its file does not write out.

The codes of a converter are fixed by its data sheet, and the hardware turns each into one signal.
So the scale from readings to signals depends only on the unit of the readings. There are three
possible units: signals of -1 to 1, the part's own codes, and any unit in which the scene states the
part's reference. Straight binary reaches from 0 to the reference, and two's complement from minus
to plus the reference.

A scale of "auto" is determined in training, which writes it into the provenance beside each network
file, together with a digest of the weights, because the scales of another network would be wrong.
"""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

import numpy as np

from golden.input_error import InputError
from golden.numbers.real import Real
from golden.sensing.converter_parts import PARTS, STRAIGHT, ConverterPart
from golden.trained.dense import DenseNetwork
from tactus.network_files.network_file import provenance_path, read_provenance
from tactus.network_files.parsed import short_path
from tactus.scene.scale import AUTO, Scale, read_scale
from tactus.scene.vectors import MOST_OUTSIDE, read_recorded

if TYPE_CHECKING:
    from tactus.scene.scene import Scene

SIGNALS = Scale()


def part_scale(part: ConverterPart, reference: float = 0.0) -> Scale:
    """The scale of a part: the readings for which the signals of its codes stand.

    reference: The part's reference in the unit of the readings; 0 for readings that are the part's
        codes.
    """
    straight = part.coding == STRAIGHT
    whole = reference or float(1 << (part.bits if straight else part.bits - 1))
    return Scale(whole / 2, whole / 2) if straight else Scale(0.0, whole)


def converter_scales(scene: Scene) -> dict[str, Scale]:
    """The scale of each sensor whose scale is fixed by the scene's converter.

    Empty for a scene without a converter, and for readings that are signals.
    """
    front_end = scene.front_end
    if front_end is None or not front_end.converter:
        return {}
    part = PARTS[front_end.converter]
    written = {name: scene.scale[name] for name in scene.sensors if name in scene.scale}
    written_scales = {n: scale for n, scale in written.items() if isinstance(scale, Scale)}
    if front_end.reference:
        expected = part_scale(part, front_end.reference)
        why = f"converter {part.name!r} with front_end.reference {front_end.reference:g}"
    else:
        # If the scene gives every sensor the scale of codes, readings that are means of codes need
        # not be recognised as codes.
        codes = len(written_scales) == len(scene.sensors) and set(written_scales.values()) == {
            part_scale(part)
        }
        expected, why = _unit(scene, part, AUTO if AUTO in written.values() else "none", codes)
    for name, scale in written_scales.items():
        if scale != expected:
            raise InputError(
                f"{scene.path}: data.scale.{name}: got {_text(scale)}, expected "
                f"{_text(expected)} for each sensor, or none: {why}"
            )
    return {} if expected == SIGNALS else dict.fromkeys(scene.sensors, expected)


def codes_of(scene: Scene, readings: Real) -> Real:
    """Round readings in codes to whole numbers, and clip them to the codes of the converter."""
    ends = [(s.offset - s.factor, s.offset + s.factor - 1) for s in scene.scales(scene.sensors)]
    low, high = np.array(ends).T
    return np.clip(np.rint(readings), low, high)


def _unit(scene: Scene, part: ConverterPart, got: str, codes: bool) -> tuple[Scale, str]:
    """The scale of readings whose unit the scene does not state, and the reason for it.

    ``codes`` says that the scene declares the readings to be codes. This is needed for means of
    codes, which are no whole numbers and so cannot be recognised.
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
    # A few outliers do not mean that signals are in another unit.
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


def story(scales: dict[str, Scale], network: DenseNetwork) -> dict[str, Any]:
    """What the provenance of a network says about the scales with which it was trained.

    scales: The scale of every column that has one. If none has, the result is empty.
    network: The network as its file holds it.
    """
    table = {name: {"offset": s.offset, "factor": s.factor} for name, s in scales.items()}
    return {"scale": table, "scale_of": _digest(network)} if scales else {}


def trained_scales(scene: Scene) -> dict[str, Scale]:
    """The scale of every column that has one.

    It comes from the scene, from the data sheet of the converter or, for "auto", from training.
    """
    found = {name: scale for name, scale in scene.scale.items() if isinstance(scale, Scale)}
    found |= scene.converter_scales
    for name in scene.auto:
        places = [
            (member.weights_path, _scales_in_provenance(scene, number).get(name))
            for number, member in enumerate(scene.members)
            if name in map(scene.column, scene.columns_of(number))
        ]
        for path, scale in places:
            if not isinstance(scale, Scale) or scale != places[0][1]:
                reason = "another scale than the network before" if scale else "no scale for it"
                raise InputError(
                    f"{scene.path}: data.scale.{name}: got {AUTO!r}, but {provenance_path(path)} "
                    f"has {reason}: {short_path(path)} was not trained here or not by this scene; "
                    "run make train to determine the scale, or give { offset = , factor = } for a "
                    "network from elsewhere, which is the range of the codes"
                )
            found[name] = scale
    return {name: found[name] for name in (scene.scale | found) if name in found}


def _scales_in_provenance(scene: Scene, number: int) -> dict[str, Scale | str]:
    """The scales in the provenance of a network; none if it belongs to another network."""
    member = scene.members[number]
    network, path = member.load(), provenance_path(member.weights_path)
    values = read_provenance(member.weights_path)
    if values is None or values.get("scale_of") != _digest(network):
        return {}
    table = values.get("scale", {})
    if not isinstance(table, dict):
        raise InputError(f"{path}: scale: got {table!r}, expected a table")
    return read_scale({"scale": table, "sensors": list(table), "outputs": []}, path)


def _digest(network: DenseNetwork) -> str:
    """A digest of the weights, which is the same for every format of file."""
    arrays = [a for layer in network.layers for a in (layer.weights, layer.biases)]
    data = b"".join(np.ascontiguousarray(a, dtype="<f8").tobytes() for a in arrays)
    return hashlib.sha256(data).hexdigest()[:16]
