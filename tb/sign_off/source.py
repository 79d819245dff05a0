"""What a record is of: the Verilog of an entity, and what its bench played on it.

A bench is told by its trace and not by its text: what each test drove, in which clocks it looked at
which port, and how many results it compared. So a function that moves makes no record stale, and
another stimulus does. Whoever runs a bench compares its trace with the records
(``tb/sign_off/current.py``). What keeps results of benches has to know before they run, so it asks
for their code (``bench``).
"""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path
from typing import Any

from hdl.synth.tools import digest
from tb.common.runner import ROOT, Job

# What these say is in the Verilog.
ELSEWHERE = ("tb.common.cases", "tb.common.small")
NAMES = ("CASES", "FAULTS")


# In a record: all tests of the bench were played.
EVERY = "all"


def verilog(job: Job) -> str:
    """A digest of the code in the files of a job, whatever their comments say."""
    return digest(job.hdl_folder, sorted(job.files))


def source(job: Job, played: dict[str, str]) -> dict[str, Any]:
    """The fields of a record that tell what it is of.

    Parameters
    ----------
    job : Job
        The entity on its exported Verilog.
    played : dict of str
        By test: the digest of its trace, as the facts of an ``Outcome`` have it.
    """
    return {"verilog": verilog(job), "played": played}


def bench(area: str, block: str) -> str:
    """The code of a bench and of what it imports from ``tb``, without its cases and docstrings."""
    modules = bench_modules(area, block)
    return "\n".join(f"{name}\n{modules[name]}" for name in sorted(modules))


def bench_modules(area: str, block: str) -> dict[str, str]:
    """The same by module; of what is not from ``tb`` nothing but the name."""
    found: dict[str, str] = {}
    waiting = [f"tb.{area}.tb_{block}"]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found[name], imported = _module(name)
            waiting += imported
    return found


@cache
def _module(name: str) -> tuple[str, list[str]]:
    """The code of a module of ``tb``, and what it imports; of any other module nothing."""
    path = _file(name)
    if not name.startswith("tb.") or name in ELSEWHERE or not path.exists():
        return "", []
    tree = ast.parse(path.read_text(encoding="utf-8"))
    imported = []
    for node in tree.body:
        if isinstance(node, ast.ImportFrom) and node.module:
            imported.append(node.module)
            # Of a package, its modules are imported by name.
            members = (f"{node.module}.{alias.name}" for alias in node.names)
            imported += [member for member in members if _file(member).exists()]
    return _code(tree), imported


def _file(module: str) -> Path:
    return ROOT.joinpath(*module.split(".")).with_suffix(".py")


def _code(tree: ast.Module) -> str:
    """What is done, and what is not said about it."""
    kept = [node for node in tree.body if not _named(node)]
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            first = node.body[0] if node.body else None
            if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
                first.value.value = ""
    return "\n".join(map(ast.unparse, kept))


def _named(node: ast.stmt) -> bool:
    """Whether it is what a bench says of its cases and faults."""
    return isinstance(node, ast.Assign) and any(
        isinstance(target, ast.Name) and target.id in NAMES for target in node.targets
    )
