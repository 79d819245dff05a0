"""``python -m golden.rig.write_scene``: a scene for recorded readings, and what they show."""

from __future__ import annotations

import argparse
import csv
import shlex
import sys
from pathlib import Path

from golden.cli import run, would
from golden.files import check_file, check_writable, replace_file
from golden.input_error import InputError
from golden.network_files.network_file import provenance_path
from golden.rig import sensors_tell
from golden.rig.csv_file import read_csv_file
from golden.rig.draft import draft
from golden.rig.finding import refuse
from golden.rig.survey import Survey, survey
from golden.scene import Scene, load_scene
from golden.training.scaling import scaled


def names_of(text: str) -> list[str]:
    """Column names between commas; one that holds a comma stands in double quotes."""
    try:
        return [name.strip() for name in next(csv.reader([text], skipinitialspace=True), [])]
    except csv.Error as error:
        raise InputError(f"OUTPUTS={text!r}: got no names between commas: {error}") from None


def check_sensors(found: Survey, hardware: Scene) -> None:
    """Refuse a recording whose sensors are not those that a scene's hardware reads.

    Raises
    ------
    InputError
    """
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


def write_scene(found: Survey, path: Path, hardware: Scene | None = None) -> Scene:
    """Write the scene, once it is clear that it can be read.

    Parameters
    ----------
    found : Survey
    path : Path
    hardware : Scene, optional
        Whose hardware read the sensors, and is to run the networks.

    Raises
    ------
    InputError
        When the file, or a network that it would name, is there already.
    """
    with replace_file(path) as temporary:
        temporary.write_text(draft(found, path, hardware), encoding="utf-8")
        scene = load_scene(str(temporary))
        scaled(scene).vectors()
        files = [path, *scene.weights_paths, *map(provenance_path, scene.weights_paths)]
        for file in files:
            if file.exists() or file.is_symlink():
                raise InputError(f"{file}: is there already; choose another name with TO=")
    return load_scene(str(path))


def main() -> None:
    parser = argparse.ArgumentParser(prog="make scene", description=__doc__)
    parser.add_argument("csv")
    parser.add_argument("outputs", help="columns to be told from the others, between commas")
    parser.add_argument("--hardware", help="scene whose board recorded the readings")
    parser.add_argument("--to", type=Path, help="the scene; beside the CSV and named as it")
    arguments = parser.parse_args()
    if not arguments.csv:
        raise InputError("CSV=: missing, expected a file of readings")
    check_file(Path(arguments.csv))
    path: Path = arguments.to or Path(arguments.csv).with_suffix(".toml")
    if path.suffix != ".toml":
        raise InputError(f"TO={path}: got the ending {path.suffix!r}, expected .toml")
    check_writable([path])
    if path.exists():
        raise InputError(f"{path}: is there already; choose another name with TO=")
    recording = read_csv_file(Path(arguments.csv))
    found = survey(recording, names_of(arguments.outputs))
    print(f"{recording.path}: {len(recording.rows)} rows, {len(recording.names)} columns")
    print("\n".join(found.lines()))
    for finding in found.findings:
        if finding.verdict != "fault":
            print(finding)
    refuse(found.findings)
    hardware = load_scene(arguments.hardware) if arguments.hardware else None
    if hardware:
        check_sensors(found, hardware)
    would(f"write {path}")
    scene = write_scene(found, path, hardware)
    count = len(scene.members)
    networks = "one network" if count == 1 else f"{count} networks in {scene.arrangement}"
    print(f"wrote {path}: {networks}, {len(scene.sensors)} sensors")
    print("\n".join(map(str, sensors_tell.findings(scaled(scene)))))
    given = f"SCENE={shlex.quote(str(path))}"
    print(f"next: make check {given}, then make train {given} and make vhdl {given}")


if __name__ == "__main__":
    sys.exit(run(main))
