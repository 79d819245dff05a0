"""What "auto" in ``data.scale`` came to when the networks of a scene were trained.

Training writes it into the provenance beside each network file, with a digest of the weights: the
scale of another network would be a wrong one.
"""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

import numpy as np

from golden.dense import Trained, layers_of
from golden.input_error import InputError
from golden.network_files.network_file import provenance_path, read_provenance
from golden.scene.scale import AUTO, Scale, read_scale

if TYPE_CHECKING:
    from golden.scene.scene import Scene


def story(scales: dict[str, Scale], network: Trained) -> dict[str, Any]:
    """What the provenance of a network tells of the scales that it was trained with.

    Parameters
    ----------
    scales : dict
        Of every column that has one; where none has, nothing is told.
    network : Mlp or DenseNetwork
        What the network file holds.
    """
    table = {name: {"offset": s.offset, "factor": s.factor} for name, s in scales.items()}
    return {"scale": table, "scale_of": _digest(network)} if scales else {}


def trained_scales(scene: Scene) -> dict[str, Scale]:
    """The scale of every column that has one: as the scene writes it, as its converter's data sheet
    says, and in the place of "auto" what it came to.

    Raises
    ------
    MissingFileError
        When "auto" is asked for and there is no network yet.
    InputError
        When a network was not trained here, or with another scale than the others; see
        ``converter_scales`` too.
    """
    found = {name: scale for name, scale in scene.scale.items() if isinstance(scale, Scale)}
    found |= scene.converter_scales
    for name in scene.auto:
        places = [
            (member.weights_path, _told(scene, number).get(name))
            for number, member in enumerate(scene.members)
            if name in map(scene.column, scene.columns_of(number))
        ]
        for path, told in places:
            if not isinstance(told, Scale) or told != places[0][1]:
                reason = "another scale than the network before" if told else "no scale for it"
                raise InputError(
                    f"{scene.path}: data.scale.{name}: got {AUTO!r}, but {provenance_path(path)} "
                    f"has {reason}: {path.name} was not trained here or not by this scene; make "
                    "train works the scale out, for a network from elsewhere give { offset = , "
                    "factor = }, the range of the codes"
                )
            found[name] = told
    return {name: found[name] for name in (scene.scale | found) if name in found}


def _told(scene: Scene, number: int) -> dict[str, Scale | str]:
    """The scales in the provenance of a network; none where it is that of another one."""
    member = scene.members[number]
    network, path = member.load(), provenance_path(member.weights_path)
    values = read_provenance(member.weights_path)
    if values is None or values.get("scale_of") != _digest(network):
        return {}
    told = values.get("scale", {})
    if not isinstance(told, dict):
        raise InputError(f"{path}: scale: got {told!r}, expected a table")
    return read_scale({"scale": told, "sensors": list(told), "outputs": []}, path)


def _digest(network: Trained) -> str:
    """A number for the weights, the same in every form of file."""
    arrays = [a for layer in layers_of(network) for a in (layer.weights, layer.biases)]
    data = b"".join(np.ascontiguousarray(a, dtype="<f8").tobytes() for a in arrays)
    return hashlib.sha256(data).hexdigest()[:16]
