"""Describes a mutant in words."""

import json
import re
from pathlib import Path
from typing import Any

from tactus.verify.sign_off.mutate.mutants import given

MODES = {"inv": "inverted", "const0": "stuck at 0", "const1": "stuck at 1"}


def describe(command: str, folder: Path) -> tuple[str, str]:
    """Where a mutant is, as file and line, and what it changes, by the text of the line.

    ``folder`` holds the files of which the mutant was made. Yosys makes cells of its own, such as
    the enable of a register; a mutant of one of these is at what its result goes to.
    """
    parts = given(command)
    mode = MODES.get(parts["mode"])
    if mode is None:
        mode = f"inverted where bit {parts['ctrlbit']} is {parts['mode'][-1]}"
    places = [_place(source, folder) for source in re.findall(r"-src (\S+)", command)]
    # The first place is the declaration of the wire, if it has a name; the next is the expression.
    if places:
        where, text = places[min(len(places) - 1, "wire" in parts)]
    else:
        where, text = _place(_source_behind(parts, folder), folder)
        text = f"before {text}"
    wire = f" ({parts['wire']}[{parts['wirebit']}])" if "wire" in parts else ""
    what = f"{text}: {parts['port']}[{parts['portbit']}]{wire} {mode}"
    return where, what.replace("\\", "")


def _source_behind(parts: dict[str, str], folder: Path) -> str:
    """The source of the nearest cell with one that the result of a mutant's cell goes to."""
    modules = json.loads((folder / "base.json").read_text(encoding="utf-8"))["modules"]
    cells = modules[parts["module"]]["cells"]
    seen, names = set[str](), [parts["cell"].removeprefix("\\")]
    for name in names:
        cell = cells[name]
        if "src" in cell["attributes"]:
            return str(cell["attributes"]["src"]).split("|")[0]
        seen.add(name)
        results = _bits(cell, "output")
        names += [
            other
            for other, there in cells.items()
            if other not in seen and results & _bits(there, "input")
        ]
    raise AssertionError(f"{parts['cell']}: no cell with a source behind it")


def _bits(cell: dict[str, Any], direction: str) -> set[int | str]:
    """The nets at the ports of a cell."""
    ports = [port for port, to in cell["port_directions"].items() if to == direction]
    return {bit for port in ports for bit in cell["connections"][port]}


def _place(source: str, folder: Path) -> tuple[str, str]:
    """File and line of Yosys' "file:line.column-line.column", and the text there, in one line."""
    file, _, span = source.rpartition(":")
    (first, left), (last, right) = (map(int, end.split(".")) for end in span.split("-"))
    lines = (folder / file).read_text(encoding="utf-8").splitlines()[first - 1 : last]
    whole = list(lines)
    lines[-1] = lines[-1][: right - 1]
    lines[0] = lines[0][left - 1 :]
    # A choice of a case has an empty place, so the whole line is taken.
    return f"{file}:{first}", _plain(lines) or _plain(whole)


def _plain(lines: list[str]) -> str:
    """One line without comments; for a process or a part only its name."""
    text = re.sub(r"\s+", " ", " ".join(line.partition("//")[0] for line in lines)).strip()
    named = re.match(r"always .*?begin: (\w+)|(\w+) \( ?\.", text)
    return (named[1] or named[2]) if named else text
