"""The names of blocks, which are those with a bench, and checks of one that a user names."""

from importlib import import_module

from golden.common.block import Block, walk
from golden.input_error import InputError, suggest
from tactus.core.fingerprint import ROOT
from tactus.scene import Scene


def block_names() -> list[str]:
    return sorted(path.stem.removeprefix("tb_") for path in ROOT.glob("tb/*/tb_*.py"))


def check_block(scene: Scene, block: str | None) -> None:
    """Refuse a block that a scene does not contain."""
    present = {part.block for part in walk(scene.twin()) if not part.part_of}
    if block is not None and block not in present:
        check_name(block)
        raise InputError(
            f"BLOCK={block}: scene {scene.name} has no such block, expected one of "
            f"{', '.join(sorted(present))}; without SCENE= it is taken in a case of its bench"
        )


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
