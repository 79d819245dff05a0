"""Draws random scenes with any allowed choice of keys, and with small random networks."""

from contextlib import suppress
from pathlib import Path

import numpy as np

from golden.activation.schemes import SCHEMES
from golden.input_error import InputError
from golden.networks.designs import DESIGNS
from golden.sensing.converter_parts import PARTS
from golden.trained.dense import Quantiser
from golden.trained.window import Window
from tactus.scene import Scene
from tactus.verify.benches.written import scene_of
from tb.common.cases import FRONT_END, VISUALISATION, Case

# The spread of the weights, from tiny up to the limits of a network.
SPREADS = (0.001, 0.05, 0.5, 1.0, 4.0, 20.0, 100.0)
ACTIVATION_OPTIONS = {
    "pade": ["{}", "{ rho = 1.5, iterations = 3 }", "{ rho = 1.5, iterations = 11 }"],
    "precise": ["{}", '{ coefficients = "block_ram" }'],
}


def drawn_scene(seed: int, folder: Path, engine: bool = False) -> Scene:
    """The first valid case of a seed. Cases before it must be refused with a message."""
    rng = np.random.default_rng(seed)
    while True:
        case = drawn_engine(rng) if engine else drawn_case(rng)
        with suppress(InputError, RuntimeError):
            scene = scene_of(case, folder, f"drawn{seed}")
            scene.twin()
            return scene


def drawn_case(rng: np.random.Generator) -> Case:
    """A random case of any design, arrangement, activation, precision and surroundings."""
    design = str(rng.choice([*DESIGNS]))
    kind = DESIGNS[design]
    arrangement = str(rng.choice(kind.arrangements))
    activation = str(rng.choice(kind.known_activations or [*SCHEMES]))
    shown = bool(rng.random() < 0.3)
    shapes = drawn_shapes(rng, arrangement, shown)
    surroundings, clock = drawn_surroundings(rng, shown)
    inputs = shapes[0][0]
    window = None
    if rng.random() < 0.2:
        window = Window(((0, 2),) * (inputs // 2) + ((0,),) * (inputs % 2))
    return Case(
        shapes,
        str(rng.choice(kind.precisions)),
        spread=float(rng.choice(SPREADS)),
        activation=activation,
        options=str(rng.choice(ACTIVATION_OPTIONS.get(activation, ["{}"]))),
        arrangement=arrangement,
        seed=int(rng.integers(1000)),
        design=design,
        sections=surroundings,
        interface="axi_stream" if not surroundings and rng.random() < 0.3 else "stream",
        hardware="\n".join([*drawn_hardware(rng, design), *clock]),
        learned=kind.learned_functions,
        window=window,
    )


def drawn_engine(rng: np.random.Generator) -> Case:
    """A random case of a network of any depth on an engine of one lane or of four."""
    layers = int(rng.integers(1, 4))
    inputs, *nodes, outputs = (int(n) for n in rng.integers(2, 6, layers + 2))
    quantiser = None
    kinds = ["relu", "linear"]
    if rng.random() < 0.5:
        scale, zero, high = 2.0 ** -rng.integers(2, 6), rng.integers(3), rng.choice([15, 63, 255])
        rounding = str(rng.choice(["even", "away", "floor"]))
        quantiser = Quantiser(float(scale), int(zero), 0, int(high), rounding)
    else:
        kinds += ["tanh", "sigmoid", "leaky_relu", "hard_tanh"]
    lines = [f"lanes = {rng.choice([1, 4])}"]
    lines.append(f"argmax = {rng.choice(['true', 'false'])}")
    lines.append(f'pipeline = "{rng.choice(["short", "deep"])}"')
    return Case(
        [(inputs, *nodes, outputs)],
        "exact",
        spread=float(rng.choice([0.5, 1.5, 4.0])),
        activation="precise",
        options="{}",
        seed=int(rng.integers(1000)),
        design="engine",
        hardware="\n".join(lines),
        activations=tuple(map(str, rng.choice(kinds, layers))),
        quantiser=quantiser,
    )


def drawn_shapes(rng: np.random.Generator, arrangement: str, shown: bool) -> list[tuple[int, ...]]:
    """Random numbers of inputs, hidden nodes and outputs. A profile needs four outputs."""
    inputs = int(rng.integers(1, 4))
    hidden = rng.choice([1, 2, 3, 4], 4).tolist()
    outputs = 4 if shown else int(rng.integers(1, 7))
    count = 4 if shown else int(rng.integers(2, 5))
    shapes: dict[str, list[tuple[int, ...]]] = {
        "single": [(inputs, hidden[0], outputs)],
        "multiple": [(inputs, nodes, 1) for nodes in hidden[:count]],
        "cascade": [(inputs + i, nodes, 1) for i, nodes in enumerate(hidden[:count])],
    }
    return shapes[arrangement]


def drawn_hardware(rng: np.random.Generator, design: str) -> list[str]:
    """Random keys that only this design has."""
    lines = []
    if design == "adder_graph" and rng.random() < 0.5:
        lines.append(f"adders_per_clock = {rng.integers(1, 4)}")
    if design == "table_graph":
        # Few bits, because a drawn network has many functions.
        lines.append(f"sample_bits = {rng.integers(4, 9)}")
        lines.append(f"hidden_bits = {rng.integers(4, 9)}")
        lines.append(f"output_bits = {rng.integers(4, 15)}")
    if design == "engine":
        for key, values in (
            ("segment_width", [6, 7, 8]),
            ("pipeline", ['"deep"', '"short"']),
            ("lanes", ["0", "1", "2", "3", "9"]),
            ("reload", ["true"]),
        ):
            if rng.random() < 0.3:
                lines.append(f"{key} = {rng.choice(values)}")
    return lines


def drawn_surroundings(rng: np.random.Generator, shown: bool) -> tuple[str, list[str]]:
    """Random sections around the networks, and the clock that they need."""
    sections = VISUALISATION + "stop = 0.9\nstep = 0.3\n" if shown else ""
    around = str(rng.choice(["nothing", "scan", "converter", "line"], p=[0.55, 0.15, 0.15, 0.15]))
    if around == "nothing":
        return sections, []
    if around == "scan":
        return f"{sections}{FRONT_END}counter_width = {rng.integers(4, 14)}\n", []
    if shown and rng.random() < 0.5:
        sections += 'analogue = "pulse_density"\n'
    sections += f'{FRONT_END}converter = "{rng.choice([*PARTS])}"\n'
    sections += f"counter_width = {rng.integers(7, 13)}\n"
    if around == "line":
        sections += "\n[uart]\n" + str(rng.choice(["", "baud = 57_600\n"]))
    return sections, [f"clock_mhz = {rng.choice([4.0, 5.0, 12.0])}"]
