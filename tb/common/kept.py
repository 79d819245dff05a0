"""Results of benches that passed, each kept under a key of all that enters it.

That is what is simulated, the code of the bench and of what it imports, the twin, the seed and the
number of frames, and the tools.

A scene finds designs by discovery, so every bench loads nearly all of ``golden``. What it meets of
that is less: its own twin, of which the key has the value and the code of every class in it. What
reads scenes and builds twins is a part only of a bench that asks for the scene or for what stands
around its block, as for recorded frames; then the files of the scene and the twins of the whole
design are parts, too. Failures are not kept.
"""

from __future__ import annotations

import ast
import platform
from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from functools import cache
from importlib.metadata import version as version_of
from pathlib import Path

from golden import store
from golden.block import Block, walk
from golden.closure import closure, code, digest_of
from golden.fingerprint import ROOT
from hdl.synth.tools import digest
from tb.common.runner import Job, Outcome, run_job
from tb.common.tools import version

FACTS = ("compared", "seconds", "facts")
PACKAGES = ("cocotb", "cocotbext-axi", "cocotbext-uart", "numpy")
# Hands every bench its twin, and the scene to those that ask.
BENCH = "tb.common.bench"
ASKS = {"scene", "design", "around"}
# What these say is in the exported files.
ELSEWHERE = ("tb.common.cases", "tb.common.small")
NAMES = ("CASES", "FAULTS")
SCENE = "golden.scene"
# These name all that a scene can choose. What they import of blocks becomes a twin, or no part.
REGISTRIES = ("golden.activation.schemes", "golden.networks.designs")
BLOCKS = tuple(
    f"golden.{area}."
    for area in (
        "activation",
        "engine",
        "instruments",
        "layers",
        "link",
        "networks",
        "sensing",
        "visualisation",
    )
)


def kept(job: Job) -> Outcome | None:
    """The kept result of a bench, if nothing that it depends on has changed.

    A result of all tests of a bench also counts as the result of one of them.
    """
    for asked in [job, replace(job, test="")] if job.test else [job]:
        found = store.read(bench_key(asked), job.build)
        if found is not None:
            return Outcome(job, True, **{name: found[name] for name in FACTS})
    return None


def run_and_keep(job: Job) -> Outcome:
    """Run a bench, whatever is kept of it."""
    asked = bench_key(job)
    outcome = run_job(job)
    if outcome.passed:
        store.write(asked, {name: getattr(outcome, name) for name in FACTS}, job.build)
    return outcome


def run_kept(job: Job) -> Outcome:
    """The kept result of a bench, which runs if there is none."""
    return kept(job) or run_and_keep(job)


def bench_key(job: Job) -> store.Key:
    """All that enters the result of a bench."""
    return store.key(
        "bench",
        entity=job.entity,
        test=job.test,
        seed=job.seed,
        frames=job.frames,
        simulated=digest(job.hdl_folder, job.files),
        bench=digest_of(bench_modules(job.area, job.block), without=NAMES),
        tools=_tools(job.simulator),
        **_twin_parts(job),
    )


def _twin_parts(job: Job) -> dict[str, store.Part]:
    """What a bench has of ``golden``: its twin and, if it asks for more, all of the scene."""
    twin = job.twin
    found: dict[str, store.Part] = {"twin": repr(twin), "twins": code_of_twins(twin)}
    modules = bench_modules(job.area, job.block)
    if loads_scenes(modules):
        shipped = [ROOT / "golden" / name for name in ("scenes", "data")]
        found |= {"reading": code([SCENE]), "scene": job.scene.files, "shipped": shipped}
    elif asks_for_scene(modules):
        design = job.scene.twin()
        found |= {"design": repr(design), "designs": code_of_twins(design)}
        found |= {"reading": _reading(), "scene": job.scene.files}
    return found


@cache
def _modules(area: str, block: str) -> dict[str, Path]:
    return closure([f"tb.{area}.tb_{block}"], _follow_from_bench)


def bench_modules(area: str, block: str) -> dict[str, Path]:
    """The module of a bench and what it imports, but for what reads scenes and makes cases."""
    return dict(_modules(area, block))


def _follow_from_bench(importer: str, imported: str) -> bool:
    others = imported in ELSEWHERE or _is_scene(imported)
    return not others and _follow(importer, imported)


def _follow(importer: str, imported: str) -> bool:
    """What a scene or a registry imports of blocks is not followed."""
    chooses = _is_scene(importer) or importer in REGISTRIES
    return not (chooses and imported.startswith(BLOCKS))


def _is_scene(module: str) -> bool:
    return module == SCENE or module.startswith(f"{SCENE}.")


def loads_scenes(modules: dict[str, Path]) -> bool:
    """Whether a bench reads scenes by itself."""
    return any(
        isinstance(node, ast.ImportFrom) and _is_scene(str(node.module))
        for name, path in modules.items()
        if name.startswith("tb.") and name != BENCH
        for node in _nodes(path)
    )


def asks_for_scene(modules: dict[str, Path]) -> bool:
    """Whether a bench asks for more of its scene than its own twin."""
    return any(
        isinstance(node, ast.Attribute) and node.attr in ASKS
        for name, path in modules.items()
        if name.startswith("tb.") and name != BENCH
        for node in _nodes(path)
    )


@cache
def _nodes(path: Path) -> tuple[ast.AST, ...]:
    return tuple(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))


def code_of_twins(twin: Block) -> str:
    """A digest of what all classes in a twin do."""
    return _code(frozenset(module for block in walk(twin) for module in _classes(block)))


@cache
def _code(modules: frozenset[str]) -> str:
    return code(modules, _follow)


@cache
def _reading() -> str:
    """What reads scenes does, without what builds the twins."""
    return digest_of(closure([SCENE], _follow))


def _classes(value: object) -> Iterator[str]:
    """The modules of the classes of a value and of all in it."""
    if is_dataclass(value):
        yield type(value).__module__
        inner = [getattr(value, field.name) for field in fields(value)]
    elif isinstance(value, dict):
        inner = [*value.keys(), *value.values()]
    else:
        inner = list(value) if isinstance(value, (tuple, list, set, frozenset)) else []
    for one in inner:
        if not isinstance(one, (int, float, str)):
            yield from _classes(one)


@cache
def _tools(simulator: str) -> list[str]:
    """Asked once: a scene may have hundreds of benches."""
    packages = [f"{name} {version_of(name)}" for name in PACKAGES]
    return [version(simulator), f"python {platform.python_version()}", *packages]
