"""Tests in which scene benches run if no scene is given."""

from functools import cache

import pytest

from tactus.scene import DEFAULT_SCENES, load_scene, scene_names
from tactus.verify.benches.collected import BENCHES, CASES_OF
from tactus.verify.benches.places import blocks_in, places

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")


@cache
def blocks_of_scenes() -> dict[str, set[str]]:
    """The blocks of every shipped scene, in the order of the scenes."""
    return {name: blocks_in(load_scene(name)) for name in scene_names()}


@pytest.mark.parametrize("block", sorted(BENCHES))
def test_every_block_is_found_without_a_scene(block: str) -> None:
    """Default scenes come first, then other shipped scenes, then the cases of its bench."""
    found = places(None, block)
    assert all(block in blocks_in(place.scene) for place in found)
    shipped = [name for name, blocks in blocks_of_scenes().items() if block in blocks]
    default = [name for name in DEFAULT_SCENES if name in shipped]
    names = [place.scene.name for place in found]
    assert names == (default or shipped[:1] or CASES_OF[block][:1])
    kind = "scene" if shipped else "case"
    assert all(p.why.startswith(f"{kind} {p.scene.name}: ") and block in p.why for p in found)


def test_a_scene_that_is_named_is_taken_without_a_word() -> None:
    (place,) = places("digit-single", "hybrid")
    assert (place.scene.name, place.why) == ("digit-single", "")
