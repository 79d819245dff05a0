"""Digests of code: of some modules and of everything that they import.

A key of the store (``tactus/core/store.py``) holds a digest of the code that found the answer.
Comments, docstrings and imports are no part of this digest, so a change of these computes nothing
again. The keys that a module declares in the TOML file beside it are a part of its code.
"""

import re
import tokenize
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from io import StringIO
from pathlib import Path

from tactus.core.fingerprint import ROOT, fingerprint
from tactus.core.folders import ROOMS

# Imports are found by this pattern, because parsing all modules would take longer than many
# commands. A line of a docstring that looks like an import only adds a module to the closure.
IMPORT = re.compile(
    r"^ *(?:from ([\w.]+) import (?:\(([^)]*)\)|([^\n#]*))|import ([^\n#]*))", re.MULTILINE
)
# Says, for the names of an importing and an imported module, whether the second takes part.
Follow = Callable[[str, str], bool]
NAME = re.compile(r"(?:^|,)\s*([\w.]+)")
LAYOUT = {tokenize.NL, tokenize.INDENT, tokenize.DEDENT}
# The packages of blocks, in each room.
AREAS = (
    *("activation", "engine", "instruments", "layers", "link", "networks", "sensing"),
    "visualisation",
)
# These modules compose the names of modules that they import. Each may import any module of the
# packages that are listed.
DISCOVERIES = {
    "golden.activation.schemes": ("golden.activation",),
    "golden.networks.designs": ("golden.networks",),
    "tactus.network_files.network_file": ("tactus.network_files",),
    "hdl.common.lookup": tuple(f"hdl.{area}" for area in AREAS),
}


def closure(modules: Iterable[str], follow: Follow | None = None) -> dict[str, Path]:
    """Some modules of tactus, and all modules of tactus that they import, with their files.

    modules: Names of modules. The name of a package stands for its ``__init__``.
    follow: Which imports are followed; by default all.
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
            others = imported_by(name, path)
            waiting += [other for other in others if follow is None or follow(name, other)]
    return dict(sorted(found.items()))


def code(modules: Iterable[str], follow: Follow | None = None) -> str:
    """A digest of the code of some modules and of everything that they import."""
    return digest_of(closure(modules, follow))


def digest_of(modules: dict[str, Path], without: tuple[str, ...] = ()) -> str:
    """A digest of the code of these modules, without the constants that ``without`` names."""
    return fingerprint([], *sorted(code_of(path, without) for path in modules.values()))


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
    """The lines of a module without docstrings, comments, imports and empty lines.

    So a module stays the same when it or one of its imports moves. The lines are taken as they are,
    because the output of ``ast.unparse`` differs between versions of Python. The file is read token
    by token, because ``ast.parse`` of Python 3.11 fails at times when two threads call it: "AST
    constructor recursion depth mismatch", https://github.com/python/cpython/issues/106905.

    without: Names of constants that are left out as well.
    """
    text = path.read_text(encoding="utf-8")
    lines = text.splitlines()
    statement: list[tokenize.TokenInfo] = []
    for token in tokenize.generate_tokens(StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            row, column = token.start
            lines[row - 1] = lines[row - 1][:column].rstrip()
        elif token.type == tokenize.NEWLINE:
            if _does_nothing(statement) or _assigns(statement) in without:
                for row in range(statement[0].start[0], statement[-1].end[0] + 1):
                    lines[row - 1] = ""
            statement = []
        elif token.type not in LAYOUT:
            statement.append(token)
    declared = path.with_suffix(".toml")
    if "load_keys(" in text and declared.is_file():
        lines += declared.read_text(encoding="utf-8").splitlines()
    return "\n".join(line for line in lines if line.strip())


def _does_nothing(statement: Sequence[tokenize.TokenInfo]) -> bool:
    """Whether a statement is an import or a docstring."""
    said = all(token.type == tokenize.STRING for token in statement)
    return said or statement[0].string in {"import", "from"}


def _assigns(statement: Sequence[tokenize.TokenInfo]) -> str | None:
    """The name of the constant of a module to which a statement assigns."""
    name, *after = statement
    constant = name.start[1] == 0 and after and after[0].string in {"=", ":"}
    return name.string if constant else None


@cache
def imported_by(name: str, path: Path) -> tuple[str, ...]:
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
