"""Describes a mutant in words."""

from __future__ import annotations

import re
from pathlib import Path

from tb.sign_off.mutate.mutants import given

MODES = {"inv": "inverted", "const0": "stuck at 0", "const1": "stuck at 1"}


def describe(command: str, folder: Path) -> tuple[str, str]:
    """Where a mutant is, as file and line, and what it changes, by the text of the line.

    ``folder`` holds the files of which the mutant was made.
    """
    parts = given(command)
    mode = MODES.get(parts["mode"])
    if mode is None:
        mode = f"inverted where bit {parts['ctrlbit']} is {parts['mode'][-1]}"
    places = [_place(source, folder) for source in re.findall(r"-src (\S+)", command)]
    # The first place is the declaration of the wire, if it has a name; the next is the expression.
    where, text = places[min(len(places) - 1, "wire" in parts)] if places else ("", "")
    wire = f" ({parts['wire']}[{parts['wirebit']}])" if "wire" in parts else ""
    what = f"{text}: {parts['port']}[{parts['portbit']}]{wire} {mode}"
    return where, what.replace("\\", "")


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
