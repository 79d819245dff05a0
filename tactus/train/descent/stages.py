"""The networks of a scene at the stages of training: chosen, tested and written."""

from dataclasses import dataclass, field
from typing import cast

from golden.trained.mlp import Mlp
from tactus.scene import Scene
from tactus.scene.scale import on_readings, on_signals
from tactus.train.descent.few_digits import FewDigits, with_few_digits
from tactus.train.descent.search import refitted, train
from tactus.train.descent.task import Task, task_for


@dataclass
class Stages:
    """The networks so far. Each of them sees the earlier ones of its own stage.

    chosen: Networks trained on the training rows, and chosen by the validation rows.
    tested: The same networks; with ``training.refit`` they are trained further on training and
        validation rows, so that they contain nothing of the test rows.
    written: The same networks; with ``training.refit`` they are trained further on all rows. They
        are as they will be read from their files.
    files: The written networks as their files hold them.
    full: With ``training.digits``: for each network its three stages before digits were removed.
    """

    scene: Scene
    chosen: list[Mlp] = field(default_factory=list)
    tested: list[Mlp] = field(default_factory=list)
    written: list[Mlp] = field(default_factory=list)
    files: list[Mlp] = field(default_factory=list)
    full: list[dict[str, Mlp]] = field(default_factory=list)

    def task(self, earlier: list[Mlp], number: int) -> Task:
        """The task of a network that follows the earlier ones of a stage."""
        return task_for(self.scene, self.scene.vectors(), earlier[:number])

    def add(self, hidden: int, restart: int) -> None:
        """Add the next network, from the candidate that was chosen."""
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
            few = FewDigits(self.task(self.chosen, number), chosen[1])
            seen_more = self.task(self.tested, number), tested[1]
            seen_all = self.task(self.written, number), written[1]
            found = cast(list[Mlp], with_few_digits(few, seen_more, seen_all))
            chosen, tested, written = (self._as_read(mlp, number) for mlp in found)
        self.chosen.append(chosen[1])
        self.tested.append(tested[1])
        self.written.append(written[1])
        self.files.append(written[0])

    def _as_read(self, mlp: Mlp, number: int) -> tuple[Mlp, Mlp]:
        """The network as a file holds it, and as it is read from the file."""
        scales = self.scene.scales_of(number)
        file = on_readings(mlp, *scales)
        return file, on_signals(file, *scales)
