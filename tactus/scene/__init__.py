"""A scene: its sensors, its outputs, its networks, and the form of its hardware.

A scene is one TOML file, in a folder of ``scenes`` or anywhere else. Paths in it are
relative to the folder of this file.
"""

from collections.abc import Callable
from typing import Any

from golden.layers import sharing
from tactus.core import store
from tactus.core.closure import code
from tactus.scene.data import thesis_figures, thesis_table
from tactus.scene.network import SceneNetwork
from tactus.scene.reading import (
    DEFAULT_SCENES,
    FOLDER,
    class_names,
    comparison_names,
    load_scene,
    scene_names,
    scene_path,
)
from tactus.scene.scene import Scene
from tactus.scene.training import Training
from tactus.scene.vectors import Vectors

__all__ = [
    "DEFAULT_SCENES",
    "FOLDER",
    "Scene",
    "SceneNetwork",
    "Training",
    "Vectors",
    "class_names",
    "comparison_names",
    "load_scene",
    "scene_names",
    "scene_path",
    "thesis_figures",
    "thesis_table",
]


def keep(parts: dict[str, Any], always: bool, search: Callable[[], Any]) -> Any:
    """The kept data of a graph of shared terms, or those that a search finds.

    A search may take minutes. But a command that only checks a scene leaves nothing behind. So if
    it need not, a graph is kept only once another command has written something.
    """
    if not always and not store.is_there():
        return search()
    return store.cached(store.key("shared_terms", code=code([sharing.__name__]), **parts), search)


sharing.keeper = keep
