"""Cases of a bench: small scenes with random networks, whose shapes no shipped scene has.

A bench names its cases in ``CASES``, by the name of the scene. Benches that name the same case run
on the same export.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from golden.trained.dense import Dense, Quantiser, Trained, network_of
from golden.trained.function import Function, by_name, functions_of
from golden.trained.function_network import Edge, FunctionNetwork
from golden.trained.mlp import Mlp
from golden.trained.window import Window

if TYPE_CHECKING:
    from tactus.scene import Scene

TEMPLATE = """
[data]
file = "{name}.csv"
sensors = {sensors}
outputs = {outputs}
{order}
{lengths}
[network]
arrangement = "{arrangement}"
hidden = {hidden}
weights = {weights}
{functions}
[hardware]
design = "{design}"
activation = "{activation}"
activation_options = {options}
precision = "{precision}"
interface = "{interface}"
{hardware}
{sections}
[training]
restarts = 2
steps = 20
{split}
"""
# Rows whose order does not matter, and rows in the order of time.
UNORDERED = 'group_by = "y0"'
ORDERED = "window = {window}"
BLOCKS = """split = "blocks"
block_rows = {rows}
"""


# With so few iterations the regression of pade diverges near the gate, so that it saturates.
OPTIONS = {"pade": "{ rho = 1.5, iterations = 3 }"}
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


def random_mlp(shape: tuple[int, int, int], spread: float, seed: int) -> Mlp:
    """A network with normal weights, of deviation ``spread`` in layer 1 and 0.3 in layer 2."""
    inputs, hidden, outputs = shape
    rng = np.random.default_rng(seed)
    return Mlp(
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
) -> Trained:
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


def write_scene(
    folder: Path,
    name: str,
    precision: str,
    networks: list[Trained],
    arrangement: str = "single",
    activation: str = "gradient",
    options: str | None = None,
    rows: int = 12,
    design: str = "hybrid",
    sections: str = "",
    interface: str = "stream",
    hardware: str = "",
    window: Window | None = None,
    functions: tuple[Function, ...] = (),
) -> Path:
    """Write a scene with random vectors and the given networks, and return its TOML file.

    ``hardware`` has the keys that only concern the design. ``sections`` are optional sections of
    the scene; if there are any, y1 and y2 have lengths. Without a ``window`` the networks take
    every frame as it is. With one there are ``rows`` frames after those that lack a complete past.
    ``functions`` are expressions, which the networks name.
    """
    # It is imported only here, because every bench imports this module.
    from tactus.network_files.network_file import save_network

    inputs = len(window.delays) if window else networks[0].shape[0]
    rows += window.past if window else 0
    outputs = sum(network.shape[-1] for network in networks)
    sensors = [f"x{k}" for k in range(inputs)]
    targets = [f"y{i}" for i in range(outputs)]
    rng = np.random.default_rng(5)
    table = np.concatenate(
        [rng.uniform(-1, 0.99, (rows, inputs)), rng.uniform(0.1, 0.9, (rows, outputs))], axis=1
    )
    lines = [",".join(sensors + targets)] + [",".join(f"{v:.4f}" for v in row) for row in table]
    (folder / f"{name}.csv").write_text("\n".join(lines) + "\n")
    layers = [list(network.shape[1:-1]) for network in networks]
    several = len(networks) > 1
    hidden = layers[0] if not several else [one[0] if len(one) == 1 else 0 for one in layers]
    weights = [f"{name}.npz", *(f"{name}-{i}.npz" for i in range(1, len(networks)))]
    text = TEMPLATE.format(
        name=name,
        sensors=sensors,
        outputs=targets,
        arrangement=arrangement,
        hidden=hidden[0] if len(hidden) == 1 else hidden or 0,
        weights=f'"{name}.npz"' if len(networks) == 1 else weights,
        precision=precision,
        design=design,
        activation=activation,
        options=OPTIONS.get(activation, "{}") if options is None else options,
        order=ORDERED.format(window=delays_text(window, sensors)) if window else UNORDERED,
        split=BLOCKS.format(rows=window.past + 2) if window else "",
        lengths=LENGTHS if sections else "",
        functions=functions_text(functions),
        sections=sections,
        interface=interface,
        hardware=hardware,
    )
    path = folder / f"{name}.toml"
    path.write_text(text.replace("'", '"'))
    for file, network in zip(weights, networks, strict=True):
        save_network(folder / file, network, {"scene": name})
    return path


def functions_text(functions: tuple[Function, ...]) -> str:
    """The section ``[network.functions]`` of a scene; empty without functions."""
    lines = [f'{function.name} = "{function.expression}"' for function in functions]
    return "\n".join(["", "[network.functions]", *lines, ""]) if lines else ""


def delays_text(window: Window, sensors: list[str]) -> str:
    """The text of ``data.window`` of a scene."""
    lines = (f"{s} = {list(d)}" for s, d in zip(sensors, window.delays, strict=True))
    return "{ " + ", ".join(lines) + " }"


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

    def networks(self) -> list[Trained]:
        if self.learned:
            samples = self.shapes[0][0]
            return [
                random_learned(shape, shape[0] - samples, self.spread, self.seed + i).layers()
                for i, shape in enumerate(self.shapes)
            ]
        if self.activations or len(self.shapes[0]) == 2:
            (shape,) = self.shapes
            more = self.quantiser, self._functions()
            return [random_network(shape, self.activations, self.spread, self.seed, *more)]
        mlps = [
            random_mlp((inputs, hidden, outputs), self.spread, self.seed + i)
            for i, (inputs, hidden, outputs) in enumerate(self.shapes)
        ]
        if self.arrangement == "single" and self.shapes[0][1] > 1:
            mlps[0].w1[-1] = 0
            mlps[0].b1[-1] = 0
        return [*mlps]

    def _functions(self) -> tuple[Function, ...]:
        """The functions. Each is computed for every sum, to check that it is finite."""
        return tuple(Function(name, expression) for name, expression in self.functions)

    def scene(self, folder: Path, name: str) -> Scene:
        # It is imported only here, because every bench imports this module.
        from tactus.scene import load_scene

        path = write_scene(
            folder,
            name,
            self.precision,
            self.networks(),
            self.arrangement,
            self.activation,
            self.options,
            design=self.design,
            sections=self.sections,
            interface=self.interface,
            hardware=self.hardware,
            window=self.window,
            functions=self._functions(),
        )
        return load_scene(str(path))
