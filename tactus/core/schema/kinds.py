"""The kinds of values, and how each appears in messages, in pages and in a JSON schema."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from golden.input_error import suggest
from tactus.core.schema.span import Span


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

    A file is checked in three steps: ``unknown_keys``, ``faults`` and ``range_errors``. The order
    matters, because a value of the wrong type cannot be checked further. Rules between keys are
    checked together with ``range_errors``. ``place`` is the beginning of a message.

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

    def unknown_keys(self, value: Any, place: str) -> Iterator[str]:
        """Messages for unknown names within the value."""
        yield from ()

    def faults(self, value: Any, place: str) -> Iterator[str]:
        """Messages for what is missing, has another type, or is none of the choices."""
        if not self.accepts(value):
            yield got(place, value, self.expected)

    def range_errors(self, value: Any, place: str) -> Iterator[str]:
        """Messages for numbers that are too large or too small."""
        yield from ()

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

    choices: The texts that are allowed; empty where every text is.
    some: Whether the text must not be empty.
    said: What a message expects, instead of ``text`` or the choices.
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

    said: What a message expects, instead of type and span.
    finite: Whether NaN and the infinities are refused, whatever the span.
    absent: Whether 0 means that the key is left out, so that 0 itself cannot be requested.
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
            yield f"{place}: got {value:g}, expected a number above 0, or no such key"

    def range_errors(self, value: Any, place: str) -> Iterator[str]:
        if self.span and not self.span.holds(value) and not (self.absent and value == 0):
            shown = f"{value:.10g}" if self.absent else repr(value)
            yield f"{place}: got {shown}, expected {self.said or self.span}"

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
        if self.accepts(value) and not self._sound(value):
            # Of the right type, but none of the choices: this fault names the nearest choice.
            named = [f for v in value if self.of.accepts(v) for f in self.of.faults(v, place)]
            yield named[0] if named else got(place, value, self.said)

    def _sound(self, value: list[Any]) -> bool:
        if any(True for one in value for _ in self.of.faults(one, "")):
            return False
        most = len(value) if self.most is None else self.most
        twice = self.once and len(set(value)) < len(value)
        falling = self.rising and value != sorted(value)
        return self.least <= len(value) <= most and not twice and not falling

    def range_errors(self, value: Any, place: str) -> Iterator[str]:
        if any(True for one in value for _ in self.of.range_errors(one, "")):
            yield got(place, value, self.of.said or self.said)

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

    def range_errors(self, value: Any, place: str) -> Iterator[str]:
        if any(True for one in self._all(value) for _ in self.of.range_errors(one, "")):
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

    def unknown_keys(self, value: Any, place: str) -> Iterator[str]:
        for name, one in value.items() if self.accepts(value) else ():
            yield from self.of.unknown_keys(one, f"{place}.{name}")

    def faults(self, value: Any, place: str) -> Iterator[str]:
        if not self.accepts(value):
            yield got(place, value, self.expected)
        elif self.names and set(value) - set(self.names):
            yield got(place, value, self.said)
        else:
            found = [
                f for name, one in value.items() for f in self.of.faults(one, f"{place}.{name}")
            ]
            yield from self._summarised(found, value, place)

    def range_errors(self, value: Any, place: str) -> Iterator[str]:
        found = [
            f for name, one in value.items() for f in self.of.range_errors(one, f"{place}.{name}")
        ]
        yield from self._summarised(found, value, place)

    def _summarised(self, found: list[str], value: Any, place: str) -> list[str]:
        return [got(place, value, self.said)] if found and self.said else found

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

    def range_errors(self, value: Any, place: str) -> Iterator[str]:
        kind = self._meant(value)
        yield from kind.range_errors(value, place) if kind else ()

    def schema(self) -> dict[str, Any]:
        return {"anyOf": [kind.schema() for kind in self.kinds]}
