"""Hybrid: a network of two layers that is folded over its inputs and over its outputs."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from golden.activation.activation_block import ActivationBlock
from golden.common.flow import Flow, Replicated, Wire, WithController
from golden.layers.input_controller import InputController
from golden.layers.input_integral import InputIntegral
from golden.layers.output_controller import OutputController
from golden.layers.output_integral import OutputIntegral
from golden.networks.constants import constants_of
from golden.networks.design import Design, Settings
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.trained.dense import DenseNetwork


@dataclass(frozen=True)
class Hybrid(Design):
    """y = f2(activation(f1(x))), folded over samples and outputs (thesis section 5.4, Figure 5.8).

    Layer 1 has one multiplier per hidden node, used once per sample; each hidden node has one
    activation; layer 2 has one multiplier per hidden node, used once per output.
    """

    block = "hybrid"
    section = "5.4"
    arrangements = ("single", "multiple", "cascade")
    input_integral: InputIntegral
    activations: tuple[ActivationBlock, ...]
    output_integral: OutputIntegral

    def __post_init__(self) -> None:
        self.check_latencies(self.activations)

    @classmethod
    def build(
        cls, networks: Sequence[DenseNetwork], settings: Settings, arrangement: str, variant: str
    ) -> Self:
        (mlp,) = cls.plain(networks)
        constants = constants_of(mlp, settings)
        precision, first, second = constants.precision, constants.first, constants.second
        hidden = InputIntegral(
            SIGNAL,
            first.fmt,
            precision.hidden_fmt,
            precision.product_shift,
            first.weights,
            first.biases,
            variant=variant,
        )
        output = OutputIntegral(
            SIGNAL,
            second.fmt,
            SIGNAL,
            precision.product_shift,
            second.weights,
            second.biases,
            second.factors if precision.normalise else None,
            variant=variant,
        )
        return cls(
            hidden,
            constants.activations,
            output,
            useless_nodes=constants.useless_nodes,
            variant=variant,
        )

    @property
    def inputs(self) -> int:
        return self.input_integral.inputs

    @property
    def outputs(self) -> int:
        return self.output_integral.outputs

    @property
    def interval(self) -> int:
        rest = (a.interval for a in self.activations)
        return max(self.inputs, self.outputs, self.min_interval, *rest)

    @property
    def latency(self) -> int:
        first = self.input_controller.latency + self.activations[0].latency
        return first + self.output_controller.latency + self.output_integral.latency

    @property
    def input_controller(self) -> InputController:
        return InputController.every(self.interval, self.inputs)

    @property
    def output_controller(self) -> OutputController:
        return OutputController(self.outputs)

    def left_out(self) -> list[str]:
        texts = self.left_out_of(self.activations)
        if self.output_integral.factors is None:
            texts.append("the de-normalisation multiplier and its ROM")
        if not self.input_controller.spacing:
            texts.append("the counter that keeps frames apart: a frame has samples enough")
        return texts

    def flow(self) -> Flow:
        hidden, first = len(self.activations), self.input_integral
        return Flow(
            (
                Wire(f"{self.inputs} x", first.in_fmt),
                WithController(self.input_controller, first),
                Wire(f"{hidden} q", first.out_fmt),
                Replicated(self.activations),
                Wire(f"{hidden} r", self.activations[0].out_fmt),
                WithController(self.output_controller, self.output_integral),
                Wire(f"{self.outputs} y", self.output_integral.out_fmt),
            ),
            across=True,
        )

    def compute(self, frames: Codes) -> Codes:
        q = self.input_integral.process(frames)
        rows = [a.process(q[:, j]) for j, a in enumerate(self.activations)]
        return self.output_integral.process(np.stack(rows).T)
