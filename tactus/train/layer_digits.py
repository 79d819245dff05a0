"""Weights with few signed digits for networks of any layers, and for classes: ``training.digits``.

The weights are rounded as those of one hidden layer of tanh are
(``tactus.train.descent.few_digits``), and a network for numbers has the same error. The outputs of
a network for classes are logits, for which the data has no targets. There the error is the squared
difference from the logits of the trained network. The cross-entropy would not do: at a network that
is sure of its classes it is so flat that large changes of weights seem to cost nothing.

A node of ReLU computes the same with weights twice as large in front of it and half as large behind
it. So the Hessian says that one layer can make up for any change of the other, which is true only
near the trained weights. It is damped, so that large compensations cost something too.

Networks of several layers may be large, and the time grows with the cube of their size. Then fewer
orders of the weights are tried, and several weights are rounded at once.
"""

import sys
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from golden.numbers.real import Real
from golden.trained.dense import Trained, packed
from golden.trained.mlp import Activation
from tactus.train.descent.few_digits import FewDigits, Grid, RoundingObjective, teacher_frames
from tactus.train.descent.objective import Rows
from tactus.train.descent.task import Frames, Task
from tactus.train.layer_objective import LabelledRows, LayeredObjective

# How much the Hessian is damped, as a part of its diagonal.
HOLD = 0.01
# The weights and biases up to which each weight is rounded by itself, and all orders are tried.
ONE_BY_ONE = 512


@dataclass(frozen=True)
class LayerRoundingObjective(RoundingObjective):
    """The error that is minimised on a grid, for networks of any layers."""

    objective: LayeredObjective

    def value_gradient_hessian(self, vector: Real) -> tuple[float, Real, Real]:
        return self.value(vector), *self.objective.value_gradient_hessian(vector)


class LayerDigits(FewDigits):
    """Reduces the digits of a network of any layers, whose outputs are numbers."""

    def aim_on(
        self, network: Trained, rows: Rows, activation: Activation, grid: Grid
    ) -> RoundingObjective:
        objective = LayeredObjective(
            network, training=rows, validation=rows, weight_decay=0.0, patience=sys.maxsize
        )
        return LayerRoundingObjective(
            objective, grid, HOLD, max(1, len(packed(network)) // ONE_BY_ONE)
        )

    @property
    def starts(self) -> int:
        return super().starts if len(packed(self.chosen)) <= ONE_BY_ONE else 1


class ClassDigits(LayerDigits):
    """Reduces the digits of a network that tells classes apart. Its outputs are logits."""

    def errors(self, network: Trained) -> Real:
        """The mean cross-entropy with the labels of the validation rows, which is one number."""
        frames = self.task.validation
        rows = LabelledRows(frames.inputs, frames.targets, frames.scale)
        return np.array([(rows.residuals(network, self.task.scene.scheme.real) ** 2).mean()])

    def rows(
        self, task: Task, network: Trained, frames: Frames, recorded: NDArray[np.int64]
    ) -> Rows:
        """Frames whose targets are the logits of ``network``, and whose errors are parts of them.

        They are ``frames``, and those between and just beyond recorded rows.
        """
        taught = teacher_frames(task.recorded.take(recorded), task)
        inputs = np.concatenate([frames.inputs, taught.inputs])
        logits = network.process(inputs, task.scene.scheme.real)
        spread = max(float(logits.std()), sys.float_info.min)
        return Rows(inputs, logits, np.full(logits.shape, spread * np.sqrt(logits.size)))

    def shifted(self, task: Task, network: Trained, frames: Frames) -> Trained:
        """The network as it is: nothing shifts logits."""
        return network
