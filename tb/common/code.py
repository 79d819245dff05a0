"""The code of a bench as a text that changes only if the bench then does something else.

It leaves out comments, docstrings and layout, and of ``tb`` it holds only what the bench imports.
So no bench runs again because a page, the report or another bench has changed.
"""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

from golden.fingerprint import ROOT, fingerprint, sources

# The content of these enters the exported files, which have digests of their own.
ELSEWHERE = ("tb.common.cases", "tb.common.small")
NAMES = ("CASES", "FAULTS")


def bench_code(area: str, block: str) -> str:
    """A digest of a bench, of what it imports from ``tb``, and of the twins."""
    modules = bench_modules(area, block)
    return fingerprint([], twins(), *(f"{name} {modules[name]}" for name in sorted(modules)))


def bench_modules(area: str, block: str) -> dict[str, str]:
    """The code of a bench and of what it imports from ``tb``, by module."""
    found: dict[str, str] = {}
    waiting = [f"tb.{area}.tb_{block}"]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found[name], imported = _module(name)
            waiting += imported
    return found


@cache
def twins() -> str:
    """A digest of all of ``golden``, since every bench loads a scene, which may use any twin."""
    return fingerprint([], *(_code(ast.parse(f.read_text("utf-8"))) for f in sources("golden")))


@cache
def _module(name: str) -> tuple[str, list[str]]:
    """The code of a module of ``tb``, and what it imports. Other modules give nothing."""
    path = ROOT.joinpath(*name.split(".")).with_suffix(".py")
    if not name.startswith("tb.") or name in ELSEWHERE or not path.exists():
        return "", []
    tree = ast.parse(path.read_text(encoding="utf-8"))
    imported = []
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            # The names may be modules of a package.
            imported += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    return _code(tree), imported


def code_of(path: Path) -> str:
    """The lines of a file without docstrings, imports, empty lines, and comments of whole lines.

    So a module stays the same if it moves, or if its imports move. The lines are kept as they are
    written, because the output of ``ast.unparse`` differs between versions of Python.
    """
    text = path.read_text(encoding="utf-8")
    lines = text.splitlines()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.Import, ast.ImportFrom)) or (
            isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        ):
            for number in range(node.lineno, (node.end_lineno or node.lineno) + 1):
                lines[number - 1] = ""
    return "\n".join(line for line in lines if line.strip() and not line.lstrip().startswith("#"))


def _code(tree: ast.Module) -> str:
    """The statements of a module without docstrings, comments, ``CASES`` and ``FAULTS``."""
    kept = [node for node in tree.body if not _named(node)]
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            first = node.body[0] if node.body else None
            if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
                first.value.value = ""
    return "\n".join(map(ast.unparse, kept))


def _named(node: ast.stmt) -> bool:
    """Whether a statement assigns the cases or the faults of a bench."""
    return isinstance(node, ast.Assign) and any(
        isinstance(target, ast.Name) and target.id in NAMES for target in node.targets
    )
