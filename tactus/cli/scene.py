"""``make scene``: writes a scene for recorded readings, and prints what they show."""

import shlex
from pathlib import Path

from golden.input_error import InputError
from tactus.core.cli import stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.files import check_file, check_folder, check_writable
from tactus.core.finding import refuse
from tactus.core.table import read_csv_file
from tactus.rig import check, sensors_tell
from tactus.rig.draft import brought, check_sensors, names_of, write_scene
from tactus.rig.survey import survey
from tactus.scene import load_scene
from tactus.train.split import scaled


def main() -> None:
    arguments = arguments_of("scene", __doc__)
    if not arguments.csv:
        raise InputError("CSV=: missing, expected a file of readings")
    check_file(Path(arguments.csv))
    path: Path = arguments.to or Path(arguments.csv).with_suffix(".toml")
    if path.suffix != ".toml":
        raise InputError(f"TO={path}: got the ending {path.suffix!r}, expected .toml")
    check_folder(path)
    check_writable([path])
    if path.exists():
        raise InputError(f"{path}: is there already; choose another name with TO=")
    recording = read_csv_file(Path(arguments.csv))
    outputs = names_of(arguments.outputs or "")
    if outputs and arguments.classes:
        raise InputError(
            f"CLASSES={arguments.classes}: got OUTPUTS={arguments.outputs} too, expected one of "
            "both: columns of numbers, or a column of labels"
        )
    if arguments.network and arguments.hardware:
        raise InputError(
            f"NETWORK={arguments.network}: got HARDWARE={arguments.hardware} too, expected one of "
            "both: the scale of the network, or that of the hardware"
        )
    found = survey(recording, outputs, arguments.classes or "")
    print(f"{recording.path}: {len(recording.rows)} rows, {len(recording.names)} columns")
    print("\n".join(found.lines()))
    refuse(found.findings)
    print("".join(f"{finding}\n" for finding in found.findings), end="")
    hardware = load_scene(arguments.hardware) if arguments.hardware else None
    if hardware:
        check_sensors(found, hardware)
    network = brought(arguments.network, found) if arguments.network else None
    stop_if_dry_run(f"write {path}")
    scene = write_scene(found, path, hardware, network)
    print("\n".join(str(one) for one in check.data(scene) if one not in found.findings))
    count = len(scene.members)
    networks = "one network" if count == 1 else f"{count} networks in {scene.arrangement}"
    print(f"wrote {path}: {networks}, {len(scene.sensors)} sensors")
    print("\n".join(map(str, sensors_tell.findings(scaled(scene)))))
    argument = f"SCENE={shlex.quote(str(path))}"
    train = "" if network else f"make train {argument} and "
    print(f"next: make check {argument}, then {train}make vhdl {argument}")
