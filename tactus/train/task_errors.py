"""The errors of a network in the hardware of its scene, as it is read from its file.

These choose among the candidates of a search, and the provenance of a network names them.
"""

import numpy as np

from golden.numbers.real import Real
from golden.trained.dense import Trained
from tactus.scene.labels import wrong_percent
from tactus.scene.scale import on_readings, on_signals
from tactus.train.descent.search import signed_errors
from tactus.train.descent.task import Frames, Task


def as_read(task: Task, network: Trained) -> tuple[Trained, Trained]:
    """A trained network as a file holds it, and as it is read from there."""
    scene = task.scene
    inputs, outputs = scene.scales_of(task.number)
    file = on_readings(network, inputs, outputs)
    return file, on_signals(file, *scene.scales_as_read(file, task.number))


def percent_errors(task: Task, network: Trained, frames: Frames) -> Real:
    """Bit-true errors in percent, shape (rows, outputs).

    They have their signs or, of a class, are those of ``wrong_percent``.
    """
    if task.scene.labels:
        return wrong_percent(task.bit_true(network, frames), frames.targets)
    return signed_errors(task, network, frames)


def bit_true_error(task: Task, network: Trained, frames: Frames) -> float:
    """The figure that chooses among restarts: the root mean square of the bit-true errors.

    If the scene has classes, it is the part of the frames with a wrong decision, in percent.
    """
    errors = percent_errors(task, network, frames)
    if task.scene.labels:
        return float(errors.max(axis=1).mean())
    return float(np.sqrt((errors**2).mean()))
