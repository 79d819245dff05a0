"""The scales that "auto" in ``data.scale`` got when the networks of a scene were trained.

Training writes them into the provenance beside each network file, together with a digest of the
weights, because the scales of another network would be wrong.
"""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

import numpy as np

from golden.input_error import InputError
from golden.trained.dense import Trained, layers_of
from tactus.network_files.network_file import provenance_path, read_provenance
from tactus.scene.scale import AUTO, Scale, read_scale

if TYPE_CHECKING:
    from tactus.scene.scene import Scene


def story(scales: dict[str, Scale], network: Trained) -> dict[str, Any]:
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
                    f"has {reason}: {path.name} was not trained here or not by this scene; run "
                    "make train to determine the scale, or give { offset = , factor = } for a "
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


def _digest(network: Trained) -> str:
    """A digest of the weights, which is the same for every format of file."""
    arrays = [a for layer in layers_of(network) for a in (layer.weights, layer.biases)]
    data = b"".join(np.ascontiguousarray(a, dtype="<f8").tobytes() for a in arrays)
    return hashlib.sha256(data).hexdigest()[:16]
