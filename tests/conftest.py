"""Small scenes with random networks, for shapes and weights that no shipped scene has."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from golden.activation.schemes import SCHEMES
from golden.network_file import save_network
from golden.networks.hybrid import Hybrid
from golden.networks.mlp import Mlp
from golden.scene import Scene, load_scene, scene_names

TEMPLATE = """
[data]
file = "{name}.csv"
sensors = {sensors}
outputs = {outputs}
group_by = "y0"

[network]
arrangement = "single"
hidden = {hidden}
weights = "{name}.npz"

[hardware]
design = "hybrid"
activation = "{activation}"
activation_options = {options}
precision = "{precision}"

[training]
restarts = 2
steps = 20
"""


# For benches: a few steps that diverge near the gate, so that the regression saturates.
OPTIONS = {"pade": "{ rho = 1.5, iterations = 3 }"}


def random_mlp(shape: tuple[int, int, int], spread: float, seed: int) -> Mlp:
    """Normal weights: ``spread`` in layer 1, 0.3 in layer 2."""
    inputs, hidden, outputs = shape
    rng = np.random.default_rng(seed)
    return Mlp(
        rng.normal(0, spread, (hidden, inputs)),
        rng.normal(0, spread / 2, hidden),
        rng.normal(0, 0.3, (outputs, hidden)),
        rng.normal(0, 0.3, outputs),
    )


def write_scene(
    folder: Path,
    name: str,
    shape: tuple[int, int, int],
    precision: str,
    mlp: Mlp,
    rows: int = 12,
    activation: str = "gradient",
    options: str | None = None,
) -> Path:
    """A scene with random vectors and the given network; returns its TOML file."""
    inputs, hidden, outputs = shape
    sensors = [f"x{k}" for k in range(inputs)]
    targets = [f"y{i}" for i in range(outputs)]
    rng = np.random.default_rng(5)
    table = np.concatenate(
        [rng.uniform(-1, 0.99, (rows, inputs)), rng.uniform(0.1, 0.9, (rows, outputs))], axis=1
    )
    lines = [",".join(sensors + targets)] + [",".join(f"{v:.4f}" for v in row) for row in table]
    (folder / f"{name}.csv").write_text("\n".join(lines) + "\n")
    text = TEMPLATE.format(
        name=name,
        sensors=sensors,
        outputs=targets,
        hidden=hidden,
        precision=precision,
        activation=activation,
        options=OPTIONS.get(activation, "{}") if options is None else options,
    )
    path = folder / f"{name}.toml"
    path.write_text(text.replace("'", '"'))
    save_network(folder / f"{name}.npz", mlp, {"scene": name})
    return path


def designs(folder: Path) -> Iterator[Hybrid]:
    """Networks that contain every block: the shipped ones, and one for each activation."""
    for name in scene_names():
        yield load_scene(name).design()
    shape = (2, 2, 1)
    for name in SCHEMES:
        mlp = random_mlp(shape, 1.0, 1)
        yield load_scene(
            str(write_scene(folder, name, shape, "thesis", mlp, activation=name))
        ).design()


@pytest.fixture
def small_scene(tmp_path: Path) -> Scene:
    """A 3:5:2 scene in precise precision."""
    shape = (3, 5, 2)
    return load_scene(
        str(write_scene(tmp_path, "small", shape, "precise", random_mlp(shape, 1.0, 1)))
    )
