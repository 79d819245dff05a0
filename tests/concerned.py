"""Which tests concern a block: ``make test BLOCK=precise``.

These are the tests of which a parameter is the block, its twin, its bench, or the page of its
datasheet; those of the file named after it; and those that call its twin or its hardware, unless
they simulate or synthesise whatever there is. The site, which takes longer than all of these, is
left to ``make docs``.
"""

import inspect
from collections.abc import Collection, Iterator
from functools import cache
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import pytest

from tactus.core.fingerprint import ROOT


def concerns(item: pytest.Item, block: str, long: Collection[str]) -> bool:
    """Whether a test concerns a block; ``long`` names the files that simulate or synthesise."""
    if item.path.stem == "test_site":
        return False
    parameters = item.callspec.params if hasattr(item, "callspec") else {}
    if block in names(list(parameters.values())):
        return True
    if item.path.stem in long:
        return False
    return item.path.stem == f"test_{block}" or calls(inspect.unwrap(item.function), rooms(block))


def names(value: Any) -> set[str]:
    """The blocks that a test's parameter may stand for."""
    if isinstance(value, str):
        return {value}
    if isinstance(value, Path):
        return {value.stem.removeprefix("tb_")}
    if isinstance(value, tuple | list):
        return {name for part in value for name in names(part)}
    return {name for known in ("block", "page") for name in names(getattr(value, known, []))}


@cache
def rooms(block: str) -> frozenset[str]:
    """The modules of a block: its twin and its hardware."""
    found = (path.relative_to(ROOT).with_suffix("") for path in ROOT.glob(f"*/*/{block}.py"))
    return frozenset(".".join(path.parts) for path in found)


def calls(function: FunctionType, modules: Collection[str]) -> bool:
    """Whether a function, or a function of its file that it calls, names what is of a module."""
    left, seen = [function], {function}
    while left:
        one = left.pop()
        for name in named(one.__code__):
            value = one.__globals__.get(name)
            home = value.__name__ if isinstance(value, ModuleType) else _home(value)
            if home in modules:
                return True
            if isinstance(value, FunctionType) and home == function.__module__:
                left += {value} - seen
                seen.add(value)
    return False


def _home(value: Any) -> str:
    return str(getattr(value, "__module__", ""))


def named(code: CodeType) -> Iterator[str]:
    """The names that a function uses, and those of what is defined in it."""
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from named(constant)
