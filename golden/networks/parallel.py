"""Parallel: a network of two layers that does all multiplications at once."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from golden.activation.activation_block import ActivationBlock
from golden.common.flow import Flow, Replicated, Wire
from golden.common.port import CLOCK, Port, group, input_port, output_port
from golden.layers.input_controller import InputController
from golden.layers.weighted_sum import WeightedSum, tree_depth
from golden.networks.constants import Layer, constants_of
from golden.networks.design import Design, Settings
from golden.numbers.fixed import Codes, Fix, Overflow, Rounding, requantise, signed_width
from golden.numbers.precision import SIGNAL
from golden.trained.dense import DenseNetwork


@dataclass(frozen=True)
class Neuron(WeightedSum):
    """(b + sum_k w_k x_k) Y, with a multiplier for every weight (thesis section 5.2.1).

    weights, bias: Codes of ``coeff_fmt``, in the order of the samples.
    factor: De-normalisation Y_i of an output (equation 4.17). With None its multiplier is left out.

    The sum and its product with the factor are exact. The result is rounded half up and saturated
    to ``out_fmt``. With no bits to drop, and a sum no wider than ``out_fmt``, neither costs
    hardware.
    """

    block = "neuron"
    part_of = "parallel"
    section = "5.2.1"
    weights: tuple[int, ...]
    bias: int
    factor: int | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        self.coeff_fmt.check(np.array([*self.weights, self.bias]), f"{self.entity} weights")
        if self.factor is not None:
            self.check(factor=(1, None))

    @property
    def ports(self) -> tuple[Port, ...]:
        samples = input_port("in_data", "sample *", self.in_fmt)
        return (
            CLOCK,
            *group(samples, len(self.weights)),
            output_port(
                "out_data",
                "q of a hidden neuron, or q / Q where sums are normalised; y of an output",
                self.out_fmt,
            ),
        )

    @property
    def latency(self) -> int:
        # One clock for the product, one per level of the adder tree, one for the product with the
        # factor, and one for rounding.
        return 1 + tree_depth(len(self.weights) + 1) + (self.factor is not None) + 1

    @property
    def acc_width(self) -> int:
        """Bits of the sum. They are enough for the sum of any subset of the terms."""
        return signed_width(map(int, self.partial_sums(self.weights, self.bias)))

    @property
    def scaled_width(self) -> int:
        return self.acc_width + ((self.factor or 1) - 1).bit_length()

    def process(self, frames: ArrayLike) -> Codes:
        """Results in ``out_fmt``, shape (...), for frames of samples, shape (..., inputs)."""
        x = self.in_fmt.check(frames, f"{self.block} frames", len(self.weights))
        acc = self.sums(x, np.array([self.weights]), np.array([self.bias]))[..., 0]
        exact = acc * (self.factor or 1)
        return requantise(exact, self.out_shift, self.out_fmt, Rounding.ROUND, Overflow.SATURATE)


@dataclass(frozen=True)
class Parallel(Design):
    """y = f2(activation(f1(x))), all samples of a frame in one clock (thesis section 5.2).

    Every weight of both layers has its own multiplier, N M + M L of them, and every hidden node has
    one activation. All outputs leave in one clock.
    """

    block = "parallel"
    section = "5.2"
    arrangements = ("single",)
    stream = "words"
    hidden_neurons: tuple[Neuron, ...]
    activations: tuple[ActivationBlock, ...]
    output_neurons: tuple[Neuron, ...]

    def __post_init__(self) -> None:
        self.check_latencies(self.activations)

    @classmethod
    def build(
        cls, networks: Sequence[DenseNetwork], settings: Settings, arrangement: str, variant: str
    ) -> Self:
        (mlp,) = cls.plain(networks)
        constants = constants_of(mlp, settings)
        precision = constants.precision
        prefix = f"{variant}_" if variant else ""

        def neurons(layer: Layer, out_fmt: Fix, symbol: str, scaled: bool) -> tuple[Neuron, ...]:
            return tuple(
                Neuron(
                    SIGNAL,
                    layer.fmt,
                    out_fmt,
                    precision.product_shift,
                    weights,
                    layer.biases[i],
                    layer.factors[i] if scaled else None,
                    variant=f"{prefix}{symbol}{i}",
                )
                for i, weights in enumerate(layer.weights)
            )

        return cls(
            neurons(constants.first, precision.hidden_fmt, "q", scaled=False),
            constants.activations,
            neurons(constants.second, SIGNAL, "y", scaled=precision.normalise),
            useless_nodes=constants.useless_nodes,
            variant=variant,
        )

    @property
    def inputs(self) -> int:
        return len(self.hidden_neurons[0].weights)

    @property
    def outputs(self) -> int:
        return len(self.output_neurons)

    @property
    def unreachable(self) -> dict[str, str]:
        return {} if self.interval > 1 else {"frame_error=1": "a frame a clock is never too close"}

    @property
    def interval(self) -> int:
        return max(self.min_interval, *(activation.interval for activation in self.activations))

    @property
    def latency(self) -> int:
        rows = self.hidden_neurons, self.activations, self.output_neurons
        return sum(row[0].latency for row in rows)

    @property
    def input_controller(self) -> InputController:
        """A frame is one element; frames are kept as far apart as the activation needs."""
        return InputController.every(self.interval, 1)

    def left_out(self) -> list[str]:
        texts = self.left_out_of(self.activations)
        zeros = sum(n.weights.count(0) for n in (*self.hidden_neurons, *self.output_neurons))
        if zeros:
            texts.append(f"{zeros} multipliers of weights that are 0")
        if self.output_neurons[0].factor is None:
            texts.append("the multipliers of the de-normalisation")
        if not self.input_controller.spacing:
            texts.append("the counter that keeps frames apart: one may come in every clock")
        return texts

    def flow(self) -> Flow:
        first, last = self.hidden_neurons, self.output_neurons
        return Flow(
            (
                Wire(f"{self.inputs} x", first[0].in_fmt),
                Replicated(first),
                Wire(f"{len(first)} q", first[0].out_fmt),
                Replicated(self.activations),
                Wire(f"{len(first)} r", self.activations[0].out_fmt),
                Replicated(last),
                Wire(f"{self.outputs} y", last[0].out_fmt),
            ),
            across=True,
            watcher=self.input_controller,
        )

    def compute(self, frames: Codes) -> Codes:
        columns = [
            activation.process(neuron.process(frames))
            for neuron, activation in zip(self.hidden_neurons, self.activations, strict=True)
        ]
        r = np.stack(columns, axis=-1)
        return np.stack([neuron.process(r) for neuron in self.output_neurons], axis=-1)
