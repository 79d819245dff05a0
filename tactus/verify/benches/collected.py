"""The benches of ``tb``, the cases that they name, and the properties of every block.

Properties stand in the bench of a block or, where they are many, in ``prove_<block>.py``. There
those of its parts stand, too: in ``OF_PARTS``, by the part's name.
"""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

from golden.common.block import Block, parts_of
from tactus.core.fingerprint import ROOT
from tactus.core.folders import BUILD
from tactus.scene import Scene
from tactus.verify.benches.runner import Job
from tactus.verify.benches.written import scene_of
from tb.common.cases import Case
from tb.common.properties import Property

BENCHES = {
    path.stem.removeprefix("tb_"): import_module(f"tb.{path.parent.name}.{path.stem}")
    for path in sorted((ROOT / "tb").glob("*/tb_*.py"))
}
# For each block: the names of its cases.
CASES_OF: dict[str, list[str]] = {
    block: list(getattr(bench, "CASES", {})) for block, bench in BENCHES.items()
}


# All cases by name. If two benches use a name, it must be for the same case.
CASES: dict[str, Case] = {}
for _block, _bench in BENCHES.items():
    for _name, _case in getattr(_bench, "CASES", {}).items():
        if CASES.setdefault(_name, _case) != _case:
            raise ValueError(f"tb_{_block}.py: CASES: {_name} is another case elsewhere")


def case_scene(name: str, build: Path = BUILD) -> Scene:
    """The scene of a case, written below ``build``."""
    folder = build / "cases"
    folder.mkdir(parents=True, exist_ok=True)
    return scene_of(CASES[name], folder, name)


_BESIDE = {
    path.stem.removeprefix("prove_"): import_module(f"tb.{path.parent.name}.{path.stem}")
    for path in sorted((ROOT / "tb").glob("*/prove_*.py"))
}
PROOFS = {name: bench for name, bench in BENCHES.items() if hasattr(bench, "properties")} | _BESIDE
_OF: dict[str, Callable[[Any], list[Property]]] = {
    name: module.properties for name, module in PROOFS.items()
} | {
    name: make
    for module in PROOFS.values()
    for name, make in getattr(module, "OF_PARTS", {}).items()
}


def properties_of(job: Job) -> list[Property]:
    """The properties to prove of an entity, for its twin; none where none are written."""
    return _OF[job.block](job.twin) if job.block in _OF else []


def shown_by_frames(block: str) -> tuple[str, ...]:
    """The parts of a block of which the proof for every frame shows all that they do."""
    shown: tuple[str, ...] = getattr(BENCHES[block], "SHOWN_BY_FRAMES", ())
    return shown


def mutated_parts(twin: Block) -> list[str]:
    """The parts that are mutated with a block: all but those of which a proof says everything.

    Whatever changes what such a part does violates a property, or the proof for every frame.
    """
    return [
        part.entity
        for part in parts_of(twin)
        if part.block not in shown_by_frames(twin.block)
        and not any(item.whole for item in _OF.get(part.block, lambda _: [])(part))
    ]
