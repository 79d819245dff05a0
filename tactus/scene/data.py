"""The section ``[data]`` of a scene: the files, columns and delays that it names."""

import os
import tomllib
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

from golden.input_error import InputError, suggest
from golden.networks.designs import DESIGNS
from golden.trained.window import Window
from tactus.core.files import check_file
from tactus.core.fingerprint import ROOT
from tactus.scene.scale import refuse_other_column, with_units


def read_window(data: dict[str, Any], path: Path) -> Window:
    """Read ``data.window``: one list of delays for all sensors, or a list for some of them.

    Of a sensor that the table does not name, only the newest sample is read.
    """
    delays, sensors = data["window"], data["sensors"]
    if not isinstance(delays, dict):
        return Window((tuple(delays),) * len(sensors))
    for name in delays:
        if name not in sensors:
            raise InputError(
                f"{path}: data.window: {name!r} is no sensor, expected one of "
                f"{', '.join(sensors)}{suggest(name, sensors)}"
            )
    return Window(tuple(tuple(delays.get(name, [0])) for name in sensors))


def tap_names(window: Window, sensors: Sequence[str]) -> tuple[str, ...]:
    """Names, for a reader, of the samples that a network reads."""
    return tuple(
        sensors[tap.sensor] + (f" {tap.delay} before" if tap.delay else "") for tap in window.taps
    )


def check_window(values: dict[str, dict[str, Any]], window: Window, path: Path) -> None:
    """Refuse settings that cannot be combined with samples of past frames."""
    data, training = values["data"], values["training"]
    if window.plain:
        return
    taps = zip(tap_names(window, data["sensors"]), window.taps, strict=True)
    columns = [*data["sensors"], *data["outputs"]]
    for name in (name for name, tap in taps if tap.delay and name in columns):
        raise InputError(
            f"{path}: data.window: {name!r} is a column and a past sample too, expected a column "
            "of another name"
        )
    design = DESIGNS.get(values["hardware"]["design"])
    if design and design.stream != "serial":
        serial = " or ".join(name for name, other in DESIGNS.items() if other.stream == "serial")
        raise InputError(
            f"{path}: hardware.design: got {design.block!r} with a data.window, expected {serial}, "
            "which take a stream of samples"
        )
    if training["split"] == "blocks" and training["block_rows"] <= window.past:
        raise InputError(
            f"{path}: training.block_rows: got {training['block_rows']} with a data.window that "
            f"reaches {window.past} frames back, expected more: the first {window.past} rows of a "
            "block share samples with the block before, and are left out"
        )


def data_paths(data: dict[str, Any], path: Path) -> tuple[Path, ...]:
    several = data["recordings"]
    key, names = ("recordings", several) if several else ("file", [data["file"]])
    found = tuple(beside(path, f"data.{key}", name) for name in names)
    if len(set(found)) < len(found):
        raise InputError(
            f"{path}: data.recordings: got {several!r}, expected names of files, each once"
        )
    for file in found if data["source"] else ():
        check_file(file, f"no such file; {data['source']}")
    return found


def beside(path: Path, key: str, name: str) -> Path:
    """The file that a scene names relative to its own folder, in a path without ``..``."""
    if not name or not name.isprintable():
        raise InputError(f"{path}: {key}: got {name!r}, expected the name of a file")
    return Path(os.path.normpath(path.parent / name))


def check_data(data: dict[str, Any], path: Path) -> None:
    """Refuse columns, units and a reference that are not possible."""
    both = [name for name in data["outputs"] if name in data["sensors"]]
    if both:
        raise InputError(
            f"{path}: data.outputs: got {both[0]!r}, a sensor, expected columns that data.sensors "
            "does not have"
        )
    for key, known in (("full_scale", data["outputs"]), ("length_mm", list(data["full_scale"]))):
        for name in data[key]:
            if name not in known:
                what = "output" if key == "full_scale" else "output with a full_scale"
                raise InputError(
                    f"{path}: data.{key}: {name!r} is no {what}, expected one of "
                    f"{', '.join(known)}{suggest(name, known)}"
                )
    for name, unit in data["units"].items():
        refuse_other_column("units", name, with_units(data), path)
        if not unit.isprintable():
            raise InputError(f"{path}: data.units.{name}: got {unit!r}, expected text, such as 'g'")
    if data["reference"]:
        thesis_figures(data["reference"], len(data["outputs"]), path)


NUMBERS = ROOT / "scenes" / "data" / "thesis_numbers.toml"


@cache
def _numbers() -> dict[str, Any]:
    return tomllib.loads(NUMBERS.read_text(encoding="utf-8"))


def thesis_table(key: str) -> dict[str, Any]:
    """A table of scenes/data/thesis_numbers.toml by its dotted name; empty if there is none."""
    table: Any = _numbers()
    for part in key.split("."):
        table = table.get(part) if isinstance(table, dict) else None
    return table if isinstance(table, dict) else {}


def thesis_figures(key: str, outputs: int, path: Path) -> list[float]:
    """The largest mean errors of the thesis that a scene names, in percent, one for each output."""
    figures = thesis_table(key).get("simulation")
    if figures is None or len(figures) != outputs:
        raise InputError(
            f"{path}: data.reference: got {key!r}, expected a table of thesis_numbers.toml with "
            f"{outputs} simulation figures, such as digit.hybrid"
        )
    return [float(figure) for figure in figures]
