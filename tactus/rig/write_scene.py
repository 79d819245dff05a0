"""Writes a scene for recorded readings to a file."""

import csv
from pathlib import Path

from golden.input_error import InputError
from tactus.core.files import replace_file
from tactus.network_files.network_file import provenance_path
from tactus.rig.draft import draft
from tactus.rig.network_of_others import Brought
from tactus.rig.survey import Survey
from tactus.scene import Scene, load_scene
from tactus.train.descent.scaling import scaled


def names_of(text: str) -> list[str]:
    """Column names separated by commas; a name that contains a comma is in double quotes."""
    try:
        return [name.strip() for name in next(csv.reader([text], skipinitialspace=True), [])]
    except csv.Error as error:
        raise InputError(f"OUTPUTS={text!r}: got no names between commas: {error}") from None


def check_sensors(found: Survey, hardware: Scene) -> None:
    """Refuse a recording with other sensors than those that a scene's hardware reads."""
    got = tuple(found.sensors)
    if got != hardware.sensors:
        why = "".join(
            f"; {name} is left out: {found.left_out[name]}"
            for name in hardware.sensors
            if name in found.left_out
        )
        raise InputError(
            f"{found.recording.path}: got the sensors {', '.join(got)}, expected "
            f"{', '.join(hardware.sensors)}, as {hardware.path} reads them{why}"
        )


def write_scene(
    found: Survey, path: Path, hardware: Scene | None = None, network: Brought | None = None
) -> Scene:
    """Write the scene, after a check that it can be read.

    hardware: Scene whose hardware has read the sensors, and will run the networks.
    network: The network that the scene is for.
    """
    with replace_file(path) as temporary:
        temporary.write_text(draft(found, path, hardware, network), encoding="utf-8")
        scene = load_scene(str(temporary))
        scaled(scene).vectors()
        if network:
            scene.networks()
        trained = [*scene.weights_paths, *map(provenance_path, scene.weights_paths)]
        files = [path] if network else [path, *trained]
        for file in files:
            if file.exists() or file.is_symlink():
                raise InputError(f"{file}: is there already; choose another name with TO=")
    return load_scene(str(path))
