"""Cases of a bench: small scenes with random networks, whose shapes no shipped scene has.

A bench names its cases in ``CASES``, by the name of the scene. Benches that name the same case run
on the same export.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from golden.trained.dense import Dense, DenseNetwork, Quantiser, mlp_of, network_of
from golden.trained.function import Function, by_name, functions_of
from golden.trained.function_network import Edge, FunctionNetwork
from golden.trained.window import Window

LENGTHS = """full_scale = { y1 = 0.9, y2 = 0.9 }
length_mm = { y1 = 127.0, y2 = 50.8 }
"""
VISUALISATION = """
[visualisation]
load = "y0"
position = "y1"
width = "y2"
shape = "y3"
"""
FRONT_END = "\n[front_end]\n"


def random_mlp(shape: tuple[int, int, int], spread: float, seed: int) -> DenseNetwork:
    """A network with normal weights, of deviation ``spread`` in layer 1 and 0.3 in layer 2."""
    inputs, hidden, outputs = shape
    rng = np.random.default_rng(seed)
    return mlp_of(
        rng.normal(0, spread, (hidden, inputs)),
        rng.normal(0, spread / 2, hidden),
        rng.normal(0, 0.3, (outputs, hidden)),
        rng.normal(0, 0.3, outputs),
    )


def random_network(
    shape: tuple[int, ...],
    activations: tuple[str, ...],
    spread: float,
    seed: int,
    quantiser: Quantiser | None = None,
    functions: tuple[Function, ...] = (),
) -> DenseNetwork:
    """A network of any depth with normal weights, whose sums are about as large in each layer.

    The weights of the last node of the first hidden layer are 0, so that it has no effect. If there
    is a ``quantiser`` behind every hidden layer, the weights are multiples of 1/16. ``functions``
    are the functions that the activations name.
    """
    rng = np.random.default_rng(seed)
    layers = []
    for n, (inputs, nodes) in enumerate(pairwise(shape)):
        weights = rng.normal(0, spread / np.sqrt(inputs), (nodes, inputs))
        biases = rng.normal(0, spread / 2, nodes)
        kind = activations[n] if n < len(activations) else "linear"
        if quantiser:
            weights, biases = np.rint(weights * 16) / 16, np.rint(biases * 256) / 256
        behind = quantiser if n < len(activations) else None
        tables = functions_of(kind, nodes, by_name(functions))
        layers.append(Dense(weights, biases, kind, quantiser=behind, functions=tables))
    if len(layers) > 1:
        layers[1].weights[:, -1] = 0
    return network_of(layers)


def random_learned(
    shape: tuple[int, ...], earlier: int, spread: float, seed: int
) -> FunctionNetwork:
    """A network of random functions, of which the last edge of each sum is straight.

    ``spread`` is about how far the functions of samples reach.
    """
    inputs, hidden, outputs = shape
    rng = np.random.default_rng(seed)

    def edges(count: int, size: float, end: float, most: float) -> list[Edge]:
        curves: list[Edge] = [
            (-end, end, most, *rng.normal(0, size, 6).tolist()) for _ in range(count - 1)
        ]
        return [*curves, float(rng.normal(0, size))]

    return FunctionNetwork(
        [edges(inputs, spread / inputs, 0.8, 2.5) for _ in range(hidden)],
        [edges(hidden, 0.5 / hidden, 2.0, 0.9) for _ in range(outputs)],
        rng.normal(0, 0.1, outputs).tolist(),
        [3.0] * hidden,
        earlier,
    )


@dataclass(frozen=True)
class Case:
    """A scene of random networks.

    ``spread`` is the deviation of the weights of layer 1. A shape of two numbers has no hidden
    layer. If a single network has several hidden
    nodes, the last of them has no weights. If there are ``activations``, there is one network with
    a hidden layer for each of them and with ``quantiser`` behind each hidden layer. ``functions``
    holds name and expression of each function that the activations name. ``learned`` gives random
    networks of learned functions, whose shapes are those of sums.
    """

    shapes: list[tuple[int, ...]]
    precision: str
    spread: float = 1.0
    activation: str = "gradient"
    options: str | None = None
    arrangement: str = "single"
    seed: int = 7
    design: str = "hybrid"
    sections: str = ""
    interface: str = "stream"
    hardware: str = ""
    window: Window | None = None
    activations: tuple[str, ...] = ()
    quantiser: Quantiser | None = None
    functions: tuple[tuple[str, str], ...] = ()
    learned: bool = False

    def networks(self) -> list[DenseNetwork]:
        if self.learned:
            samples = self.shapes[0][0]
            return [
                random_learned(shape, shape[0] - samples, self.spread, self.seed + i).layers()
                for i, shape in enumerate(self.shapes)
            ]
        if self.activations or len(self.shapes[0]) == 2:
            (shape,) = self.shapes
            more = self.quantiser, self.named_functions()
            return [random_network(shape, self.activations, self.spread, self.seed, *more)]
        mlps = [
            random_mlp((inputs, hidden, outputs), self.spread, self.seed + i)
            for i, (inputs, hidden, outputs) in enumerate(self.shapes)
        ]
        if self.arrangement == "single" and self.shapes[0][1] > 1:
            mlps[0].layers[0].weights[-1] = 0
            mlps[0].layers[0].biases[-1] = 0
        return [*mlps]

    def named_functions(self) -> tuple[Function, ...]:
        """The functions. Each is computed for every sum, to check that it is finite."""
        return tuple(Function(name, expression) for name, expression in self.functions)
