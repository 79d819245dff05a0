"""A table of a TOML file: its keys, each with a kind, a default and a meaning."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from golden.input_error import suggest
from tactus.core.schema.kinds import Kind, got

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
    """

    keys: Mapping[str, Key]
    noun: str = "key "
    name: str = "a table"
    said: str = ""

    @property
    def expected(self) -> str:
        return self.name

    def accepts(self, value: object) -> bool:
        return type(value) is dict

    def _inner(self, value: Mapping[str, Any], place: str) -> Iterator[tuple[Kind, Any, str]]:
        """Kind, value and place of each key that is present."""
        for name, key in self.keys.items():
            if name in value:
                yield key.kind, value[name], within(place, name)

    def unknown_keys(self, value: Any, place: str) -> Iterator[str]:
        if not self.accepts(value):
            yield got(place, value, self.name)
            return
        known, begin = list(self.keys), f"{place}: " if place else ""
        for name in value:
            if name not in self.keys:
                text = f"{self.noun}{name!r} is not known, expected {', '.join(known)}"
                yield f"{begin}{text}{suggest(name, known)}"
        for kind, inner, where in self._inner(value, place):
            yield from kind.unknown_keys(inner, where)

    def faults(self, value: Any, place: str) -> Iterator[str]:
        needed = {name for name in self.keys if self._needs(name)}
        if self.said and not needed <= set(value) <= set(self.keys):
            yield got(place, value, self.said)
            return
        for name, key in self.keys.items():
            where = within(place, name)
            if name in value:
                yield from key.kind.faults(value[name], where)
            elif key.default is REQUIRED:
                yield f"{where}: missing, expected {key.kind.expected}"
            elif isinstance(key.kind, KeyTable) and key.default is not None:
                yield from key.kind.faults(key.default, where)

    def range_errors(self, value: Any, place: str) -> Iterator[str]:
        for kind, inner, where in self._inner(value, place):
            yield from kind.range_errors(inner, where)

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
