"""Digests of code: of some modules and of everything that they import.

A key of the store (``golden/store.py``) holds a digest of the code that found the answer. Comments,
docstrings and imports are no part of this digest, so a change of these computes nothing again.
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

# Imports are found by this pattern, because parsing all modules would take longer than many
# commands. A line of a docstring that looks like an import only adds a module to the closure.
IMPORT = re.compile(
    r"^ *(?:from ([\w.]+) import (?:\(([^)]*)\)|([^\n#]*))|import ([^\n#]*))", re.MULTILINE
)
NAME = re.compile(r"(?:^|,)\s*([\w.]+)")
# These modules compose the names of modules that they import. Each may import any module of the
# packages that are listed.
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
    """Follow every import."""
    return True


def closure(
    modules: Iterable[str], follow: Callable[[str, str], bool] = everything
) -> dict[str, Path]:
    """Some modules of tactus, and all modules of tactus that they import, with their files.

    Parameters
    ----------
    modules : iterable of str
        Names of modules. The name of a package stands for its ``__init__``.
    follow : callable
        Says, for the names of an importing and an imported module, whether the second takes part.

    Raises
    ------
    ValueError
        For a name that is no module of tactus, such as ``__main__``.
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
    """A digest of the code of some modules and of everything that they import."""
    return digest_of(closure(modules, follow))


def digest_of(modules: dict[str, Path], without: tuple[str, ...] = ()) -> str:
    """A digest of the code of these modules, without the constants that ``without`` names."""
    return fingerprint([], *(f"{n} {code_of(path, without)}" for n, path in modules.items()))


@cache
def file_of(name: str) -> Path | None:
    """The file of a module of tactus, or None for any other name."""
    parts = name.split(".")
    if parts[0] not in ROOMS:
        return None
    place = ROOT.joinpath(*parts)
    return next((p for p in (place.with_suffix(".py"), place / "__init__.py") if p.is_file()), None)


@cache
def code_of(path: Path, without: tuple[str, ...] = ()) -> str:
    """The lines of a file without docstrings, comments, imports and empty lines.

    So a module stays the same when it or one of its imports moves. The lines are taken as they are,
    because the output of ``ast.unparse`` differs between versions of Python.

    Parameters
    ----------
    path : Path
    without : tuple of str
        Names of constants that are left out as well.
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
    """Whether a statement does nothing: an import, a docstring, or another unused constant."""
    text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    return text or isinstance(node, (ast.Import, ast.ImportFrom))


def _names(node: ast.stmt) -> set[str]:
    """The names to which a statement assigns."""
    targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
    return {target.id for target in targets if isinstance(target, ast.Name)}


@cache
def _imported(name: str, path: Path) -> tuple[str, ...]:
    """The modules that a module imports anywhere, also those that it needs for types alone."""
    found: list[str] = []
    for module, several, line, plain in IMPORT.findall(path.read_text(encoding="utf-8")):
        if module:
            # A name that is imported from a package may be one of its modules.
            found += [module, *(f"{module}.{n}" for n in NAME.findall(several or line))]
        else:
            found += NAME.findall(plain)
    for package in DISCOVERIES.get(name, ()):
        folder = ROOT.joinpath(*package.split("."))
        found += [f"{package}.{file.stem}" for file in sorted(folder.glob("*.py"))]
    return tuple(dict.fromkeys(found))
