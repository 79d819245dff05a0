"""From real weights to the constants of a bit-true network."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from golden.activation.activation_block import ActivationBlock
from golden.activation.schemes import SCHEMES
from golden.fixed import Codes, Fix
from golden.layers.input_integral import InputIntegral
from golden.layers.input_node import InputNode
from golden.layers.neuron import Neuron
from golden.layers.node_sum import NodeSum
from golden.layers.output_integral import OutputIntegral
from golden.networks.arrangement import ARRANGEMENTS
from golden.networks.hybrid import Hybrid
from golden.networks.mlp import Mlp, Real
from golden.networks.network import Network
from golden.networks.parallel import Parallel
from golden.precision import SIGNAL, Precision, normalisation


@dataclass(frozen=True)
class Layer:
    """Codes of a layer's weights, shape (neurons, inputs), and biases, their format, and Q or Y."""

    weights: tuple[tuple[int, ...], ...]
    biases: tuple[int, ...]
    fmt: Fix
    factors: tuple[int, ...]

    def of_neurons(self, kept: Sequence[int]) -> Layer:
        """This layer with some of its neurons."""
        return replace(
            self,
            weights=tuple(self.weights[j] for j in kept),
            biases=tuple(self.biases[j] for j in kept),
            factors=tuple(self.factors[j] for j in kept),
        )

    def of_inputs(self, kept: Sequence[int]) -> Layer:
        """This layer on some of its inputs."""
        return replace(self, weights=tuple(tuple(row[j] for j in kept) for row in self.weights))


def quantised(weights: Real, biases: Real, precision: Precision, name: str) -> Layer:
    """A layer in the formats of a precision, normalised where it asks for that.

    Raises
    ------
    ValueError
        When the weights do not fit their format or their normalisation is too large; the message
        begins with ``name``.
    """
    factors = (
        normalisation(weights, biases, name)
        if precision.normalise
        else np.ones(len(biases), dtype=np.int64)
    )
    codes, bias_codes, fmt = precision.coefficients(
        weights / factors[:, np.newaxis], biases / factors, name
    )
    return Layer(tuple(map(_plain, codes)), _plain(bias_codes), fmt, _plain(factors))


def _plain(codes: Codes) -> tuple[int, ...]:
    return tuple(int(code) for code in codes)


def _layers(mlp: Mlp, precision: Precision, lean: bool) -> tuple[Layer, Layer, int]:
    """Both layers, without the hidden nodes that no output uses, and how many those are.

    A weight whose code is 0 adds nothing to a sum, so a node with such weights alone changes no
    output. One node stays, because a network has at least one.
    """
    first = quantised(mlp.w1, mlp.b1, precision, "layer 1 weights")
    second = quantised(mlp.w2, mlp.b2, precision, "layer 2 weights")
    hidden = range(len(first.biases))
    used = [j for j in hidden if any(row[j] for row in second.weights)] if lean else list(hidden)
    used = used or [0]
    return first.of_neurons(used), second.of_inputs(used), len(hidden) - len(used)


def _refuse_wrapping(precision: Precision, widths: Iterable[tuple[str, int]]) -> None:
    """The thesis' adders wrap, and a wrapped sum is a wrong sum."""
    for name, width in widths:
        if precision.normalise and width > SIGNAL.width:
            raise ValueError(
                f"{name}: its normalised sum needs {width} bits and would wrap in "
                f"{SIGNAL.width}; weights that are nearly whole numbers do this, retrain or "
                "use the precise precision"
            )


def _activations(
    precision: Precision,
    activation: str,
    options: Mapping[str, object] | None,
    factors: Sequence[int],
    nodes: Sequence[NodeSum],
    lean: bool,
) -> tuple[ActivationBlock, ...]:
    """One for each hidden node, as small as its sum allows; whole ones where not ``lean``."""
    scheme = SCHEMES[activation].configured(options or {})
    return tuple(
        scheme.build(precision, q, node.reach if lean else node.out_fmt.high)
        for q, node in zip(factors, nodes, strict=True)
    )


def build_hybrid(
    mlp: Mlp,
    precision: Precision,
    activation: str,
    options: Mapping[str, object] | None = None,
    variant: str = "",
    lean: bool = True,
) -> Hybrid:
    """The bit-true folded network of ``mlp``.

    Parameters
    ----------
    mlp : Mlp
    precision : Precision
    activation : str
        A name of ``SCHEMES``.
    options : mapping, optional
        What is chosen of the activation's options.
    variant : str
        Tells it from other networks of the same design.
    lean : bool
        Leave out what the weights make useless: segments of activations, hidden nodes. Results are
        the same either way.

    Raises
    ------
    ValueError
        When weights do not fit their format, or when in ``thesis`` precision a normalised sum
        could leave its 14 bits.
    """
    first, second, useless = _layers(mlp, precision, lean)
    prefix = f"{variant}_" if variant else ""
    nodes = tuple(
        InputNode(
            SIGNAL,
            first.fmt,
            precision.hidden_fmt,
            precision.product_shift,
            weights,
            bias,
            variant=f"{prefix}{j}",
        )
        for j, (weights, bias) in enumerate(zip(first.weights, first.biases, strict=True))
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
    _refuse_wrapping(
        precision,
        [(f"hidden node {j}", node.acc_width) for j, node in enumerate(nodes)]
        + [("output layer", output.acc_width)],
    )
    return Hybrid(
        InputIntegral(nodes, variant=variant),
        _activations(precision, activation, options, first.factors, nodes, lean),
        output,
        useless_nodes=useless,
        variant=variant,
    )


def build_parallel(
    mlp: Mlp,
    precision: Precision,
    activation: str,
    options: Mapping[str, object] | None = None,
    variant: str = "",
    lean: bool = True,
) -> Parallel:
    """The bit-true parallel network of ``mlp``; see ``build_hybrid``, whose results it has."""
    first, second, useless = _layers(mlp, precision, lean)
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

    hidden = neurons(first, precision.hidden_fmt, "q", scaled=False)
    outputs = neurons(second, SIGNAL, "y", scaled=precision.normalise)
    _refuse_wrapping(
        precision,
        [(f"hidden node {j}", neuron.acc_width) for j, neuron in enumerate(hidden)]
        + [("output layer", neuron.acc_width) for neuron in outputs],
    )
    return Parallel(
        hidden,
        _activations(precision, activation, options, first.factors, hidden, lean),
        outputs,
        useless_nodes=useless,
        variant=variant,
    )


@dataclass(frozen=True)
class Design:
    """A form of hardware that a scene can name: how it is built, and the arrangements it allows."""

    build: Callable[[Mlp, Precision, str, Mapping[str, object] | None, str, bool], Network]
    arrangements: tuple[str, ...]


DESIGNS = {
    "hybrid": Design(build_hybrid, ARRANGEMENTS),
    "parallel": Design(build_parallel, ("single",)),
}
