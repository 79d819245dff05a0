"""The networks of a scene at the stages of training: chosen, tested and written."""

from dataclasses import dataclass, field
from typing import Any

from golden.trained.dense import Trained
from golden.trained.mlp import Mlp
from tactus.scene import Scene
from tactus.scene.scale import on_signals
from tactus.train.descent.few_digits import FewDigits, with_few_digits
from tactus.train.descent.search import refitted, train
from tactus.train.descent.task import Frames, Task, task_for
from tactus.train.task_errors import as_read


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

    def add(self, *candidate: Any) -> None:
        """Add the next network, from the candidate that was chosen."""
        number = len(self.chosen)
        task, seen_more, seen_all = (
            self.task(networks, number) for networks in (self.chosen, self.tested, self.written)
        )
        chosen: Any = as_read(task, self.trained(task, *candidate))
        tested = written = chosen
        if self.scene.training.refit:
            start = self._on_signals(chosen)
            tested = as_read(task, self.refitted(seen_more, start, seen_more.known))
            written = as_read(task, self.refitted(seen_all, start, seen_all.every))
        if self.scene.training.digits:
            self.full.append({"chosen": chosen[1], "tested": tested[1], "written": written[1]})
            few = self.digits(task, self._on_signals(chosen))
            others = (seen_more, self._on_signals(tested)), (seen_all, self._on_signals(written))
            found = with_few_digits(few, *others)
            chosen, tested, written = (as_read(task, network) for network in found)
        self.chosen.append(chosen[1])
        self.tested.append(tested[1])
        self.written.append(written[1])
        self.files.append(written[0])

    def trained(self, task: Task, *candidate: Any) -> Any:
        """The network of a candidate."""
        return train(task, *candidate)

    def refitted(self, task: Task, start: Any, frames: Frames) -> Any:
        """A network that is trained further on more rows."""
        return refitted(task, start, frames)

    @property
    def digits(self) -> type[FewDigits]:
        """How digits are removed from such networks."""
        return FewDigits

    def _on_signals(self, read: tuple[Trained, Trained]) -> Trained:
        """The network of a file on signals, as training has it: logits have no scale."""
        return on_signals(read[0], *self.scene.scales_of(len(self.chosen)))
