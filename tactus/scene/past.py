"""The samples of past frames that a scene's networks read: ``data.window``, ``data.recordings``."""

from collections.abc import Sequence
from itertools import pairwise
from os.path import normpath
from pathlib import Path
from typing import Any

from golden.input_error import InputError, suggest
from golden.networks.designs import DESIGNS
from golden.trained.window import Window
from tactus.core.schema import written

# The most frames of a past, because a larger ring would need a large memory.
MOST_PAST = 1 << 16


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
    """Check the delays of one sensor."""
    if any(a >= b for a, b in pairwise(written)):
        raise InputError(f"{place}: got {written!r}, expected ascending delays, each once")
    return tuple(written)


def tap_names(window: Window, sensors: Sequence[str]) -> tuple[str, ...]:
    """Names, for a reader, of the samples that a network reads."""
    return tuple(
        sensors[tap.sensor] + (f" {tap.delay} before" if tap.delay else "") for tap in window.taps
    )


def window_text(window: Window, sensors: Sequence[str]) -> str:
    """The delays as text, for provenance and pages; empty where there is no past."""
    if window.plain:
        return ""
    texts = [" ".join(map(str, delays)) for delays in window.delays]
    if len(set(texts)) == 1:
        return texts[0]
    return ", ".join(f"{name} {text}" for name, text in zip(sensors, texts, strict=True))


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


def recordings(data: dict[str, Any], path: Path) -> list[str]:
    """The names in ``data.file`` or ``data.recordings``; a scene has exactly one of these keys.

    ``data`` is the section as it was written, without a key that is left out.
    """
    file: str | None = data.get("file")
    several: list[str] | None = data.get("recordings")
    if file is None and several is None:
        raise InputError(
            f"{path}: data.file: missing, expected text, the name of a file, or several in "
            "data.recordings"
        )
    if several is None:
        return [file or ""]
    if file is not None:
        raise InputError(
            f"{path}: data.recordings: got {several!r} beside data.file, expected one of both keys"
        )
    if len({*map(normpath, several)}) < len(several):
        raise InputError(
            f"{path}: data.recordings: got {several!r}, expected names of files, each once"
        )
    return list(several)
