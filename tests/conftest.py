"""Small scenes with random networks, for shapes and weights that no shipped scene has."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from golden.machine import closing
from golden.network_file import save_network
from golden.networks.mlp import Mlp
from golden.networks.network import Network
from golden.precision import PRECISIONS
from golden.scene import Scene, load_scene, scene_names
from tb.common.tools import simulator_versions

STARTED = time.perf_counter()


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Before pytest's closing line, on what the tests ran."""
    terminalreporter.section("machine")
    for line in closing(time.perf_counter() - STARTED, **simulator_versions()):
        terminalreporter.line(line)


TEMPLATE = """
[data]
file = "{name}.csv"
sensors = {sensors}
outputs = {outputs}
group_by = "y0"
{lengths}
[network]
arrangement = "{arrangement}"
hidden = {hidden}
weights = {weights}

[hardware]
design = "{design}"
activation = "{activation}"
activation_options = {options}
precision = "{precision}"
interface = "{interface}"
{sections}
[training]
restarts = 2
steps = 20
"""


# For benches: a few steps that diverge near the gate, so that the regression saturates.
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
    activation: str = "gradient",
    options: str | None = None,
    rows: int = 12,
    design: str = "hybrid",
    sections: str = "",
    interface: str = "stream",
) -> Path:
    """A scene with random vectors and the given networks; returns its TOML file.

    ``sections`` are those that a scene may do without; where there are any, y1 and y2 have lengths.
    """
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
        design=design,
        activation=activation,
        options=OPTIONS.get(activation, "{}") if options is None else options,
        lengths=LENGTHS if sections else "",
        sections=sections,
        interface=interface,
    )
    path = folder / f"{name}.toml"
    path.write_text(text.replace("'", '"'))
    for file, mlp in zip(weights, mlps, strict=True):
        save_network(folder / file, mlp, {"scene": name})
    return path


@dataclass(frozen=True)
class Case:
    """A scene for the benches of some blocks: random networks of shapes that no shipped scene has.

    ``spread`` is that of the weights of layer 1. The last hidden node of a single network is
    without weights, where there is another.
    """

    blocks: tuple[str, ...]
    shapes: list[tuple[int, int, int]]
    precision: str
    spread: float = 1.0
    activation: str = "gradient"
    options: str | None = None
    arrangement: str = "single"
    seed: int = 7
    design: str = "hybrid"
    sections: str = ""
    interface: str = "stream"

    def networks(self) -> list[Mlp]:
        mlps = [
            random_mlp(shape, self.spread, self.seed + i) for i, shape in enumerate(self.shapes)
        ]
        if self.arrangement == "single" and self.shapes[0][1] > 1:
            mlps[0].w1[-1] = 0
            mlps[0].b1[-1] = 0
        return mlps

    def scene(self, folder: Path, name: str) -> Scene:
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
        )
        return load_scene(str(path))


FOLDED = ("hybrid", "input_controller", "output_controller", "output_integral")
CASCADE = ("cascade", "stream_multiplexer", "output_collector")
MULTIPLE = ("multiple", "output_collector")
PROFILE = (
    "readout",
    "load_profile",
    "ramp",
    "divider",
    "power_fold",
    "exp_memory",
    "exp_interpolator",
)
INSTRUMENT = ("instrument", "scan_sequencer")
FRONT_END = "\n[front_end]\n"
AXIS = Case(("axis_network",), [(2, 3, 5)], "precise", interface="axi_stream")
GRADIENT = Case(("gradient", *FOLDED), [(1, 1, 1)], "precise")
PARALLEL = Case(("parallel", "neuron"), [(2, 3, 2)], "thesis", design="parallel")
PRECISE = Case(("precise", "hybrid"), [(2, 3, 2)], "precise", activation="precise")
BLOCK_RAM = '{ coefficients = "block_ram" }'


def scheme_cases() -> dict[str, Case]:
    """The other activations in both precisions, with a neuron that reaches all segments."""
    blocks = {
        "gradient_parallel": ("gradient_parallel", "comparator_bank", "hybrid"),
        "lut": ("lut", "hybrid"),
        "pade": ("pade", "hybrid", "input_controller"),
        "polynomial": ("polynomial", "hybrid"),
    }
    return {
        f"{name}-{precision}": Case(
            parts, [(2, 1, 2)], precision, spread=2.0, activation=name, seed=8
        )
        for name, parts in blocks.items()
        for precision in PRECISIONS
    }


# Of a cascade, outputs in another order, one of which is not drawn; a ramp that starts below 0; a
# gain that is no whole number.
OTHER_PROFILE = """
[visualisation]
load = "y4"
position = "y2"
width = "y1"
shape = "y0"
start = -1.0
stop = 0.95
step = 0.15
shape_threshold = -0.25
"""

# Least shapes, more outputs than inputs (the spacing counter), one output, odd adder trees, Q_j of
# several hundred; each activation with few and with all of its segments; networks whose depth
# differs, so that results wait for each other, and more of them than samples.
CASES = scheme_cases() | {
    "lut-short": Case(("lut",), [(2, 1, 2)], "thesis", spread=2.0, activation="lut"),
    "polynomial-short": Case(
        ("polynomial",), [(2, 1, 2)], "precise", spread=2.0, activation="polynomial"
    ),
    "least": GRADIENT,
    "least-thesis": replace(GRADIENT, shapes=[(1, 2, 1)], precision="thesis"),
    "wide": replace(GRADIENT, shapes=[(2, 3, 5)]),
    "wide-thesis": replace(GRADIENT, shapes=[(3, 5, 4)], precision="thesis"),
    "huge": replace(GRADIENT, shapes=[(4, 3, 2)], precision="thesis", spread=100.0),
    "huge-precise": replace(GRADIENT, shapes=[(4, 3, 2)], spread=100.0),
    "logic": replace(PRECISE, spread=0.5),
    "logic-huge": replace(PRECISE, shapes=[(2, 2, 1)], spread=100.0),
    "block-ram": replace(PRECISE, options=BLOCK_RAM, spread=0.5),
    "block-ram-huge": replace(PRECISE, options=BLOCK_RAM, shapes=[(2, 2, 1)], spread=100.0),
    "parallel": PARALLEL,
    "least-parallel": replace(PARALLEL, shapes=[(1, 1, 1)], precision="precise"),
    "wide-parallel": replace(PARALLEL, shapes=[(5, 4, 3)], precision="precise"),
    "huge-parallel": replace(PARALLEL, shapes=[(4, 3, 2)], spread=100.0),
    "pade-parallel": replace(PARALLEL, activation="pade"),
    "precise-parallel": replace(PARALLEL, precision="precise", activation="precise"),
    "least-cascade": Case(CASCADE, [(1, 1, 1), (2, 2, 1)], "precise", arrangement="cascade"),
    "deep-cascade": Case(
        CASCADE, [(2, 1, 1), (3, 9, 1), (4, 2, 1), (5, 5, 1)], "thesis", arrangement="cascade"
    ),
    "least-multiple": Case(MULTIPLE, [(1, 2, 1), (1, 1, 1)], "thesis", arrangement="multiple"),
    "wide-multiple": Case(
        MULTIPLE, [(2, 9, 1), (2, 1, 1), (2, 4, 1)], "precise", arrangement="multiple"
    ),
    "axis": AXIS,
    "least-axis": replace(AXIS, shapes=[(1, 2, 1)], precision="thesis"),
    "pade-axis": replace(AXIS, shapes=[(2, 2, 2)], activation="pade"),
    "axis-cascade": replace(AXIS, shapes=[(2, 3, 1), (3, 2, 1), (4, 2, 1)], arrangement="cascade"),
    "axis-multiple": replace(AXIS, shapes=[(2, 2, 1), (2, 4, 1)], arrangement="multiple"),
    "profile": Case(PROFILE, [(4, 3, 4)], "precise", sections=VISUALISATION),
    "other-profile": Case(
        ("readout", "ramp", "divider"),
        [(2, 1, 1), (3, 2, 1), (4, 1, 1), (5, 2, 1), (6, 1, 1)],
        "precise",
        arrangement="cascade",
        sections=OTHER_PROFILE,
    ),
    "instrument": Case(
        INSTRUMENT,
        [(4, 3, 1), (5, 2, 1), (6, 1, 1), (7, 3, 1)],
        "precise",
        arrangement="cascade",
        sections=f"{VISUALISATION}{FRONT_END}counter_width = 10\n",
    ),
    # No profile; the narrowest counter, one clock after the address is there.
    "least-instrument": Case(
        INSTRUMENT, [(3, 2, 3)], "precise", sections=f"{FRONT_END}counter_width = 3\n"
    ),
    "one-sensor": Case(
        INSTRUMENT, [(1, 2, 4)], "thesis", sections=f"{FRONT_END}counter_width = 4\n"
    ),
}


def every_design(folder: Path) -> list[Network]:
    """Designs that hold every block between them: the shipped scenes and the cases."""
    scenes = [load_scene(name) for name in scene_names()]
    scenes += [case.scene(folder, name) for name, case in CASES.items()]
    return [scene.design() for scene in scenes]


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
