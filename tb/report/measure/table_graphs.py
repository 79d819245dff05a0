"""The held-out errors of the designs that take a frame every clock, with tables and with tanh."""

from typing import Any

import numpy as np

from golden import spline_training
from golden.dense import Trained
from golden.disturbance import Disturbance
from golden.input_error import InputError
from golden.networks.network import Network
from golden.precision import SIGNAL
from golden.real import Real
from golden.scene import Scene, load_scene
from golden.scene_errors import provenances
from golden.spline_training import SplineStages
from golden.training import search
from golden.training.split import split_of
from golden.training.stages import Stages
from tb.report.measure.table import Cell, Table

SCENES = ("digit-fast", "comparison/digit-tables")
# In volts.
NOISES = (0.001, 0.002)
# How often noise is drawn for each row.
DRAWS = 50

NOTES = {
    "table_graph": "The figures are mean errors in percent on the held-out rows of scenes that "
    "take a frame every clock. The networks are those that were trained without these rows, from "
    "the starts that the provenance of the scenes names; the shipped ones were then trained on "
    "with all rows. 'Float' is the network in floating point, and all others are bit-true. Errors "
    f"with noise on every reading are means over {DRAWS} draws.",
}


def table_graph(seed: int) -> Table:
    """The errors as recorded and with noise; the seed draws the noise."""
    rows: list[list[Cell]] = []
    for name in SCENES:
        scene = load_scene(name)
        network = tested(scene)
        hardware = scene.build(network)
        found = [_real(scene, network), _bit_true(scene, hardware, Disturbance(), 1, seed)]
        found += [_bit_true(scene, hardware, Disturbance(noise), DRAWS, seed) for noise in NOISES]
        for c, output in enumerate(scene.outputs):
            rows.append([name, output, *(float(errors[c]) for errors in found)])
    noisy = [f"{1e3 * noise:g} mV %" for noise in NOISES]
    return Table(
        "table_graph",
        ["scene", "output", "float %", "as recorded %", *noisy],
        rows,
        NOTES["table_graph"],
    )


def tested(scene: Scene) -> Trained:
    """The only network of a scene as it was before the held-out rows took part in its training."""
    stories = provenances(scene)
    if stories is None:
        raise InputError(f"{scene.path}: got a network of unknown training, expected make train's")
    splines = bool(scene.training.functions)
    stages: Any = SplineStages(scene) if splines else Stages(scene)
    candidates = (spline_training if splines else search).candidates(stages.task([], 0))
    stages.add(*next(one for one in candidates if one[1] == stories[0]["best_restart"]))
    network: Trained = stages.tested[0]
    return network


def _real(scene: Scene, network: Trained) -> Real:
    """The mean error of each output in floating point, on held-out rows as recorded."""
    vectors, rows = scene.vectors(), split_of(scene).test
    results = network.process(vectors.inputs, scene.scheme.real)
    return np.asarray(vectors.percent_errors(results)[rows].mean(axis=0))


def _bit_true(
    scene: Scene, hardware: Network, disturbance: Disturbance, draws: int, seed: int
) -> Real:
    """The mean error of each output in hardware, on held-out rows that are disturbed."""
    vectors, rows = scene.vectors(), split_of(scene).test
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(draws):
        codes, _ = SIGNAL.quantise(disturbance.of(vectors.inputs, rng))
        results = SIGNAL.to_real(hardware.process(codes))
        found.append(vectors.percent_errors(results)[rows].mean(axis=0))
    return np.asarray(np.mean(found, axis=0))
