"""The section ``[data]`` of a scene: its keys, and the files, columns and delays that it names."""

import os
import tomllib
from collections.abc import Sequence
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

from golden.input_error import InputError, suggest
from golden.networks.designs import DESIGNS
from golden.trained.window import Window
from tactus.core.files import check_file
from tactus.core.fingerprint import ROOT
from tactus.core.schema import (
    Alternatives,
    Key,
    KeyTable,
    List,
    Map,
    Number,
    Span,
    Text,
    Whole,
    written,
)
from tactus.scene.scale import AUTO, refuse_other_column, with_units

# The most frames of a past, because a larger ring would need a large memory.
MOST_PAST = 1 << 16
_COLUMNS = List(Text(some=True), "column names, each once", "a list of texts", once=True)
_ABOVE_0 = Map(Number(Span(above=0), "a number above 0"))
_FRAMES = "whole numbers of frames, such as [0, 4, 8]"
_DELAY = Whole(Span(0, MOST_PAST), f"delays from 0 to {MOST_PAST}")
_SCALE = f"{AUTO!r} or {{ offset = , factor = }}"
_SCALE_KEYS = {
    "offset": Key(Number(finite=True), 0.0, "The reading that code 0 stands for."),
    "factor": Key(
        Number(Span(above=0), finite=True), meaning="What full scale adds to the reading of code 0."
    ),
}
_SCALES = Map(
    Alternatives((Text((AUTO,), said=_SCALE), KeyTable(_SCALE_KEYS, said=_SCALE)), _SCALE)
)
DATA = KeyTable(
    {
        "file": Key(
            Text(),
            "",
            "The CSV file with the recorded vectors. A scene has either this key or `recordings`.",
        ),
        "recordings": Key(
            List(Text(), "names of files, each once", "a list of texts", once=True),
            [],
            "Several CSV files, each of them a recording of its own: no file continues another.",
        ),
        "source": Key(
            Text(),
            "",
            "Where the data come from if they are not kept with the scene: a command or an "
            "address, and a digest. The message that there is no such file says it.",
        ),
        "sensors": Key(
            _COLUMNS,
            meaning="The columns of the samples, in the order in which they enter the hardware. "
            "There must be at least one, and each column is named once.",
        ),
        "outputs": Key(
            _COLUMNS,
            [],
            "The columns of the targets, in the order in which the outputs leave the "
            "hardware. There must be at least one, and each column is named once. A scene has "
            "either this key or `classes`.",
        ),
        "classes": Key(
            Text(some=True),
            "",
            "A column of labels, texts or whole numbers, which the network tells apart: it has an "
            "output for each label. See [classes](networks.md#classes).",
        ),
        "group_by": Key(
            Text(),
            "",
            "A column of numbers or texts; rows with the same value in it form a position. The "
            "largest mean error is the largest over the positions (equation 3.15). Without this "
            "key it is the mean of all rows.",
        ),
        "where": Key(
            Map(Alternatives((Number(finite=True), Text(some=True)))),
            {},
            "For each named column a number or a text, such as `{ width = 0.225 }` or "
            '`{ person = "anna" }`. Only rows with these values are used. '
            "A CSV file without such a row is refused.",
        ),
        "window": Key(
            Alternatives((List(_DELAY, _FRAMES), Map(List(_DELAY, _FRAMES, _FRAMES)))),
            [0],
            "The ages, in frames, of the samples that the networks take: `[0, 4, 8]` for every "
            "sensor, or `{ sensor1 = [0, 4] }` for some. For a sensor that is not named, the "
            "networks take only the newest sample. See [past samples](#past-samples).",
        ),
        "full_scale": Key(
            _ABOVE_0,
            {},
            "For each named output a number above 0, in the unit of the output. The error of the "
            "output is divided by it. The error of any other output is divided by the target "
            "(equation 3.16).",
        ),
        "length_mm": Key(
            _ABOVE_0,
            {},
            "For each named output with a `full_scale`, the length of this full scale in "
            "millimetres. The errors of the output are then also shown in millimetres.",
        ),
        "scale": Key(
            Alternatives((_SCALES, Text((AUTO,), said=f"{AUTO!r} or a table of columns"))),
            {},
            "For each named column of a sensor or an output, what its codes stand for [in the unit "
            'of the column](formats.md#units): `{ offset = , factor = }` or `"auto"`. '
            '`scale = "auto"` means "auto" for all columns. A column that is not named holds '
            "values from -1 to 1. Sensors of a scene with a `front_end.converter` need no scale "
            "here: see [what a converter reads](#what-a-converter-reads).",
        ),
        "units": Key(
            Map(Text(said="text, such as 'g'")),
            {},
            "For each named column of a sensor or an output, the name of its unit, such as "
            '`{ load = "g" }`. The name appears in what is printed.',
        ),
        "ends": Key(
            List(
                Number(finite=True),
                "a list of numbers, such as [0]",
                "a list of numbers",
                least=0,
            ),
            [],
            "The natural ends of the range of the sensors, such as `[0]` if they count something. "
            "If many readings lie at any other end, `make check` asks whether the range of a "
            "converter or an amplifier ends there.",
        ),
        "reference": Key(
            Text(),
            "",
            "A table of `scenes/data/thesis_numbers.toml`, such as `digit.hybrid`. `make demo` "
            "prints its list `simulation`, which has one figure for each output, beside the "
            "errors.",
        ),
    },
    name="a section",
    either=(("file", "recordings"), ("outputs", "classes")),
)


def read_window(data: dict[str, Any], path: Path) -> Window:
    """Read ``data.window``: one list of delays for all sensors, or a list for some of them.

    Of a sensor that the table does not name, only the newest sample is read.
    """
    written, sensors = data["window"], data["sensors"]
    if not isinstance(written, dict):
        return Window((_delays(written, f"{path}: data.window"),) * len(sensors))
    for name in written:
        if name not in sensors:
            raise InputError(
                f"{path}: data.window: {name!r} is no sensor, expected one of "
                f"{', '.join(sensors)}{suggest(name, sensors)}"
            )
    return Window(
        tuple(_delays(written.get(name, [0]), f"{path}: data.window.{name}") for name in sensors)
    )


def _delays(written: list[int], place: str) -> tuple[int, ...]:
    if any(a >= b for a, b in pairwise(written)):
        raise InputError(f"{place}: got {written!r}, expected ascending delays, each once")
    return tuple(written)


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
    if values["hardware"]["reload"]:
        raise InputError(
            f"{path}: hardware.reload: got true with a data.window, expected false: an image has "
            "no memory for past samples"
        )
    if data["where"]:
        raise InputError(
            f"{path}: data.where: got {written(data['where'])} with a data.window, expected none: "
            "rows that are left out are missing in the past of others; give data.recordings"
        )
    if training["split"] == "random":
        raise InputError(
            f"{path}: training.split: got 'random' with a data.window, expected 'blocks' or "
            "'groups': rows beside each other share their samples"
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
