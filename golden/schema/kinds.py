"""What a key may hold: each kind tells it in messages, in pages and in JSON schema."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from golden.schema.span import Span
from golden.table import suggest


def got(place: str, value: object, expected: str) -> str:
    """The message of a fault."""
    return f"{place}: got {value!r}, expected {expected}"


class Kind:
    """What a key may hold.

    A file is asked in three steps, since nothing can be asked of a value of another type, and what
    goes with other keys is asked beside ``outside``. ``place`` is what a message begins with.

    Attributes
    ----------
    choices : tuple of str
        The texts that may stand here, where not every text may.
    said : str
        What a message expects in the place of what the kind says by itself.
    absent : bool
        Whether 0 stands for a key that is left out, and is no number that can be asked for.
    """

    choices: tuple[str, ...] = ()
    said: str = ""
    absent: bool = False

    @property
    def name(self) -> str:
        """Of the type, for pages: ``a whole number``."""
        raise NotImplementedError

    @property
    def expected(self) -> str:
        """What a message expects of a value of another type."""
        return self.said or self.name

    def accepts(self, value: object) -> bool:
        """Whether the value is of this type, whatever is in it."""
        raise NotImplementedError

    def strangers(self, value: Any, place: str) -> Iterator[str]:
        """Names within the value that are not known."""
        yield from ()

    def faults(self, value: Any, place: str) -> Iterator[str]:
        """What is missing, of another type, or none of the choices."""
        if not self.accepts(value):
            yield got(place, value, self.expected)

    def outside(self, value: Any, place: str) -> Iterator[str]:
        """Numbers that are too large or too small."""
        yield from ()

    def filled(self, value: Any) -> Any:
        """The value as it is used: with defaults, and a float where a number is expected."""
        return value

    def schema(self) -> dict[str, Any]:
        """The same in JSON schema."""
        raise NotImplementedError

    @property
    def within(self) -> str:
        """Where its numbers may lie, for a page; nothing where any will do."""
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
    """Whatever TOML has, since another part of the file tells what."""

    name: str = field(default="anything", init=False)

    def accepts(self, value: object) -> bool:
        return True

    def schema(self) -> dict[str, Any]:
        return {}


@dataclass(frozen=True)
class Text(Kind):
    """A text.

    Parameters
    ----------
    choices : tuple of str
        Any text where there are none.
    some : bool
        Whether it may not be empty.
    said : str
        What a message expects in the place of ``text`` and of the choices.
    """

    choices: tuple[str, ...] = ()
    some: bool = False
    said: str = ""
    name: str = field(default="text", init=False)

    def accepts(self, value: object) -> bool:
        return type(value) is str and not (self.some and not value)

    def faults(self, value: Any, place: str) -> Iterator[str]:
        yield from super().faults(value, place)
        if self.choices and self.accepts(value) and value not in self.choices:
            expected = self.said or f"one of {', '.join(self.choices)}"
            yield got(place, value, expected) + suggest(value, self.choices)

    def schema(self) -> dict[str, Any]:
        if self.choices:
            return {"enum": list(self.choices)}
        return {"type": "string", **({"minLength": 1} if self.some else {})}


@dataclass(frozen=True)
class Number(Kind):
    """A number; a whole one will do.

    Parameters
    ----------
    span : Span
    said : str
        What a message expects in the place of type and span.
    finite : bool
        Whether NaN and the infinities are no numbers here, whatever the span.
    absent : bool
        Whether 0 stands for a key that is left out, and is no number that can be asked for.
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

    def outside(self, value: Any, place: str) -> Iterator[str]:
        if self.span and not self.span.holds(value) and not (self.absent and value == 0):
            shown = f"{value:g}" if self.absent else repr(value)
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
    """A list of one kind.

    Parameters
    ----------
    of : Kind
    said : str
        What a message expects of what stands in it.
    name : str
    least, most : int
        How many.
    once : bool
        Whether none may stand there twice.
    rising : bool
        Whether none may be less than the one before it.
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
            yield got(place, value, self.said)

    def _sound(self, value: list[Any]) -> bool:
        if any(True for one in value for _ in self.of.faults(one, "")):
            return False
        most = len(value) if self.most is None else self.most
        twice = self.once and len(set(value)) < len(value)
        falling = self.rising and value != sorted(value)
        return self.least <= len(value) <= most and not twice and not falling

    def outside(self, value: Any, place: str) -> Iterator[str]:
        if any(True for one in value for _ in self.of.outside(one, "")):
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
    """One value for all networks of a scene, or a list of one for each."""

    of: Kind

    @property
    def name(self) -> str:
        return f"{self.of.name}, or a list with one for each network"

    def accepts(self, value: object) -> bool:
        return all(self.of.accepts(one) for one in self._all(value))

    def outside(self, value: Any, place: str) -> Iterator[str]:
        if any(True for one in self._all(value) for _ in self.of.outside(one, "")):
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

    Parameters
    ----------
    of : Kind
    names : tuple of str
        Those that may stand there; any where there are none.
    said : str
        What a message expects where anything in it is at fault; each value is told where it is
        empty.
    """

    of: Kind
    names: tuple[str, ...] = ()
    said: str = ""
    name: str = field(default="a table", init=False)

    def accepts(self, value: object) -> bool:
        return type(value) is dict

    def strangers(self, value: Any, place: str) -> Iterator[str]:
        for name, one in value.items() if self.accepts(value) else ():
            yield from self.of.strangers(one, f"{place}.{name}")

    def faults(self, value: Any, place: str) -> Iterator[str]:
        if not self.accepts(value):
            yield got(place, value, self.expected)
        elif self.names and set(value) - set(self.names):
            yield got(place, value, self.said)
        else:
            found = [
                f for name, one in value.items() for f in self.of.faults(one, f"{place}.{name}")
            ]
            yield from self._told(found, value, place)

    def outside(self, value: Any, place: str) -> Iterator[str]:
        found = [f for name, one in value.items() for f in self.of.outside(one, f"{place}.{name}")]
        yield from self._told(found, value, place)

    def _told(self, found: list[str], value: Any, place: str) -> list[str]:
        return [got(place, value, self.said)] if found and self.said else found

    def schema(self) -> dict[str, Any]:
        one = self.of.schema()
        if self.names:
            properties = dict.fromkeys(self.names, one)
            return {"type": "object", "properties": properties, "additionalProperties": False}
        return {"type": "object", "additionalProperties": one}


@dataclass(frozen=True)
class Alternatives(Kind):
    """One of several kinds; of two that accept a value the first is meant.

    Parameters
    ----------
    kinds : tuple of Kind
    said : str
        What a message expects in the place of their names.
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

    def outside(self, value: Any, place: str) -> Iterator[str]:
        kind = self._meant(value)
        yield from kind.outside(value, place) if kind else ()

    def schema(self) -> dict[str, Any]:
        return {"anyOf": [kind.schema() for kind in self.kinds]}
