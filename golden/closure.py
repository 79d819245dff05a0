"""What code does, as text, and which modules take part in it.

A key of the store (``golden/store.py``) has the code by which an answer was found. Words are no
part of that: a comment, a docstring, or an import that moves, runs nothing again.
"""

from __future__ import annotations

import ast
import re
import tokenize
from collections.abc import Callable, Iterable
from functools import cache
from io import StringIO
from pathlib import Path

from golden.fingerprint import ROOT, fingerprint
from golden.folders import ROOMS

# Read as text: to parse all modules would take longer than many a command. Of what only looks like
# an import, as in a docstring, no more comes than a module too many.
IMPORT = re.compile(
    r"^ *(?:from ([\w.]+) import (?:\(([^)]*)\)|([^\n#]*))|import ([^\n#]*))", re.MULTILINE
)
NAME = re.compile(r"(?:^|,)\s*([\w.]+)")
# Modules that import others by names that they compose: all of these packages may be meant.
DISCOVERIES = {
    "golden.networks.designs": ("golden.networks",),
    "golden.network_files.network_file": ("golden.network_files",),
    "hdl.common.lookup": (
        "hdl.activation",
        "hdl.engine",
        "hdl.instruments",
        "hdl.layers",
        "hdl.link",
        "hdl.networks",
        "hdl.sensing",
        "hdl.visualisation",
    ),
}


def everything(importer: str, imported: str) -> bool:
    """Every import is followed."""
    return True


def closure(
    modules: Iterable[str], follow: Callable[[str, str], bool] = everything
) -> dict[str, Path]:
    """Some modules of tactus and all that they import of it, each with its file.

    Parameters
    ----------
    modules : iterable of str
        Names; of a package what its ``__init__`` imports.
    follow : callable
        From who imports and what is imported to whether that takes part.

    Raises
    ------
    ValueError
        For a name that is no module of tactus, as ``__main__``.
    """
    found: dict[str, Path] = {}
    waiting = list(modules)
    for name in waiting:
        if file_of(name) is None:
            raise ValueError(f"{name!r}: no module of {', '.join(ROOMS)}")
    while waiting:
        name = waiting.pop()
        path = file_of(name)
        if path is not None and name not in found:
            found[name] = path
            waiting += [other for other in _imported(name, path) if follow(name, other)]
    return dict(sorted(found.items()))


def code(modules: Iterable[str], follow: Callable[[str, str], bool] = everything) -> str:
    """A digest of what some modules and all that they import do."""
    return digest_of(closure(modules, follow))


def digest_of(modules: dict[str, Path], without: tuple[str, ...] = ()) -> str:
    """A digest of what these modules do, without their constants of some names."""
    return fingerprint([], *(f"{n} {code_of(path, without)}" for n, path in modules.items()))


@cache
def file_of(name: str) -> Path | None:
    """The file of a module of tactus; of any other name nothing."""
    parts = name.split(".")
    if parts[0] not in ROOMS:
        return None
    place = ROOT.joinpath(*parts)
    return next((p for p in (place.with_suffix(".py"), place / "__init__.py") if p.is_file()), None)


@cache
def code_of(path: Path, without: tuple[str, ...] = ()) -> str:
    """The lines of a file without docstrings, comments, imports and empty lines.

    So a module that moves, or whose imports move, is still the same. The lines are taken as they
    stand: what ``ast.unparse`` makes of them differs between versions of Python.

    Parameters
    ----------
    path : Path
    without : tuple of str
        Names of constants that are left out, too.
    """
    text = path.read_text(encoding="utf-8")
    lines = _without_comments(text)
    tree = ast.parse(text)
    named = [node for node in tree.body if _names(node) & set(without)]
    for node in ast.walk(tree):
        if isinstance(node, ast.stmt) and (node in named or _says(node)):
            for number in range(node.lineno, (node.end_lineno or node.lineno) + 1):
                lines[number - 1] = ""
    return "\n".join(line for line in lines if line.strip())


def _without_comments(text: str) -> list[str]:
    lines = text.splitlines()
    if "#" in text:
        for token in tokenize.generate_tokens(StringIO(text).readline):
            if token.type == tokenize.COMMENT:
                row, column = token.start
                lines[row - 1] = lines[row - 1][:column].rstrip()
    return lines


def _says(node: ast.stmt) -> bool:
    """Whether it does nothing: an import, a docstring, or any other constant that nothing takes."""
    text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    return text or isinstance(node, (ast.Import, ast.ImportFrom))


def _names(node: ast.stmt) -> set[str]:
    """What it gives a value to."""
    targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
    return {target.id for target in targets if isinstance(target, ast.Name)}


@cache
def _imported(name: str, path: Path) -> tuple[str, ...]:
    """What a module imports, anywhere in it: a type that it names alone stands for its values."""
    found: list[str] = []
    for module, several, line, plain in IMPORT.findall(path.read_text(encoding="utf-8")):
        if module:
            # Of a package, its modules are imported by name.
            found += [module, *(f"{module}.{n}" for n in NAME.findall(several or line))]
        else:
            found += NAME.findall(plain)
    for package in DISCOVERIES.get(name, ()):
        folder = ROOT.joinpath(*package.split("."))
        found += [f"{package}.{file.stem}" for file in sorted(folder.glob("*.py"))]
    return tuple(dict.fromkeys(found))
