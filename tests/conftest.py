"""Small scenes with random networks, for shapes and weights that no shipped scene has."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from golden.network_file import save_network
from golden.networks.mlp import Mlp
from golden.scene import Scene, load_scene

TEMPLATE = """
[data]
file = "{name}.csv"
sensors = {sensors}
outputs = {outputs}
group_by = "y0"

[network]
arrangement = "{arrangement}"
hidden = {hidden}
weights = {weights}

[hardware]
design = "hybrid"
activation = "gradient"
precision = "{precision}"

[training]
restarts = 2
steps = 20
"""


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
    precision: str,
    mlps: list[Mlp],
    arrangement: str = "single",
    rows: int = 12,
) -> Path:
    """A scene with random vectors and the given networks; returns its TOML file."""
    inputs = mlps[0].shape[0]
    outputs = sum(mlp.shape[2] for mlp in mlps)
    sensors = [f"x{k}" for k in range(inputs)]
    targets = [f"y{i}" for i in range(outputs)]
    rng = np.random.default_rng(5)
    table = np.concatenate(
        [rng.uniform(-1, 0.99, (rows, inputs)), rng.uniform(0.1, 0.9, (rows, outputs))], axis=1
    )
    lines = [",".join(sensors + targets)] + [",".join(f"{v:.4f}" for v in row) for row in table]
    (folder / f"{name}.csv").write_text("\n".join(lines) + "\n")
    hidden = [mlp.shape[1] for mlp in mlps]
    weights = [f"{name}.npz", *(f"{name}-{i}.npz" for i in range(1, len(mlps)))]
    text = TEMPLATE.format(
        name=name,
        sensors=sensors,
        outputs=targets,
        arrangement=arrangement,
        hidden=hidden[0] if len(mlps) == 1 else hidden,
        weights=f'"{name}.npz"' if len(mlps) == 1 else weights,
        precision=precision,
    )
    path = folder / f"{name}.toml"
    path.write_text(text.replace("'", '"'))
    for file, mlp in zip(weights, mlps, strict=True):
        save_network(folder / file, mlp, {"scene": name})
    return path


@pytest.fixture
def small_scene(tmp_path: Path) -> Scene:
    """A 3:5:2 scene in precise precision."""
    mlp = random_mlp((3, 5, 2), 1.0, 1)
    return load_scene(str(write_scene(tmp_path, "small", "precise", [mlp])))


@pytest.fixture
def small_cascade(tmp_path: Path) -> Scene:
    """Networks 3:4:1, 4:3:1 and 5:2:1 in a cascade, precise precision."""
    mlps = [random_mlp((3 + i, 4 - i, 1), 1.0, i) for i in range(3)]
    return load_scene(str(write_scene(tmp_path, "chain", "precise", mlps, "cascade")))
