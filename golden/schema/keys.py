"""A table of a TOML file: its keys, each with its kind, its default and what it means."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from golden.schema.kinds import Kind, got
from golden.table import suggest


@dataclass(frozen=True)
class Key:
    """One key.

    Parameters
    ----------
    kind : Kind
    default : object
        What stands in its place where it is left out; None makes it required. A table is read as
        an empty one.
    meaning : str
        For pages and editors, in Markdown.
    shown : str
        What a page shows in the place of the default.
    """

    kind: Kind
    default: Any = None
    meaning: str = ""
    shown: str = ""


@dataclass(frozen=True)
class Table(Kind):
    """A table of these keys and no others.

    Parameters
    ----------
    keys : mapping of str to Key
    noun : str
        What a message calls a key, with a blank behind it; nothing where its name is enough.
    name : str
        What a message calls the table.
    said : str
        What a message expects in the place of a table whose keys are others, or not all there; each
        key is told where it is empty.
    optional : bool
        Whether a file without it has no such thing, and no defaults stand in its place.
    """

    keys: Mapping[str, Key]
    noun: str = "key "
    name: str = "a table"
    said: str = ""
    optional: bool = False

    @property
    def expected(self) -> str:
        return self.name

    def accepts(self, value: object) -> bool:
        return type(value) is dict

    def _inner(self, value: Mapping[str, Any], place: str) -> Iterator[tuple[Kind, Any, str]]:
        """Of the keys that are there: kind, value and place."""
        for name, key in self.keys.items():
            if name in value:
                yield key.kind, value[name], within(place, name)

    def strangers(self, value: Any, place: str) -> Iterator[str]:
        if not self.accepts(value):
            yield got(place, value, self.name)
            return
        known, begin = list(self.keys), f"{place}: " if place else ""
        for name in value:
            if name not in self.keys:
                text = f"{self.noun}{name!r} is not known, expected {', '.join(known)}"
                yield f"{begin}{text}{suggest(name, known)}"
        for kind, inner, where in self._inner(value, place):
            yield from kind.strangers(inner, where)

    def faults(self, value: Any, place: str) -> Iterator[str]:
        needed = {name for name in self.keys if self._needs(name)}
        if self.said and not needed <= set(value) <= set(self.keys):
            yield got(place, value, self.said)
            return
        for name, key in self.keys.items():
            where = within(place, name)
            if name in value:
                yield from key.kind.faults(value[name], where)
            elif isinstance(key.kind, Table) and not key.kind.optional:
                yield from key.kind.faults({}, where)
            elif key.default is None and not isinstance(key.kind, Table):
                yield f"{where}: missing, expected {key.kind.expected}"

    def outside(self, value: Any, place: str) -> Iterator[str]:
        for kind, inner, where in self._inner(value, place):
            yield from kind.outside(inner, where)

    def filled(self, value: Any) -> Any:
        found = {}
        for name, key in self.keys.items():
            if name in value or (isinstance(key.kind, Table) and not key.kind.optional):
                found[name] = key.kind.filled(value.get(name, {}))
            elif not isinstance(key.kind, Table):
                found[name] = key.default
        return found

    def defaults(self) -> dict[str, Any]:
        """The value of every key where all are left out."""
        return {name: key.default for name, key in self.keys.items()}

    def schema(self) -> dict[str, Any]:
        properties = {}
        for name, key in self.keys.items():
            properties[name] = key.kind.schema()
            if key.meaning:
                properties[name]["description"] = plain(key.meaning)
            if key.default not in (None, "", [], {}) and not key.kind.absent:
                properties[name]["default"] = key.default
        found = {"type": "object", "properties": properties, "additionalProperties": False}
        required = [name for name in self.keys if self._needs(name)]
        return found | ({"required": required} if required else {})

    def _needs(self, name: str) -> bool:
        """Whether a file without this key is refused."""
        kind = self.keys[name].kind
        if isinstance(kind, Table):
            return not kind.optional and any(kind._needs(inner) for inner in kind.keys)
        return self.keys[name].default is None


def within(place: str, name: str) -> str:
    """The place of a key in what stands at ``place``."""
    return f"{place}.{name}" if place else name


def plain(markdown: str) -> str:
    """Markdown without links and code, for an editor that shows it as it stands."""
    return re.sub(r"\[([^][]*)\]\([^()]*\)", r"\1", markdown).replace("`", "")
