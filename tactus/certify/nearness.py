"""How near the hardware is to the network in floating point, for the page of a certificate."""

from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from golden.input_error import InputError
from golden.networks.design import Design
from golden.networks.engine import Engine
from golden.networks.network import Network
from golden.networks.oracle import error_bounds
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.trained.dense import layers_of
from tactus.errors import decisions_of, scene_errors
from tactus.report.measure.table import Cell, Table
from tactus.scene import Scene
from tactus.scene.codes import hidden_saturations, saturating
from tactus.verify.distance import bounds, up
from tactus.verify.every_frame.specify import description


@dataclass(frozen=True)
class Nearness:
    """What the page says about the errors of the hardware.

    errors: For each output the errors met and the bound.
    bounded: Whether a bound is known.
    """

    errors: Table
    sentences: list[str]
    bounded: bool


def nearness(scene: Scene, design: Network, random: Codes) -> Nearness:
    """Compare the hardware with floating point on recorded and on random frames.

    Where the network sees past frames, only recorded frames are compared.
    """
    recorded = scene.vectors().codes
    codes = recorded if design.past else np.concatenate([recorded, random])
    real = scene.process_real(SIGNAL.to_real(codes))
    exact = np.clip(real, *SIGNAL.to_real([SIGNAL.low, SIGNAL.high]))
    met = np.abs(SIGNAL.to_real(design.core.process(codes)) - exact)
    limits = _bounds(scene, design.core)
    unit = float(1 << SIGNAL.frac)
    percent = scene_errors(scene)
    rows: list[list[Cell]] = []
    for n, name in enumerate(scene.outputs):
        bound = None if limits is None else up(float(limits[n] * unit))
        row: list[Cell] = [name, round(float(met[:, n].max() * unit), 1), bound]
        for kind in ("float", "bit-true"):
            error = percent[kind][n]
            row += [round(error.mean, 3), round(error.worst, 3)]
        rows.append(row)
    table = Table(
        "nearness",
        [
            "output",
            "largest difference from floating point met, codes",
            "bound, codes",
            "float: mean error, %",
            "float: largest, %",
            "hardware: mean error, %",
            "hardware: largest, %",
        ],
        rows,
        f"Differences are those of {len(codes)} frames, errors are those of the recorded frames. "
        "Floating point saturates where the hardware does.",
    )
    sentences = [] if limits is None else _decisions(scene, exact[: len(recorded)], limits)
    if scene.labels:
        sentences.append(f"Decisions on recorded rows: {decisions_of(scene).text}.")
    sentences += _saturations(scene, random)
    return Nearness(table, sentences, limits is not None)


def _bounds(scene: Scene, design: Network) -> Real | None:
    """The bound of each output; None where none is known.

    That is so for networks that read each other's outputs. The bounds of what is proved for every
    frame keep the signs of differences, so they are half as large, but not known for every design;
    then several networks side by side have bounds on an engine alone.
    """
    networks = scene.networks()
    several = len(networks) > 1
    if several and scene.arrangement == "cascade":
        return None
    with suppress(InputError):
        layers = [layers_of(network) for network in networks]
        ends = bounds(description(scene), layers, scene.scheme.real)
        found: Real = np.abs(ends).max(axis=1) / (1 << SIGNAL.frac)
        return found
    if not isinstance(design, Design) or (several and not isinstance(design, Engine)):
        return None
    met = scene.settings().met or [()] * len(networks)
    return np.concatenate(
        [
            error_bounds(design, network, scene.precision, network.shape[0], own)
            for network, own in zip(networks, met, strict=True)
        ]
    )


def _decisions(scene: Scene, real: Real, limits: Real) -> list[str]:
    """How many decisions the bound proves to be those of floating point."""
    if not scene.labels:
        return []
    first = real.argmax(axis=1)
    rows = np.arange(len(real))
    ahead = real[rows, first][:, None] - real - limits - limits[first][:, None]
    ahead[rows, first] = np.inf
    proved = int((ahead > 0).all(axis=1).sum())
    return [
        f"The bound proves that hardware and floating point decide alike in {proved} of "
        f"{len(real)} recorded rows; in the other {len(real) - proved} it does not."
    ]


def _saturations(scene: Scene, random: Codes) -> list[str]:
    sentences = [f"{text[0].upper()}{text[1:]}." for text in saturating(scene)]
    if not sentences:
        sentences.append("No output and no hidden sum saturates in a recorded frame.")
    if not scene.twin().past:
        for layer, counts in hidden_saturations(scene, random).items():
            sentences.append(f"Random frames: {layer}: {int(counts.sum())} sums saturate.")
    return sentences
