"""Reads scenes, by name or from a file."""

import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from golden.networks.engine import Engine
from golden.numbers.precision import PRECISIONS
from tactus.core.files import named_file
from tactus.core.finding import Finding, collect_faults, fault, refuse
from tactus.core.fingerprint import ROOT
from tactus.core.schema import clashes, read_checked
from tactus.scene.data import check_data, check_window, data_paths, read_window
from tactus.scene.front_end import front_end, uart, visualisation
from tactus.scene.hardware import check_activation, demand, design_options
from tactus.scene.keys import SCENE
from tactus.scene.labels import read_labels
from tactus.scene.network import members
from tactus.scene.scale import read_scale
from tactus.scene.scene import Scene
from tactus.scene.training import training
from tactus.sizing.choice import DEFAULT, DEVICES

FOLDER = ROOT / "scenes"
# The scenes that a command uses when it is given none: the instrument of the thesis, and the same
# sensors and outputs as tactus builds them today.
DEFAULT_SCENES = ("thesis", "digit")


def scene_path(name: str) -> Path:
    """The file of a scene that tactus ships. It is in a folder of the same name."""
    return FOLDER / name / f"{Path(name).name}.toml"


def scene_names() -> list[str]:
    return sorted(folder.name for folder in FOLDER.iterdir() if scene_path(folder.name).is_file())


def comparison_names() -> list[str]:
    """The scenes that exist only to compare others with them."""
    return _names_in("comparison")


def class_names() -> list[str]:
    """The shipped scenes whose networks tell classes apart."""
    return _names_in("classes")


def _names_in(group: str) -> list[str]:
    return sorted(f"{group}/{folder.name}" for folder in (FOLDER / group).iterdir())


def load_scene(name: str) -> Scene:
    """Read a scene by its name, or by a path that ends in ``.toml``.

    The group in front of a name, as in ``comparison/digit-lanes4``, may be left out.
    """
    known = [*scene_names(), *class_names()]
    every = [*known, *comparison_names()]
    # Of equal names, the one without a group counts.
    files = {
        name: scene_path(one) for one in reversed(every) for name in (one, one.rpartition("/")[2])
    }
    path = named_file("scene", name, files, known)
    return _scene(read_checked(path, SCENE, in_todays_words), path)


def in_todays_words(raw: dict[str, Any], path: Path) -> None:
    """Read the older design `lanes`, the engine with 2 lanes or more, with a note."""
    hardware = raw.get("hardware")
    if isinstance(hardware, dict) and hardware.get("design") == "lanes":
        hardware |= {"design": Engine.block, "lanes": hardware.get("lanes", 2)}
        _note(f"{path}: [hardware] is read as design = 'engine', lanes = {hardware['lanes']!r}")


@cache
def _note(text: str) -> None:
    print(f"note: {text}", file=sys.stderr)


def _scene(values: dict[str, dict[str, Any]], path: Path) -> Scene:
    data, hardware = values["data"], values["hardware"]
    if isinstance(data["window"], dict):
        # A sensor with its newest sample alone has no past, which would rule out other keys.
        plain = {name for name in data["sensors"] if data["window"].get(name) == [0]}
        data["window"] = {n: d for n, d in data["window"].items() if n not in plain} or [0]
    found = [fault(f"{path}: {text}") for text in clashes(SCENE, values)]
    paths = data_paths(data, path)
    if data["classes"]:
        refuse(found)
        if data["classes"] in data["sensors"]:
            raise InputError(
                f"{path}: data.classes: got {data['classes']!r}, a sensor, expected a column that "
                "data.sensors does not have"
            )
        labels = read_labels(paths, data["where"], data["classes"])
        outputs = [f"{data['classes']} {label}" for label in labels]
        # A one-hot target of 1 is full scale.
        full_scale = dict.fromkeys(outputs, 1.0)
        read = {"outputs": outputs, "full_scale": full_scale, "labels": labels}
        data = values["data"] = data | read
    check_data(data, path)
    of_data = ("classes", "full_scale", "group_by", "length_mm", "reference", "units", "where")
    of_hardware = ("design", "activation_options", "clock_mhz", "interface", "argmax", "learning")
    return Scene(
        name=path.stem,
        path=path,
        data_paths=paths,
        sensors=tuple(data["sensors"]),
        outputs=tuple(data["outputs"]),
        labels=data.get("labels", ()),
        ends=tuple(data["ends"]),
        arrangement=values["network"]["arrangement"],
        precision=PRECISIONS[hardware["precision"]],
        device=DEVICES[hardware["device"] or DEFAULT],
        **{key: data[key] for key in of_data},
        **{key: hardware[key] for key in of_hardware},
        **_parts(values, path, found),
    )


def _parts(values: dict[str, dict[str, Any]], path: Path, found: list[Finding]) -> dict[str, Any]:
    """Those attributes of a scene that are checked while they are made."""
    data, hardware = values["data"], values["hardware"]
    parts: dict[str, Any] = {}

    def networks() -> Any:
        window = parts["window"] = read_window(data, path)
        check_window(values, window, path)
        return members(data, values["network"], len(window.taps), path)

    made: dict[str, Callable[[], Any]] = {
        "members": networks,
        "design_options": lambda: design_options(values, path),
        "demand": lambda: demand(hardware, path),
        "activation": lambda: check_activation(hardware, path),
        "scale": lambda: read_scale(data, path),
        "training": lambda: training(values, path),
        "front_end": lambda: front_end(values, path),
        "visualisation": lambda: visualisation(values, path),
        "uart": lambda: uart(values, path),
    }
    for name, make in made.items():
        with collect_faults(found):
            parts[name] = make()
    refuse(found)
    return parts
