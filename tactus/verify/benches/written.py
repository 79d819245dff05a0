"""Writes scenes of random networks: the cases of benches, and what tests make up."""

from pathlib import Path
from typing import Any

import numpy as np

from golden.trained.dense import DenseNetwork
from tactus.core.templates import environment
from tactus.network_files.network_file import save_network
from tactus.scene import Scene, load_scene
from tb.common.cases import LENGTHS, Case

# With so few iterations the regression of pade diverges near the gate, so that it saturates.
OPTIONS = {"pade": "{ rho = 1.5, iterations = 3 }"}


def scene_of(case: Case, folder: Path, name: str) -> Scene:
    """The scene of a case, written to a folder."""
    return load_scene(str(_write(case, folder, name, case.networks(), 12)))


def write_scene(
    folder: Path,
    name: str,
    precision: str,
    networks: list[DenseNetwork],
    arrangement: str = "single",
    activation: str = "gradient",
    options: str | None = None,
    rows: int = 12,
    **keys: Any,
) -> Path:
    """Write a scene with random vectors and the given networks, and return its TOML file.

    ``keys`` are further fields of a ``Case``: ``hardware`` has the keys that only concern the
    design. ``sections`` are optional sections of the scene; if there are any, y1 and y2 have
    lengths. Without a ``window`` the networks take every frame as it is. With one there are
    ``rows`` frames after those that lack a complete past.
    """
    more: dict[str, Any] = {
        "arrangement": arrangement,
        "activation": activation,
        "options": options,
    }
    return _write(Case([], precision, **more, **keys), folder, name, networks, rows)


def _write(case: Case, folder: Path, name: str, networks: list[DenseNetwork], rows: int) -> Path:
    window = case.window
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
    options = OPTIONS.get(case.activation, "{}") if case.options is None else case.options
    text = (
        environment("tactus.verify.benches")
        .get_template("scene.toml.jinja")
        .render(
            case=case,
            name=name,
            sensors=sensors,
            outputs=targets,
            window=window,
            lengths=LENGTHS,
            hidden=hidden[0] if len(hidden) == 1 else hidden or 0,
            weights=weights[0] if len(weights) == 1 else weights,
            options=options,
        )
    )
    path = folder / f"{name}.toml"
    path.write_text(text, encoding="utf-8")
    for file, network in zip(weights, networks, strict=True):
        save_network(folder / file, network, {"scene": name})
    return path
