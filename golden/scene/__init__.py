"""A scene: its sensors, its outputs, its networks, and the form of its hardware.

A scene is one TOML file, in a folder of ``golden/scenes`` or anywhere else. Paths in it are
relative to the folder of this file.
"""

from golden.scene.reading import (
    DEFAULT_SCENES,
    FOLDER,
    class_names,
    comparison_names,
    load_scene,
    scene_names,
    scene_path,
)
from golden.scene.reference import thesis_figures, thesis_table
from golden.scene.scene import Scene
from golden.scene.sections import Member, Training
from golden.scene.vectors import Vectors

__all__ = [
    "DEFAULT_SCENES",
    "FOLDER",
    "Member",
    "Scene",
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
