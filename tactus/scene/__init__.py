"""A scene: its sensors, its outputs, its networks, and the form of its hardware.

A scene is one TOML file, in a folder of ``scenes`` or anywhere else. Paths in it are
relative to the folder of this file.
"""

from golden.layers import kept_graph
from tactus.scene.kept_graphs import keep
from tactus.scene.reading import (
    DEFAULT_SCENES,
    FOLDER,
    class_names,
    comparison_names,
    load_scene,
    scene_names,
    scene_path,
)
from tactus.scene.reference import thesis_figures, thesis_table
from tactus.scene.scene import Scene
from tactus.scene.sections import SceneNetwork, Training
from tactus.scene.vectors import Vectors

kept_graph.keeper = keep

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
