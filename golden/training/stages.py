"""The networks of a scene as training makes them: chosen, tested, written."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from golden.mlp import Mlp
from golden.scene import Scene
from golden.scene.scale import on_readings, on_signals
from golden.training.few_digits import FewDigits, count_digits
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
    full : list of dict
        With ``training.digits``: the three of each network as they were with all their digits.
    """

    scene: Scene
    chosen: list[Mlp] = field(default_factory=list)
    tested: list[Mlp] = field(default_factory=list)
    written: list[Mlp] = field(default_factory=list)
    files: list[Mlp] = field(default_factory=list)
    full: list[dict[str, Mlp]] = field(default_factory=list)

    def task(self, earlier: list[Mlp], number: int) -> Task:
        """The task of one network behind the earlier ones of a stage."""
        return task_for(self.scene, self.scene.vectors(), earlier[:number])

    def add(self, hidden: int, restart: int) -> None:
        """The next network, from the candidate that was chosen.

        Raises
        ------
        InputError
            When the hardware's formats cannot hold its weights, or few digits its function.
        """
        number = len(self.chosen)
        chosen = self._as_read(train(self.task(self.chosen, number), hidden, restart), number)
        tested = written = chosen
        if self.scene.training.refit:
            task = self.task(self.tested, number)
            tested = self._as_read(refitted(task, chosen[1], task.known), number)
            task = self.task(self.written, number)
            written = self._as_read(refitted(task, chosen[1], task.every), number)
        if self.scene.training.digits:
            self.full.append({"chosen": chosen[1], "tested": tested[1], "written": written[1]})
            chosen, tested, written = self._few_digits(number, **self.full[-1])
        self.chosen.append(chosen[1])
        self.tested.append(tested[1])
        self.written.append(written[1])
        self.files.append(written[0])

    def _few_digits(
        self, number: int, chosen: Mlp, tested: Mlp, written: Mlp
    ) -> list[tuple[Mlp, Mlp]]:
        """The three networks with their digits taken away, each on the rows that it has seen."""
        task = self.task(self.chosen, number)
        few = FewDigits(task, chosen)
        found = [few.on_training_rows()]
        if self.scene.training.refit:
            count = few.asked
            if not isinstance(count, int):
                count = count_digits(found[0], self.scene.precision.coeff_width)
            task = self.task(self.tested, number)
            rows = np.concatenate([task.split.training, task.split.validation])
            found.append(few.on_more_rows(task, tested, task.known, rows, count)[0])
            task = self.task(self.written, number)
            rows = np.arange(len(task.recorded.codes))
            found.append(few.on_more_rows(task, written, task.every, rows, count)[0])
        read = [self._as_read(mlp, number) for mlp in found]
        return read if len(read) > 1 else read * 3

    def _as_read(self, mlp: Mlp, number: int) -> tuple[Mlp, Mlp]:
        """What a file holds of a network, and what is read from it."""
        scales = self.scene.scales_of(number)
        file = on_readings(mlp, *scales)
        return file, on_signals(file, *scales)
