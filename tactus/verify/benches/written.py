"""Writes scenes of random networks: the cases of benches, and what tests make up."""

from pathlib import Path

import numpy as np

from golden.trained.dense import DenseNetwork
from golden.trained.function import Function
from golden.trained.window import Window
from tactus.core.templates import environment
from tactus.network_files.network_file import save_network
from tactus.scene import Scene, load_scene
from tb.common.cases import LENGTHS, Case

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
    networks: list[DenseNetwork],
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
    hidden = layers[0]
    if len(networks) > 1:
        hidden = [one[0] if len(one) == 1 else 0 for one in layers]
    weights = [f"{name}.npz", *(f"{name}-{i}.npz" for i in range(1, len(networks)))]
    text = (
        environment("tactus.verify.benches")
        .get_template("scene.toml.jinja")
        .render(
            name=name,
            sensors=sensors,
            outputs=targets,
            window=window,
            lengths=LENGTHS,
            arrangement=arrangement,
            hidden=hidden[0] if len(hidden) == 1 else hidden or 0,
            weights=weights[0] if len(weights) == 1 else weights,
            functions=functions,
            design=design,
            activation=activation,
            options=OPTIONS.get(activation, "{}") if options is None else options,
            precision=precision,
            interface=interface,
            hardware=hardware,
            sections=sections,
        )
    )
    path = folder / f"{name}.toml"
    path.write_text(text, encoding="utf-8")
    for file, network in zip(weights, networks, strict=True):
        save_network(folder / file, network, {"scene": name})
    return path
