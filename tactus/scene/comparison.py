"""A scene as a task for the designs that are compared (``tactus.sizing``)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from golden.input_error import naming
from tactus.sizing.candidates import CANDIDATES, Refused, Sized, SizingTask, all_sized

if TYPE_CHECKING:
    from tactus.scene.scene import Scene


def task_of(scene: Scene) -> SizingTask:
    """The networks of a scene, its settings and its recorded frames."""
    around = {
        "a section [front_end]": scene.front_end is not None,
        "a section [visualisation]": scene.visualisation is not None,
        "hardware.interface 'axi_stream'": scene.interface == "axi_stream",
        "data.window with past samples": not scene.window.plain,
    }
    codes = scene.vectors().codes
    inputs = scene.members[0].inputs
    with naming(scene.path):
        return SizingTask(
            scene.arrangement,
            scene.networks(),
            scene.settings(),
            scene.design,
            tuple(name for name, there in around.items() if there),
            scene.argmax,
            np.asarray(codes)[:, :inputs],
            scene.front_end is None and scene.visualisation is None,
            scene.demand.interval,
        )


def compared(scene: Scene) -> tuple[list[Sized], list[Refused]]:
    """Every design of a scene with its costs, and those that cannot be built."""
    task = task_of(scene)
    found = all_sized(task, CANDIDATES)
    return (
        [one for one in found if isinstance(one, Sized)],
        [one for one in found if isinstance(one, Refused)],
    )
