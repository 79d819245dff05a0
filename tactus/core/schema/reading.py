"""Reads a TOML file, and checks it against its declaration."""

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.core.cli import BETWEEN
from tactus.core.files import reading
from tactus.core.schema.keys import KeyTable, within
from tactus.core.schema.kinds import Kind


def read_toml(path: Path) -> dict[str, Any]:
    """Read the contents of a file."""
    with reading(path, "TOML"):
        return tomllib.loads(path.read_text(encoding="utf-8"))


def read_checked(path: Path, table: KeyTable) -> dict[str, Any]:
    """Read every key of a file with its value, check each by itself, and fill in the defaults."""
    raw = read_toml(path)
    check_names(raw, table, path)
    values = values_of(raw, table, path)
    refuse_outside(values, table, "", path)
    return values


def check_names(raw: dict[str, Any], table: KeyTable, path: Path) -> None:
    """Refuse unknown names, values in the place of a table, and numbers too large for TOML."""
    _refuse([*table.unknown_keys(raw, ""), *_long(raw, "")], path)


def values_of(raw: dict[str, Any], table: KeyTable, path: Path) -> dict[str, Any]:
    """Every key with its value, after a check of types and choices, with defaults filled in."""
    _refuse([*table.faults(raw, "")], path)
    found: dict[str, Any] = table.filled(raw)
    return found


def refuse_outside(values: Any, kind: Kind, place: str, path: Path) -> None:
    """Refuse numbers that are too large or too small.

    values: The values that ``values_of`` returns.
    place: The place of the values in the file; empty for the whole file.
    """
    _refuse([*kind.range_errors(values, place)], path)


def _refuse(faults: list[str], path: Path) -> None:
    if faults:
        raise InputError(BETWEEN.join(f"{path}: {fault}" for fault in faults))


def _long(value: Any, place: str) -> Iterator[str]:
    """Messages for whole numbers beyond TOML's 64 bits; within them each is a float too."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _long(inner, within(place, key))
    elif isinstance(value, list):
        for inner in value:
            yield from _long(inner, place)
    elif isinstance(value, int) and not -(1 << 63) <= value < 1 << 63:
        yield f"{place}: got a number of {value.bit_length()} bits, expected 64 at most"
