"""Networks of any depth in floating point, made of dense layers with an activation each."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import fsum

import numpy as np
from numpy.typing import ArrayLike

from golden.input_error import InputError
from golden.numbers.real import Real
from golden.trained.function import TABLE, Function

# An activation returns its value and its slope, because training needs both.
Activation = Callable[[Real], tuple[Real, Real]]


def tanh(q: Real) -> tuple[Real, Real]:
    """The hyperbolic tangent and its slope."""
    value = np.tanh(q)
    return value, 1 - value * value


def shifted(biases: Real, weights: Real, shift: Real) -> Real:
    """Compute ``biases + weights @ shift``, where each sum is rounded only once.

    So the order of addition cannot change any bit of the hardware.

    biases: shape (neurons,).
    weights: shape (neurons, inputs).
    shift, shape (inputs,): Number that is added to each input.
    """
    terms = np.concatenate([biases[:, np.newaxis], weights * shift], axis=1)
    sums: Real = terms.sum(axis=1)
    if np.isfinite(terms).all():
        sums = np.array([fsum(row) for row in terms.tolist()])
    return sums


# The default slope of a leaky ReLU below 0, as in PyTorch.
LEAK = 0.01


def _sigmoid(q: Real) -> tuple[Real, Real]:
    # It is computed from tanh, which does not overflow.
    value = 0.5 + 0.5 * np.tanh(0.5 * q)
    return value, value * (1 - value)


def _hard_tanh(q: Real) -> tuple[Real, Real]:
    return np.clip(q, -1.0, 1.0), (np.abs(q) < 1).astype(np.float64)


def _linear(q: Real) -> tuple[Real, Real]:
    return q, np.ones_like(q)


def _relu(q: Real) -> tuple[Real, Real]:
    return np.maximum(q, 0.0), (q > 0).astype(np.float64)


# The activations by name. Each gives the value and the slope, which training needs.
ACTIVATIONS: dict[str, Activation] = {
    "tanh": tanh,
    "sigmoid": _sigmoid,
    "relu": _relu,
    "leaky_relu": _relu,
    "hard_tanh": _hard_tanh,
    "linear": _linear,
}


@dataclass(frozen=True)
class Quantiser:
    """A quantiser, which rounds values to the grid ``(code - zero) * scale``.

    low, high: The lowest and the highest code.
    rounding: "even" rounds halves to the even code, "away" rounds halves away from 0, and "floor"
        rounds down.
    before_zero: Whether a value is rounded before the zero is added, as in ONNX, or after, as in
        QONNX.
    nearest: Whether hardware that cannot hold the weights of its layer exactly may round them.
    """

    scale: float
    zero: int
    low: int
    high: int
    rounding: str = "even"
    before_zero: bool = False
    nearest: bool = False

    def __post_init__(self) -> None:
        if not (np.isfinite(self.scale) and self.scale > 0):
            raise InputError(f"scale: got {self.scale}, expected a number above 0")
        if not self.low < self.high:
            raise InputError(f"codes: got {self.low} to {self.high}, expected two or more")
        if self.rounding not in ("even", "away", "floor"):
            raise InputError(f"rounding: got {self.rounding!r}, expected even, away or floor")

    def process(self, values: Real) -> Real:
        """Round values to the grid."""
        zero = 0 if self.before_zero else self.zero
        scaled = values / self.scale + zero
        if self.rounding == "even":
            codes = np.rint(scaled)
        elif self.rounding == "away":
            codes = np.sign(scaled) * np.floor(np.abs(scaled) + 0.5)
        else:
            codes = np.floor(scaled)
        found: Real = np.clip(codes + (self.zero - zero), self.low, self.high) - self.zero
        return found * self.scale


@dataclass(frozen=True)
class Dense:
    """One layer: ``activation(weights @ x + biases)``.

    weights: shape (nodes, inputs).
    biases: shape (nodes,).
    activation: A name of ``ACTIVATIONS``, or "table:" and the names of ``functions``.
    leak: The slope of "leaky_relu" below 0, from 0 to 1. Other activations ignore it.
    quantiser: The quantiser behind the activation, in a quantised network.
    functions: The function of each node, where the activation is a table.
    """

    weights: Real
    biases: Real
    activation: str = "linear"
    leak: float = LEAK
    quantiser: Quantiser | None = None
    functions: tuple[Function, ...] = ()

    def __post_init__(self) -> None:
        shape, nodes = np.shape(self.weights), np.shape(self.biases)
        if len(shape) != 2 or 0 in shape or nodes != shape[:1]:
            raise InputError(
                f"weights, biases: got shapes {shape} and {nodes}, expected (nodes, inputs) and "
                "(nodes,)"
            )
        for name in ("weights", "biases"):
            if not np.isfinite(getattr(self, name)).all():
                raise InputError(f"{name}: got NaN or infinity, expected finite numbers")
        if self.activation.startswith(TABLE):
            if len(self.functions) != self.nodes:
                raise InputError(
                    f"activation: got {self.activation!r} with {len(self.functions)} functions, "
                    f"expected {self.nodes}, one for each node"
                )
        elif self.activation not in ACTIVATIONS:
            raise InputError(
                f"activation: got {self.activation!r}, expected one of {', '.join(ACTIVATIONS)}"
            )
        if not 0 <= self.leak <= 1:
            raise InputError(f"leak: got {self.leak}, expected 0 to 1")

    @property
    def nodes(self) -> int:
        return len(self.biases)

    @property
    def activation_text(self) -> str:
        """The activation in words, with its slope where it has one."""
        leaky = self.activation == "leaky_relu"
        return f"leaky_relu ({self.leak:g})" if leaky else self.activation

    def sums(self, inputs: Real) -> Real:
        """The sums of the nodes, shape (..., nodes), for inputs, shape (..., inputs)."""
        return inputs @ self.weights.T + self.biases

    def activate(self, q: Real, of_tanh: Activation = tanh) -> tuple[Real, Real]:
        """The activation's value and slope at the sums ``q``.

        ``of_tanh`` replaces tanh where the hardware approximates it.
        """
        if self.activation == "tanh":
            return of_tanh(q)
        if self.functions:
            columns = np.moveaxis(np.asarray(q, dtype=np.float64), -1, 0)
            pairs = [
                (function.value(column), function.slope(column))
                for function, column in zip(self.functions, columns, strict=True)
            ]
            values, slopes = zip(*pairs, strict=True)
            return np.stack(values, axis=-1), np.stack(slopes, axis=-1)
        value, slope = ACTIVATIONS[self.activation](q)
        if self.activation == "leaky_relu":
            return value + self.leak * np.minimum(q, 0.0), np.where(q > 0, 1.0, self.leak)
        return value, slope


@dataclass(frozen=True)
class DenseNetwork:
    """A network of dense layers, the last of which is linear.

    layers: One or more layers.
    """

    layers: tuple[Dense, ...]

    def __post_init__(self) -> None:
        if not self.layers:
            raise InputError("layers: got 0, expected 1 or more")
        for n in range(1, len(self.layers)):
            inputs, nodes = self.layers[n].weights.shape[1], self.layers[n - 1].nodes
            if inputs != nodes:
                raise InputError(
                    f"layer {n + 1}: got weights of {inputs} inputs, expected {nodes}, as many as "
                    f"layer {n} has nodes"
                )
        if self.layers[-1].activation != "linear" or self.layers[-1].quantiser:
            raise InputError(
                f"layer {len(self.layers)}: got {self.layers[-1].activation!r}, expected the last "
                "layer to be 'linear'"
            )

    @property
    def shape(self) -> tuple[int, ...]:
        """Inputs, the hidden nodes of each layer, and outputs."""
        return self.layers[0].weights.shape[1], *(layer.nodes for layer in self.layers)

    @property
    def quantised(self) -> bool:
        return any(layer.quantiser for layer in self.layers)

    @property
    def plain(self) -> bool:
        """Whether it is one hidden layer of tanh, which every design takes."""
        return self.activations == ("tanh",) and not self.quantised

    @property
    def activations(self) -> tuple[str, ...]:
        return tuple(layer.activation for layer in self.layers[:-1])

    def process(self, frames: ArrayLike, activation: Activation = tanh) -> Real:
        """Outputs, shape (..., outputs), of frames, shape (..., inputs).

        ``activation`` replaces tanh in the layers that have tanh.
        """
        outputs = np.asarray(frames, dtype=np.float64)
        for found in forward_passes(self, outputs, activation):
            outputs = found.outputs
        return outputs


def network_of(layers: Sequence[Dense]) -> DenseNetwork:
    """Make a network of layers.

    If the last layer is not linear, a linear layer that does not change its values is added.
    """
    if layers[-1].activation != "linear" or layers[-1].quantiser:
        nodes = layers[-1].nodes
        layers = [*layers, Dense(np.eye(nodes), np.zeros(nodes))]
    return DenseNetwork(tuple(layers))


def mlp_of(w1: Real, b1: Real, w2: Real, b2: Real) -> DenseNetwork:
    """y = w2 tanh(w1 x + b1) + b2 (thesis equation 3.11), which every design takes."""
    return DenseNetwork((Dense(w1, b1, "tanh"), Dense(w2, b2)))


@dataclass(frozen=True)
class Pass:
    """What frames become in one layer; every array has the shape (..., nodes).

    values: The activation of the sums.
    outputs: The values behind the quantiser, if the layer has one.
    """

    layer: Dense
    sums: Real
    values: Real
    outputs: Real


def forward_passes(
    network: DenseNetwork, frames: ArrayLike, activation: Activation = tanh
) -> Iterator[Pass]:
    """Frames, shape (..., inputs), in each layer of a network, in double precision.

    ``activation`` replaces tanh in the layers that have tanh.
    """
    outputs = np.asarray(frames, dtype=np.float64)
    for layer in network.layers:
        sums = layer.sums(outputs)
        values, _ = layer.activate(sums, activation)
        outputs = layer.quantiser.process(values) if layer.quantiser else values
        yield Pass(layer, sums, values, outputs)


def packed(network: DenseNetwork) -> Real:
    """All weights and biases in one vector, layer by layer."""
    parts = [p for layer in network.layers for p in (layer.weights.ravel(), layer.biases)]
    return np.concatenate(parts)


def unpacked(vector: Real, like: DenseNetwork) -> DenseNetwork:
    """The inverse of ``packed`` for a network with the layers of ``like``."""
    layers, at = [], 0
    for layer in like.layers:
        end = at + layer.weights.size
        weights = vector[at:end].reshape(layer.weights.shape)
        at = end + layer.nodes
        layers.append(replace(layer, weights=weights, biases=vector[end:at]))
    return DenseNetwork(tuple(layers))
