"""Every block has one name in every room, and rooms keep to their imports."""

import ast
import importlib
import pkgutil
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import golden
from golden.common.block import Block

ROOT = Path(__file__).parents[1]
# What is inlined into blocks and has no entity.
OTHERS = {"boards", "common", "export", "synth"}
ENTITIES = sorted(
    (path.parent.name, path.stem)
    for path in (ROOT / "hdl").glob("*/*.py")
    if path.parent.name not in OTHERS and path.stem != "__init__"
)


def twins(of: type[Block] = Block) -> Iterator[type[Block]]:
    """All twins that the modules of golden define."""
    for twin in of.__subclasses__():
        if twin.__module__.startswith("golden.") and "block" in vars(twin):
            yield twin
        yield from twins(twin)


for module in pkgutil.walk_packages(golden.__path__, "golden."):
    importlib.import_module(module.name)
TWINS = {(twin.area, twin.block): twin for twin in twins()}


def twin_of(area: str, block: str) -> type[Block]:
    """The twin of an entity. That of a part may stand in the file of any other twin."""
    twin = TWINS[area, block]
    assert twin.part_of or twin.__module__ == f"golden.{area}.{block}"
    return twin


BLOCKS = [entity for entity in ENTITIES if not twin_of(*entity).part_of]


@pytest.mark.parametrize(("area", "block"), ENTITIES)
def test_the_name_is_the_name_inside_the_files(area: str, block: str) -> None:
    assert callable(getattr(importlib.import_module(f"hdl.{area}.{block}"), block))
    twin = twin_of(area, block)
    assert twin.part_of in {"", *dict(map(reversed, BLOCKS))}
    for what in ("latency", "ports"):
        published = getattr(twin, what) is not getattr(Block, what)
        assert published, f"the twin of {block} publishes no {what}"


def test_no_bench_and_no_datasheet_without_a_block() -> None:
    names = {block for _, block in BLOCKS}
    benches = {p.stem.removeprefix("tb_") for p in (ROOT / "tb").glob("*/tb_*.py")}
    sheets = {p.stem for p in (ROOT / "docs" / "blocks").glob("*.md")}
    assert benches == names
    assert sheets == names


@pytest.mark.parametrize("path", sorted((ROOT / "tb").glob("*/tb_*.py")), ids=lambda p: p.stem)
def test_a_bench_says_what_it_does(path: Path) -> None:
    head = ast.get_docstring(ast.parse(path.read_text())) or ""
    assert re.match(rf"{path.stem.removeprefix('tb_')}\b", head), "the block comes first"
