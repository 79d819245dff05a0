"""Reads the TOML files of users by a declaration of their keys, which is a TOML file too.

A declaration, such as ``tactus/scene/keys.toml``, speaks the words of JSON Schema, and a few more.
From it come the check of a file with its messages, the values of keys that are left out, the JSON
schema with which an editor completes and checks a file, and the tables of keys in the pages. The
code that reads a file checks whatever else involves several keys, or another file.

A table of the declaration is a section, or a key, for which ``rule`` holds words in one line. A key
without ``default`` is required, unless it is ``optional``, which gives it no value. A default that
may not stand in the file, or is empty, means none. The words beside those of JSON Schema are:

- ``expected``: what a message expects where the program's own words would not do.
- ``either``: pairs of keys of which a table has exactly one.
- ``rising``: no value of a list may be less than the one before it.
- ``begins``: a text that begins so is allowed beside those of ``enum``. The program may know these.
- ``only``: what other keys must be if this one is set: a list of values, which is empty where there
  must be none, or ``"any"``. ``because`` is the reason.
- ``name``: the type as a page and a message call it; ``shown``: the default as a page shows it.

No library does all of this. jsonschema and pydantic check types, ranges and unknown names. But they
report a fault once for each kind that a key may have, name the place of a value within a list and
not the list, and say neither what was expected of a missing key nor which name is the nearest.
"""

import json
import math
import operator
import re
import tomllib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from golden.input_error import InputError, suggest
from tactus.core.cli import BETWEEN
from tactus.core.files import reading

# What is declared of a key or of a table of keys.
Rule = dict[str, Any]
TYPES: dict[str, tuple[type, ...]] = {
    "string": (str,),
    "integer": (int,),
    "number": (int, float),
    "boolean": (bool,),
    "array": (list,),
    "object": (dict,),
}
NAMES = {"string": "text", "integer": "a whole number", "number": "a number", "array": "a list"}
NAMES |= {"boolean": "true or false", "object": "a table", "": "anything"}
SEVERAL = {"string": " of texts", "integer": " of whole numbers", "number": " of numbers"}
LIMITS = {
    "minimum": operator.ge,
    "maximum": operator.le,
    "exclusiveMinimum": operator.gt,
    "exclusiveMaximum": operator.lt,
}
# The words that an editor does not know.
OWN = {"only", "because", "optional", "expected", "either", "rising", "begins", "name", "shown"}


def load_keys(path: Path, **known: Sequence[str]) -> Rule:
    """Read a declaration. For an ``enum`` it may give the name of a list of ``known`` texts."""

    def rule_of(one: Any) -> Any:
        if isinstance(one, list):
            return list(map(rule_of, one))
        if not isinstance(one, dict):
            return one
        found = {word: rule_of(value) for word, value in (one.pop("rule", {}) | one).items()}
        if isinstance(found.get("enum"), str):
            found["enum"] = list(known[found["enum"]])
        for word in ("description", "expected", "shown"):
            if isinstance(found.get(word), str):
                found[word] = " ".join(found[word].split())
        return found

    def section(one: Rule) -> Rule:
        tables = (name for name in one if name != "only" and isinstance(one[name], dict))
        keys = {name: rule_of(one[name]) for name in tables}
        facts = {word: value for word, value in one.items() if word not in keys}
        empty = {} if "optional" in one else {"default": dict[str, Any]()}
        return {"type": "object", **empty, **facts, "properties": keys}

    sections = tomllib.loads(path.read_text(encoding="utf-8"))
    return {"type": "object", "properties": {n: section(one) for n, one in sections.items()}}


def got(place: str, value: object, expected: str) -> str:
    """The message of a fault."""
    return f"{place}: got {written(value)}, expected {expected}"


def written(value: object, read: bool = False) -> str:
    """A value as it is written in a TOML file.

    read: Whether it is one of ``filled``, where a whole number may have become a float.
    """
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list):
        return f"[{', '.join(written(one, read) for one in value)}]"
    if isinstance(value, dict) and value:
        parts = (f"{name} = {written(one, read)}" for name, one in value.items())
        return f"{{ {', '.join(parts)} }}"
    return repr(value).removesuffix(".0") if read else repr(value)


def named(rule: Rule) -> str:
    """The type of a key in words, such as ``a whole number``."""
    if "name" in rule:
        return str(rule["name"])
    if "anyOf" in rule:
        return " or ".join(map(named, rule["anyOf"]))
    several = SEVERAL.get(rule.get("items", {}).get("type", ""), "")
    return NAMES[rule.get("type", "")] + several


def limits(rule: Rule) -> str:
    """The range of a number in words; empty if there is none."""
    least, most, above, below = map(rule.get, LIMITS)
    if least is not None:
        if most is None and below is None:
            return f"{least:g} or more"
        return f"{least:g} to " + (f"{most:.10g}" if below is None else f"below {below:g}")
    ends = {"above {:g}": above, "below {:g}": below, "{:.10g} at most": most}
    return " and ".join(text.format(end) for text, end in ends.items() if end is not None)


def _of_type(rule: Rule) -> str:
    """What a message expects instead of a value of another type."""
    of_contents = rule.get("type") in ("array", "object")
    known = "" if of_contents else rule.get("expected", "")
    return known or ", ".join(filter(None, [named(rule), limits(rule)]))


def fits(rule: Rule, value: Any) -> bool:
    """Whether a value has the type of a key, whatever it contains."""
    if "anyOf" in rule:
        return any(fits(one, value) for one in rule["anyOf"])
    if "type" not in rule:
        return True
    finite = type(value) is not float or math.isfinite(value)
    empty = "minLength" in rule and not value
    return type(value) in TYPES[rule["type"]] and finite and not empty


def _allowed(rule: Rule, value: Any) -> bool:
    """Whether a text or a number is one of those that a key takes."""
    if any(word in rule and not holds(value, rule[word]) for word, holds in LIMITS.items()):
        return False
    begun = "begins" in rule and value.startswith(rule["begins"])
    return value in rule.get("enum", [value]) or begun


def faults(rule: Rule, value: Any, place: str) -> Iterator[str]:
    """Messages, which begin with ``place``, for all that is wrong with a value."""
    alternatives = rule.get("anyOf", [rule])
    meant = next((one for one in alternatives if fits(one, value)), None)
    kind = rule.get("type", "")
    if meant is None:
        yield got(place, value, _of_type(rule))
    elif meant is not rule:
        known = {"expected": rule["expected"]} if "expected" in rule and not limits(meant) else {}
        yield from faults(known | meant, value, place)
    elif kind == "object":
        yield from _faults_of_table(rule, value, place)
    elif kind == "array":
        yield from _faults_of_list(rule, value, place)
    elif not _allowed(rule, value):
        choices = rule.get("enum", [])
        expected = rule.get("expected") or limits(rule) or f"one of {', '.join(choices)}"
        left_out = ", or no such key" if value == rule.get("default") else ""
        yield got(place, value, expected + left_out) + (suggest(value, choices) if choices else "")


def _faults_of_list(rule: Rule, value: list[Any], place: str) -> Iterator[str]:
    of, expected = rule["items"], rule.get("expected") or named(rule)
    wrong = [one for one in value if any(faults(of, one, place))]
    if wrong and "enum" in of and fits(of, wrong[0]):
        yield from faults(of, wrong[0], place)
    elif wrong and all(fits(of, one) for one in wrong):
        yield got(place, value, of.get("expected") or expected)
    elif (
        wrong
        or not rule.get("minItems", 0) <= len(value) <= rule.get("maxItems", len(value))
        or (rule.get("uniqueItems") and len(set(value)) < len(value))
        or (rule.get("rising") and value != sorted(value))
    ):
        yield got(place, value, expected)


def _faults_of_table(rule: Rule, value: dict[str, Any], place: str) -> Iterator[str]:
    if "properties" not in rule:
        for name, one in value.items():
            yield from faults(rule["additionalProperties"], one, within(place, name))
        return
    keys = rule["properties"]
    if "expected" in rule and not set(_required(rule)) <= set(value) <= set(keys):
        yield got(place, value, rule["expected"])
        return
    unknown = [name for name in value if name not in keys]
    for name in unknown:
        what = "key" if place or not isinstance(value[name], dict) else "section"
        text = f"{what} {name!r} is not known, expected {', '.join(keys)}"
        yield ": ".join(filter(None, (place, text))) + suggest(name, list(keys))
    for name, key in keys.items():
        where = within(place, name)
        if name in value:
            yield from faults(key, value[name], where)
        # Otherwise it may be the name that is misspelt.
        elif not unknown and "default" not in key and not key.get("optional"):
            yield f"{where}: missing, expected {_of_type(key)}"
        elif not unknown and "properties" in key and "default" in key:
            yield from faults(key, key["default"], where)
    for first, other in rule.get("either", ()):
        where, beside = within(place, first), within(place, other)
        if first in value and other in value:
            yield f"{beside}: got {written(value[other])} beside {where}, expected one of both keys"
        elif not unknown and first not in value and other not in value:
            yield f"{where}: missing, expected {_of_type(keys[first])}, or {beside}"


def clashes(rule: Rule, values: dict[str, Any]) -> Iterator[str]:
    """Messages for keys of a file's sections that do not go together; see ``only``."""
    keys: dict[str, tuple[Rule, Any]] = {}
    for section, table in rule["properties"].items():
        for name, key in table["properties"].items():
            keys[f"{section}.{name}"] = key, values.get(section, {}).get(name)
        keys[section] = table, values.get(section)
    given = {place for place, (key, v) in keys.items() if v not in (None, key.get("default"))}
    for place, (key, value) in keys.items():
        for other, known in key.get("only", {}).items() if place in given else ():
            of, there = keys[other]
            there = "" if there is None else there
            if known == "any":
                choices = f"one of {', '.join(of['enum'])}" if "enum" in of else _of_type(of)
                good, expected = other in given, choices if "." in other else f"a section [{other}]"
            else:
                good = there in known if known else other not in given
                texts = [written(one, read=True) for one in known if one != ""]
                expected = " or ".join(texts) or "no such key"
            if not good:
                shown = "none" if there in ("", [], {}) else written(there, read=True)
                of_key = f"{place} {written(value, read=True)}"
                beside = of_key if "." in place else f"a section [{place}]"
                because = f": {key['because']}" if "because" in key else ""
                yield f"{other}: got {shown} with {beside}, expected {expected}{because}"


def _required(rule: Rule) -> list[str]:
    """The keys without which a table must be refused."""
    keys = rule.get("properties", {})
    return [
        name
        for name, key in keys.items()
        if not key.get("optional") and ("default" not in key or _required(key))
    ]


def within(place: str, name: str) -> str:
    """The place of a key within the table at ``place``."""
    return f"{place}.{name}" if place else name


def filled(rule: Rule, value: Any) -> Any:
    """A value as it is used: with defaults, and as a float where a number is expected."""
    if "anyOf" in rule:
        return filled(next(one for one in rule["anyOf"] if fits(one, value)), value)
    if rule.get("type") == "number":
        return float(value)
    if rule.get("type") == "array":
        return [filled(rule["items"], one) for one in value]
    if "additionalProperties" in rule:
        return {name: filled(rule["additionalProperties"], one) for name, one in value.items()}
    if "properties" not in rule:
        return value
    # The keys that are present keep the order of the file.
    keys = rule["properties"]
    left_out = {n: key["default"] for n, key in keys.items() if n not in value and "default" in key}
    return {name: filled(keys[name], one) for name, one in (value | left_out).items()}


def read_checked(
    path: Path, rule: Rule, amend: Callable[[dict[str, Any], Path], None] | None = None
) -> dict[str, Any]:
    """Read every key of a file with its value, check each by itself, and fill in the defaults.

    ``amend`` puts what an older file says into the words of today.
    """
    with reading(path, "TOML"):
        raw = tomllib.loads(path.read_text(encoding="utf-8"))
    if amend:
        amend(raw, path)
    if found := [*_long(raw, "")] or [*faults(rule, raw, "")]:
        raise InputError(BETWEEN.join(f"{path}: {fault}" for fault in found))
    return dict(filled(rule, raw))


def _long(value: Any, place: str) -> Iterator[str]:
    """Messages for whole numbers beyond the 64 bits of TOML; others have a text and a float."""
    if isinstance(value, (dict, list)):
        inner = value.items() if isinstance(value, dict) else ((None, one) for one in value)
        for key, one in inner:
            yield from _long(one, within(place, key) if key else place)
    elif isinstance(value, int) and not -(1 << 63) <= value < 1 << 63:
        yield f"{place}: got a number of {value.bit_length()} bits, expected 63 at most"


def has_default(rule: Rule) -> bool:
    """Whether a reader is told what stands for a missing key."""
    default = rule.get("default", "")
    return default not in ("", [], {}) and not any(faults(rule, default, ""))


def standard(rule: Rule) -> Rule:
    """A rule in the words of JSON Schema alone."""
    found = {word: value for word, value in rule.items() if word not in OWN}
    for word in ("items", "additionalProperties"):
        if word in rule:
            found[word] = standard(rule[word])
    if "anyOf" in rule:
        found["anyOf"] = list(map(standard, rule["anyOf"]))
    if "properties" in rule:
        found["properties"] = {n: standard(key) for n, key in rule["properties"].items()}
        found |= {"additionalProperties": False, "required": _required(rule)}
    if "begins" in rule:
        other = {"type": "string", "pattern": f"^{rule['begins']}"}
        found = {"anyOf": [found, other]}
    if "default" in rule and not has_default(rule):
        del found["default"]
    if "description" in rule:
        # An editor shows text without the links and the code of Markdown.
        plain = re.sub(r"\[([^][]*)\]\([^()]*\)", r"\1", rule["description"])
        found["description"] = plain.replace("`", "")
    return found


def json_schema(rule: Rule, title: str) -> str:
    """The contents of the schema's file, a line for each key of each section."""

    def text(value: Any, levels: int) -> str:
        if not levels or not isinstance(value, dict):
            return json.dumps(value, ensure_ascii=False, allow_nan=False)
        inner = ",\n".join(f"{json.dumps(k)}: {text(v, levels - 1)}" for k, v in value.items())
        return f"{{\n{inner}}}"

    # The newest draft that all editors of TOML support.
    begin = {"$schema": "http://json-schema.org/draft-07/schema#", "title": title}
    # The sections stand under "properties", and so do the keys of each.
    return text(begin | standard(rule), 4) + "\n"


def key_rows(rule: Rule) -> str:
    """A Markdown table with the key, type, default and meaning of each key."""
    lines = ["| key | type | default | meaning |", "|---|---|---|---|"]
    for name, key in rule["properties"].items():
        one = key.get("anyOf", [key])[0]
        each = f"each {limits(one['items'])}" if limits(one.get("items", {})) else ""
        kind = ", ".join(filter(None, [named(key).removeprefix("a "), limits(one) or each]))
        lines.append(f"| `{name}` | {kind} | {_default(key)} | {key['description']} |")
    return "\n".join(lines)


def _default(rule: Rule) -> str:
    if "shown" in rule or "default" not in rule:
        return str(rule.get("shown", ""))
    if not has_default(rule):
        return "none"
    default = rule["default"]
    return f"`{default}`" if isinstance(default, str) else written(default)
