"""Writes scenes of random networks: the cases of benches, and what tests make up."""

from pathlib import Path

import numpy as np

from golden.trained.dense import Trained
from golden.trained.function import Function
from golden.trained.window import Window
from tactus.network_files.network_file import save_network
from tactus.scene import Scene, load_scene
from tb.common.cases import LENGTHS, Case

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


def scene_of(case: Case, folder: Path, name: str) -> Scene:
    """The scene of a case, written to a folder."""
    path = write_scene(
        folder,
        name,
        case.precision,
        case.networks(),
        case.arrangement,
        case.activation,
        case.options,
        design=case.design,
        sections=case.sections,
        interface=case.interface,
        hardware=case.hardware,
        window=case.window,
        functions=case.named_functions(),
    )
    return load_scene(str(path))


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
