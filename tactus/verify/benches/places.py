"""Where the benches of a block run: in the named scene, or in one that contains the block.

Without a scene, a block is searched first in the default scenes, then in the other shipped scenes,
then in the cases of its bench.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path

from golden.common.block import Block, walk
from golden.input_error import InputError, suggest
from tactus.core.fingerprint import ROOT
from tactus.core.folders import BUILD
from tactus.scene import DEFAULT_SCENES, Scene, load_scene, scene_names

TB = ROOT / "tb"


@dataclass(frozen=True)
class Place:
    """A scene in which benches run, and a line that says why, empty if the user named the scene."""

    scene: Scene
    why: str = ""


def block_names() -> list[str]:
    """The names of all blocks, which are those with a bench."""
    return sorted(path.stem.removeprefix("tb_") for path in TB.glob("*/tb_*.py"))


def blocks_in(scene: Scene) -> set[str]:
    return {part.block for part in walk(scene.twin()) if not part.part_of}


def places(scene: str | None, block: str | None, build: Path = BUILD) -> list[Place]:
    """Where the benches of one block or of all blocks run: in the named scene, or in several.

    The scene of a case is written below ``build``.
    """
    if scene is not None:
        named = load_scene(scene)
        check_block(named, block)
        return [Place(named)]
    default = f"the default scenes, {' and '.join(DEFAULT_SCENES)}"
    if block is None:
        return [Place(load_scene(n), f"scene {n}: one of {default}") for n in DEFAULT_SCENES]
    check_name(block)
    found = [name for name in DEFAULT_SCENES if block in _blocks_in(name)]
    if found:
        why = f"one of {default}, contains {block}"
        return [Place(load_scene(name), f"scene {name}: {why}") for name in found]
    for name in _others():
        if block in _blocks_in(name):
            why = f"the first shipped scene that contains {block}; {default}, do not"
            return [Place(load_scene(name), f"scene {name}: {why}")]
    from tactus.verify.benches.collected import CASES_OF, case_scene

    for name in CASES_OF[block]:
        made = case_scene(name, build)
        if block in blocks_in(made):
            why = f"the first of its bench that contains {block}; no shipped scene does"
            return [Place(made, f"case {name}: {why}")]
    raise InputError(
        f"BLOCK={block}: neither a shipped scene nor a case of its bench contains it, expected "
        "SCENE= with a scene that does"
    )


def check_block(scene: Scene, block: str | None) -> None:
    """Refuse a block that a scene does not contain, and name a scene that does."""
    if block is None:
        return
    present = blocks_in(scene)
    if block in present:
        return
    check_name(block)
    raise InputError(
        f"BLOCK={block}: scene {scene.name} has no such block, expected one of "
        f"{', '.join(sorted(present))}; {_elsewhere(block)}"
    )


def _elsewhere(block: str) -> str:
    for name in (*DEFAULT_SCENES, *_others()):
        if block in _blocks_in(name):
            return f"scene {name} contains it, which is found without SCENE="
    from tactus.verify.benches.collected import CASES_OF

    for name in CASES_OF[block][:1]:
        return f"case {name} of its bench contains it, which is found without SCENE="
    return "no shipped scene contains it"


def check_name(block: str) -> None:
    """Refuse a block that there is not, and name the one that a part is judged with."""
    known = block_names()
    if block not in known:
        if owner := _owner(block):
            raise InputError(f"BLOCK={block}: {block} is a part of {owner}; ask for {owner}")
        hint = suggest(block, known) or f", expected one of {', '.join(known)}"
        raise InputError(f"BLOCK={block}: no such block{hint}")


def _owner(part: str, of: type[Block] = Block) -> str:
    """The block that a part is judged with; empty for any other name."""
    for path in ROOT.glob(f"hdl/*/{part}.py"):
        import_module(f"hdl.{path.parent.name}.{part}")
    owners = (
        twin.part_of if twin.block == part else _owner(part, twin) for twin in of.__subclasses__()
    )
    return next(filter(None, owners), "")


def _others() -> Iterator[str]:
    return (name for name in scene_names() if name not in DEFAULT_SCENES)


@cache
def _blocks_in(name: str) -> set[str]:
    """The blocks of a shipped scene, which does not change while a command runs."""
    return blocks_in(load_scene(name))
