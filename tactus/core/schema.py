"""Declares the TOML files that tactus reads, each of them once.

A file is a ``KeyTable`` of ``Key``, and a key has a ``Kind``, a default and a meaning. From this
declaration come the check of a file with its messages, the values of keys that are left out, the
JSON schema with which an editor completes and checks a file, and the tables of keys in the pages. A
rule that involves two keys, or another file, is beyond any kind; the code that reads the file
checks it.

No library does all of this. Models of pydantic would check types, ranges and unknown names. But
pydantic reports a fault once for each kind that a key may have, names the place of a value within a
list and not the list, and says neither what was expected of a missing key nor which name is the
nearest. So every message, and the tables for pages, would have to be written here all the same, in
some 60 % of these lines. msgspec stops at the first fault.
"""

import json
import math
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from golden.input_error import InputError, suggest
from tactus.core.cli import BETWEEN
from tactus.core.files import reading


@dataclass(frozen=True)
class Span:
    """The numbers between two ends, each of which may be missing. NaN and infinities never fit.

    least, most: Ends that are part of the range.
    above, below: Ends that are not part of the range.
    """

    least: float | None = None
    most: float | None = None
    above: float | None = None
    below: float | None = None

    def holds(self, value: float) -> bool:
        """Whether a number lies in the range."""
        return (
            math.isfinite(value)
            and (self.least is None or value >= self.least)
            and (self.most is None or value <= self.most)
            and (self.above is None or value > self.above)
            and (self.below is None or value < self.below)
        )

    def __str__(self) -> str:
        if self.least is not None:
            if self.most is None and self.below is None:
                return f"{self.least:g} or more"
            most = f"{self.most:.10g}" if self.below is None else f"below {self.below:g}"
            return f"{self.least:g} to {most}"
        ends = {"above {:g}": self.above, "below {:g}": self.below, "{:.10g} at most": self.most}
        return " and ".join(text.format(end) for text, end in ends.items() if end is not None)

    def schema(self) -> dict[str, Any]:
        """This range as a JSON schema."""
        words = {
            "minimum": self.least,
            "maximum": self.most,
            "exclusiveMinimum": self.above,
            "exclusiveMaximum": self.below,
        }
        return {word: end for word, end in words.items() if end is not None}


def got(place: str, value: object, expected: str) -> str:
    """The message of a fault."""
    return f"{place}: got {written(value)}, expected {expected}"


def written(value: object) -> str:
    """A value as it is written in a TOML file."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list):
        return f"[{', '.join(map(written, value))}]"
    if isinstance(value, dict) and value:
        return f"{{ {', '.join(f'{name} = {written(one)}' for name, one in value.items())} }}"
    return repr(value)


class Kind:
    """A kind of value that a key may hold.

    ``place`` is the beginning of a message.

    choices: The texts that are allowed; empty where every text is.
    said: What a message expects, instead of the kind's own text.
    absent: Whether 0 means that the key is left out, so that 0 itself cannot be requested.
    """

    choices: tuple[str, ...] = ()
    said: str = ""
    absent: bool = False

    @property
    def name(self) -> str:
        """The name of the type, for pages, such as ``a whole number``."""
        raise NotImplementedError

    @property
    def expected(self) -> str:
        """What a message expects instead of a value of another type."""
        return self.said or self.name

    def accepts(self, value: object) -> bool:
        """Whether the value has this type, whatever it contains."""
        raise NotImplementedError

    def faults(self, value: Any, place: str) -> Iterator[str]:
        """Messages for all that is wrong with a value."""
        if not self.accepts(value):
            yield got(place, value, self.expected)

    def filled(self, value: Any) -> Any:
        """The value as it is used: with defaults, and as a float where a number is expected."""
        return value

    def schema(self) -> dict[str, Any]:
        """This kind as a JSON schema."""
        raise NotImplementedError

    @property
    def within(self) -> str:
        """The range of its numbers, for a page; empty if there is no limit."""
        return ""


@dataclass(frozen=True)
class Flag(Kind):
    """True or false."""

    name: str = field(default="true or false", init=False)

    def accepts(self, value: object) -> bool:
        return type(value) is bool

    def schema(self) -> dict[str, Any]:
        return {"type": "boolean"}


@dataclass(frozen=True)
class Anything(Kind):
    """Any value of TOML, where another part of the file decides what is right."""

    name: str = field(default="anything", init=False)

    def accepts(self, value: object) -> bool:
        return True

    def schema(self) -> dict[str, Any]:
        return {}


@dataclass(frozen=True)
class Text(Kind):
    """A text.

    some: Whether the text must not be empty.
    begins: A text that begins with it is allowed beside the choices; empty for none.
    """

    choices: tuple[str, ...] = ()
    some: bool = False
    said: str = ""
    begins: str = ""
    name: str = field(default="text", init=False)

    def accepts(self, value: object) -> bool:
        return type(value) is str and not (self.some and not value)

    def faults(self, value: Any, place: str) -> Iterator[str]:
        yield from super().faults(value, place)
        if self.begins and self.accepts(value) and value.startswith(self.begins):
            return
        if self.choices and self.accepts(value) and value not in self.choices:
            expected = self.said or f"one of {', '.join(self.choices)}"
            yield got(place, value, expected) + suggest(value, self.choices)

    def schema(self) -> dict[str, Any]:
        if self.begins:
            other = {"type": "string", "pattern": f"^{self.begins}"}
            return {"anyOf": [{"enum": list(self.choices)}, other]}
        if self.choices:
            return {"enum": list(self.choices)}
        return {"type": "string", **({"minLength": 1} if self.some else {})}


@dataclass(frozen=True)
class Number(Kind):
    """A number; a whole number is one too.

    finite: Whether NaN and the infinities are refused, whatever the span.
    """

    span: Span | None = None
    said: str = ""
    finite: bool = False
    absent: bool = False
    name: str = field(default="a number", init=False)

    def accepts(self, value: object) -> bool:
        if type(value) is float:
            return not self.finite or math.isfinite(value)
        return type(value) is int

    def faults(self, value: Any, place: str) -> Iterator[str]:
        yield from super().faults(value, place)
        if self.absent and value == 0 and self.accepts(value):
            yield got(place, value, "a number above 0, or no such key")
        elif self.span and self.accepts(value) and not self.span.holds(value):
            yield got(place, value, self.said or str(self.span))

    def filled(self, value: Any) -> Any:
        return float(value)

    def schema(self) -> dict[str, Any]:
        absent = {"not": {"const": 0}} if self.absent else {}
        return {"type": "number", **(self.span.schema() if self.span else absent)}

    @property
    def within(self) -> str:
        return str(self.span or "")


@dataclass(frozen=True)
class Whole(Number):
    """A whole number."""

    name: str = field(default="a whole number", init=False)

    def accepts(self, value: object) -> bool:
        return type(value) is int

    def filled(self, value: Any) -> Any:
        return value

    def schema(self) -> dict[str, Any]:
        return super().schema() | {"type": "integer"}


@dataclass(frozen=True)
class List(Kind):
    """A list of values of one kind.

    said: What a message expects of the contents.
    least, most: Least and largest number of values.
    once: Whether each value may stand in the list only once.
    rising: Whether no value may be less than the one before it.
    """

    of: Kind
    said: str
    name: str = "a list"
    least: int = 1
    most: int | None = None
    once: bool = False
    rising: bool = False

    @property
    def expected(self) -> str:
        return self.name

    def accepts(self, value: object) -> bool:
        return type(value) is list

    def faults(self, value: Any, place: str) -> Iterator[str]:
        yield from super().faults(value, place)
        if not self.accepts(value):
            return
        wrong = [one for one in value if any(True for _ in self.of.faults(one, place))]
        if wrong and self.of.choices and self.of.accepts(wrong[0]):
            yield from self.of.faults(wrong[0], place)
        elif wrong and all(map(self.of.accepts, wrong)):
            yield got(place, value, self.of.said or self.said)
        elif wrong or not self._counts(value):
            yield got(place, value, self.said)

    def _counts(self, value: list[Any]) -> bool:
        """Whether so many values may stand there, in this order."""
        most = len(value) if self.most is None else self.most
        twice = self.once and len(set(value)) < len(value)
        falling = self.rising and value != sorted(value)
        return self.least <= len(value) <= most and not twice and not falling

    def schema(self) -> dict[str, Any]:
        counts = {"minItems": self.least or None, "maxItems": self.most}
        counts |= {"uniqueItems": self.once or None}
        kept = {word: count for word, count in counts.items() if count is not None}
        return {"type": "array", "items": self.of.schema(), **kept}

    @property
    def within(self) -> str:
        return f"each {self.of.within}" if self.of.within else ""


@dataclass(frozen=True)
class Each(Kind):
    """One value for all networks of a scene, or a list with one value for each network."""

    of: Kind

    @property
    def name(self) -> str:
        return f"{self.of.name}, or a list with one for each network"

    def accepts(self, value: object) -> bool:
        return all(self.of.accepts(one) for one in self._all(value))

    def faults(self, value: Any, place: str) -> Iterator[str]:
        yield from super().faults(value, place)
        every = self._all(value) if self.accepts(value) else []
        if any(True for one in every for _ in self.of.faults(one, "")):
            yield got(place, value, self.of.within)

    @staticmethod
    def _all(value: Any) -> list[Any]:
        return value if isinstance(value, list) else [value]

    def schema(self) -> dict[str, Any]:
        one = self.of.schema()
        return {"anyOf": [one, {"type": "array", "items": one}]}

    @property
    def within(self) -> str:
        return self.of.within


@dataclass(frozen=True)
class Map(Kind):
    """A table whose names are not known beforehand, such as those of columns.

    names: The names that are allowed; empty where every name is.
    said: What a message expects if anything in the table is wrong. If it is empty, each value is
        reported by itself.
    """

    of: Kind
    names: tuple[str, ...] = ()
    said: str = ""
    name: str = field(default="a table", init=False)

    def accepts(self, value: object) -> bool:
        return type(value) is dict

    def faults(self, value: Any, place: str) -> Iterator[str]:
        if not self.accepts(value):
            yield got(place, value, self.expected)
            return
        found = [f for name, one in value.items() for f in self.of.faults(one, f"{place}.{name}")]
        if self.said and (found or (self.names and set(value) - set(self.names))):
            yield got(place, value, self.said)
        else:
            yield from found

    def schema(self) -> dict[str, Any]:
        one = self.of.schema()
        if self.names:
            properties = dict.fromkeys(self.names, one)
            return {"type": "object", "properties": properties, "additionalProperties": False}
        return {"type": "object", "additionalProperties": one}


@dataclass(frozen=True)
class Alternatives(Kind):
    """One of several kinds; if more than one accepts a value, the first one counts.

    said: What a message expects, instead of the names of the kinds.
    """

    kinds: tuple[Kind, ...]
    said: str = ""

    @property
    def name(self) -> str:
        return " or ".join(kind.name for kind in self.kinds)

    def _meant(self, value: object) -> Kind | None:
        return next((kind for kind in self.kinds if kind.accepts(value)), None)

    def accepts(self, value: object) -> bool:
        return self._meant(value) is not None

    def faults(self, value: Any, place: str) -> Iterator[str]:
        kind = self._meant(value)
        yield from kind.faults(value, place) if kind else super().faults(value, place)

    def schema(self) -> dict[str, Any]:
        return {"anyOf": [kind.schema() for kind in self.kinds]}


REQUIRED = object()


@dataclass(frozen=True)
class Key:
    """One key of a table.

    default: Value of the key where it is left out. For a table it may be ``{}``, which is read as a
        table without keys. None means that there is no value, and ``REQUIRED`` that the key must
        not be left out.
    meaning: Description for pages and editors, in Markdown.
    shown: Text that a page shows instead of the default.
    """

    kind: Kind
    default: Any = REQUIRED
    meaning: str = ""
    shown: str = ""


@dataclass(frozen=True)
class KeyTable(Kind):
    """A table with these keys and no others.

    noun: Word, with a blank behind it, that a message puts before the name of a key; empty for
        none.
    name: Name of the table in a message.
    said: What a message expects if the table has other keys or if keys are missing. If it is empty,
        each key is reported by itself.
    either: Pairs of keys of which a table has exactly one.
    """

    keys: Mapping[str, Key]
    noun: str = "key "
    name: str = "a table"
    said: str = ""
    either: tuple[tuple[str, str], ...] = ()

    @property
    def expected(self) -> str:
        return self.name

    def accepts(self, value: object) -> bool:
        return type(value) is dict

    def faults(self, value: Any, place: str) -> Iterator[str]:
        if not self.accepts(value):
            yield got(place, value, self.name)
            return
        needed = {name for name in self.keys if self._needs(name)}
        if self.said and not needed <= set(value) <= set(self.keys):
            yield got(place, value, self.said)
            return
        known, begin = list(self.keys), f"{place}: " if place else ""
        unknown = [name for name in value if name not in self.keys]
        for name in unknown:
            text = f"{self.noun}{name!r} is not known, expected {', '.join(known)}"
            yield f"{begin}{text}{suggest(name, known)}"
        for name, key in self.keys.items():
            where = within(place, name)
            if name in value:
                yield from key.kind.faults(value[name], where)
            # Otherwise it may be the name that is misspelt.
            elif not unknown and key.default is REQUIRED:
                yield f"{where}: missing, expected {key.kind.expected}"
            elif not unknown and isinstance(key.kind, KeyTable) and key.default is not None:
                yield from key.kind.faults(key.default, where)
        for first, other in self.either:
            where = within(place, first)
            if first in value and other in value:
                shown = f"{written(value[other])} beside {where}"
                yield f"{within(place, other)}: got {shown}, expected one of both keys"
            elif not unknown and first not in value and other not in value:
                expected = self.keys[first].kind.expected
                yield f"{where}: missing, expected {expected}, or {within(place, other)}"

    def filled(self, value: Any) -> Any:
        # The keys that are present keep the order of the file.
        left_out = {name: self.keys[name].default for name in self.keys if name not in value}
        present = {**value, **{name: v for name, v in left_out.items() if v is not None}}
        return {name: self.keys[name].kind.filled(v) for name, v in present.items()}

    def schema(self) -> dict[str, Any]:
        properties = {}
        for name, key in self.keys.items():
            properties[name] = key.kind.schema()
            if key.meaning:
                properties[name]["description"] = plain(key.meaning)
            if key.default not in (REQUIRED, None, "", [], {}) and not key.kind.absent:
                properties[name]["default"] = key.default
        found = {"type": "object", "properties": properties, "additionalProperties": False}
        required = [name for name in self.keys if self._needs(name)]
        return found | ({"required": required} if required else {})

    def _needs(self, name: str) -> bool:
        """Whether a file without this key must be refused."""
        key = self.keys[name]
        if isinstance(key.kind, KeyTable) and key.default is not None:
            return key.default is REQUIRED or any(map(key.kind._needs, key.kind.keys))
        return key.default is REQUIRED


def within(place: str, name: str) -> str:
    """The place of a key within the table at ``place``."""
    return f"{place}.{name}" if place else name


def plain(markdown: str) -> str:
    """Markdown without links and code, for an editor that shows it unformatted."""
    return re.sub(r"\[([^][]*)\]\([^()]*\)", r"\1", markdown).replace("`", "")


def read_checked(
    path: Path, table: KeyTable, amend: Callable[[dict[str, Any], Path], None] | None = None
) -> dict[str, Any]:
    """Read every key of a file with its value, check each by itself, and fill in the defaults.

    ``amend`` puts what an older file says into the words of today.
    """
    with reading(path, "TOML"):
        raw = tomllib.loads(path.read_text(encoding="utf-8"))
    if amend:
        amend(raw, path)
    found = [*_long(raw, "")] or [*table.faults(raw, "")]
    if found:
        raise InputError(BETWEEN.join(f"{path}: {fault}" for fault in found))
    return table.filled(raw)


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


# The newest draft that all editors of TOML support.
DRAFT = "http://json-schema.org/draft-07/schema#"


def json_schema(table: KeyTable, title: str) -> str:
    """The contents of the schema's file, a line for each key of each section."""

    def text(value: Any, levels: int) -> str:
        if not levels or not isinstance(value, dict):
            return json.dumps(value, ensure_ascii=False, allow_nan=False)
        inner = ",\n".join(f"{json.dumps(k)}: {text(v, levels - 1)}" for k, v in value.items())
        return f"{{\n{inner}}}"

    # The sections stand under "properties", and so do the keys of each.
    return text({"$schema": DRAFT, "title": title, **table.schema()}, 4) + "\n"


def key_rows(table: KeyTable) -> str:
    """A Markdown table with the key, type, default and meaning of each key."""
    lines = ["| key | type | default | meaning |", "|---|---|---|---|"]
    for name, key in table.keys.items():
        kind = key.kind.name.removeprefix("a ")
        span = f", {key.kind.within}" if key.kind.within else ""
        lines.append(f"| `{name}` | {kind}{span} | {_default(key)} | {key.meaning} |")
    return "\n".join(lines)


def _default(key: Key) -> str:
    if key.shown or key.default is REQUIRED:
        return key.shown
    if isinstance(key.default, bool):
        return str(key.default).lower()
    if isinstance(key.default, str) and key.default:
        return f"`{key.default}`"
    if key.kind.absent or key.default in ("", [], {}):
        return "none"
    return str(key.default)
