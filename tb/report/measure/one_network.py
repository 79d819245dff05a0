"""One network in every design, and with fewer digits: cells, clocks, and error of arithmetic."""

from __future__ import annotations

import numpy as np

from golden.fixed import Codes
from golden.networks.arrangement import process_real
from golden.networks.network import Network
from golden.networks.parallel import Parallel
from golden.precision import SIGNAL
from golden.real import Real
from golden.scene import Scene, load_scene
from hdl.synth.budget import budget_path, read_budget
from tb.report.measure.costs import COST, FAMILY
from tb.report.measure.networks import scenes
from tb.report.measure.table import Cell, Table

# The scene whose weights are taken.
OF = "digit-single"
RANDOM_FRAMES = 2000


def one_network(seed: int) -> Table:
    """Every scene with the network of ``OF``, or with one of few digits for the same task, and
    ``parallel``, which none of them names.
    """
    source = load_scene(OF)
    alike = [
        scene
        for scene in scenes()
        if scene.weights_paths == source.weights_paths
        or (scene.training.digits and scene.outputs == source.outputs)
    ]
    parallel = Parallel.of(source.mlps(), source.settings())
    designs: list[tuple[str, Scene, Network]] = [(s.name, s, s.twin()) for s in alike]
    designs.append(("", source, parallel))
    recorded = source.vectors().codes
    random = random_frames(seed, recorded.shape[1])
    rows: list[list[Cell]] = []
    for name, scene, design in designs:
        path = budget_path(scene.path)
        cells = read_budget(path)[FAMILY].get(design.entity) if path.is_file() and name else None
        rows.append(
            [
                name or None,
                design.block,
                scene.activation_text,
                *(cells[kind] if cells else None for kind in COST),
                design.output_clocks[-1],
                design.interval,
                *(
                    mean_error(design.process(x), floating_point(scene, x))
                    for x in (recorded, random)
                ),
            ]
        )
    return Table(
        "one_network",
        [
            "scene",
            "design",
            "activation",
            *COST,
            "latency clocks",
            "interval clocks",
            "recorded, 2^-13",
            "random, 2^-13",
        ],
        rows,
        f"The network 4:16:4 of {OF}, its weights of 18 bits, in every design; digit-fast and "
        "digit-fast-clock have one with few digits in its weights. Cells for Virtex-II "
        "with the hierarchy as exported, as recorded by make synth. Mean magnitude of the "
        "difference from the same network in floating point, saturated as the outputs are, in "
        f"units of 2^-13, over all outputs, of the recorded frames and of "
        f"{RANDOM_FRAMES} random ones.",
    )


def random_frames(seed: int, inputs: int) -> Codes:
    """Frames in which every code is as likely."""
    shape = (RANDOM_FRAMES, inputs)
    return np.random.default_rng(seed).integers(SIGNAL.low, SIGNAL.high + 1, shape)


def floating_point(scene: Scene, frames: Codes) -> Real:
    """What a scene's networks are in floating point."""
    x = SIGNAL.to_real(frames)
    return process_real(scene.arrangement, scene.mlps(), x, scene.scheme.real)


def mean_error(outputs: Codes, real: Real) -> float:
    """Mean magnitude of the error in units of 2**-13, over frames and outputs.

    Parameters
    ----------
    outputs : integer array, shape (frames, outputs)
        Codes.
    real : float array, the same shape
        What floating point computes; outside the range of a code its end is what is right.
    """
    reached = np.clip(real, SIGNAL.to_real(SIGNAL.low), SIGNAL.to_real(SIGNAL.high))
    return float(np.abs(SIGNAL.to_real(outputs) - reached).mean() * (1 << SIGNAL.frac))
