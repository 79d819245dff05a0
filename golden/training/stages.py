"""The networks of a scene as training makes them: chosen, tested, written."""

from __future__ import annotations

from dataclasses import dataclass, field

from golden.networks.mlp import Mlp
from golden.scene import Scene
from golden.scene.scale import on_readings, on_signals
from golden.training.search import refitted, train
from golden.training.task import Task, task_for


@dataclass
class Stages:
    """The networks so far, each of which sees the earlier ones of its own stage.

    Attributes
    ----------
    scene : Scene
    chosen : list of Mlp
        Trained on the training rows, chosen by the validation rows.
    tested : list of Mlp
        The same, with ``training.refit`` trained on, on training and validation rows: nothing of
        the test rows is in them.
    written : list of Mlp
        The same, with ``training.refit`` trained on, on all rows, as their files will be read.
    files : list of Mlp
        What the files of the written ones hold.
    """

    scene: Scene
    chosen: list[Mlp] = field(default_factory=list)
    tested: list[Mlp] = field(default_factory=list)
    written: list[Mlp] = field(default_factory=list)
    files: list[Mlp] = field(default_factory=list)

    def task(self, earlier: list[Mlp], number: int) -> Task:
        """The task of one network behind the earlier ones of a stage."""
        return task_for(self.scene, self.scene.vectors(), earlier[:number])

    def add(self, hidden: int, restart: int) -> None:
        """The next network, from the candidate that was chosen.

        Raises
        ------
        ValueError
            When the hardware's formats cannot hold its weights.
        """
        number = len(self.chosen)
        chosen = self._as_read(train(self.task(self.chosen, number), hidden, restart), number)
        tested = written = chosen
        if self.scene.training.refit:
            task = self.task(self.tested, number)
            tested = self._as_read(refitted(task, chosen[1], task.known), number)
            task = self.task(self.written, number)
            written = self._as_read(refitted(task, chosen[1], task.every), number)
        self.chosen.append(chosen[1])
        self.tested.append(tested[1])
        self.written.append(written[1])
        self.files.append(written[0])

    def _as_read(self, mlp: Mlp, number: int) -> tuple[Mlp, Mlp]:
        """What a file holds of a network, and what is read from it."""
        scales = self.scene.scales_of(number)
        file = on_readings(mlp, *scales)
        return file, on_signals(file, *scales)
