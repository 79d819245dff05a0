"""What is compared: the network, the frames, errors against the float network, the table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from golden.fixed import Codes
from golden.mlp import Mlp, tanh
from golden.networks.constants import Constants, constants_of
from golden.precision import SIGNAL
from golden.scene import Scene
from tb.report.measure.one_network import mean_error, random_frames
from tb.report.measure.table import Cell, Table

# Headings, and the kinds of ``hdl.synth.netlist.KINDS`` under them.
COLUMNS = {
    "LUT4": "LUT",
    "flip-flop": "flip-flop",
    "MULT18": "multiplier",
    "RAMB16": "block RAM",
}


@dataclass(frozen=True)
class Task:
    """What all of them compute.

    Attributes
    ----------
    mlp : Mlp
        The network in floating point.
    constants : Constants
        Its weights and biases in codes, the same for all.
    recorded, random : integer arrays, shape (frames, inputs)
        Codes of samples.
    """

    mlp: Mlp
    constants: Constants
    recorded: Codes
    random: Codes

    @property
    def frames(self) -> Codes:
        """The recorded frames, then the random ones."""
        return np.concatenate([self.recorded, self.random])

    def given(self) -> dict[str, Any]:
        """Codes and fraction bits of both layers, and the frames, as JSON can hold them."""
        layers = {"first": self.constants.first, "second": self.constants.second}
        return {
            **{
                name: {"weights": one.weights, "biases": one.biases, "frac": one.fmt.frac}
                for name, one in layers.items()
            },
            "frames": self.frames.tolist(),
        }

    def errors(self, outputs: Codes) -> tuple[float, float]:
        """Of the outputs of ``frames``: see ``mean_error``, over recorded and over random ones."""
        if outputs.shape != (len(self.frames), self.mlp.shape[-1]):
            raise ValueError(f"outputs: got shape {outputs.shape} for {len(self.frames)} frames")
        cut = len(self.recorded)
        return (
            mean_error(outputs[:cut], self.mlp.process(SIGNAL.to_real(self.recorded), tanh)),
            mean_error(outputs[cut:], self.mlp.process(SIGNAL.to_real(self.random), tanh)),
        )


def task_of(scene: Scene, seed: int) -> Task:
    """The one network of a scene, its recorded frames and random ones, every code as likely."""
    (mlp,) = scene.mlps()
    random = random_frames(seed, mlp.shape[0])
    constants = constants_of(mlp, scene.settings())
    return Task(mlp, constants, scene.vectors().codes, random)


@dataclass(frozen=True)
class Row:
    """One design.

    Attributes
    ----------
    name : str
    cells : mapping
        By kind, see ``hdl.synth.netlist.KINDS``.
    clocks : int
        From the last sample of a frame to its last output.
    interval : int
        From one frame to the next.
    errors : tuple of float
        See ``Task.errors``.
    """

    name: str
    cells: Mapping[str, int]
    clocks: int
    interval: int
    errors: tuple[float, float]


def compared(rows: Sequence[Row], note: str) -> Table:
    """The rows side by side."""
    lines: list[list[Cell]] = [
        [
            row.name,
            *(row.cells[kind] for kind in COLUMNS.values()),
            row.clocks,
            row.interval,
            *row.errors,
        ]
        for row in rows
    ]
    return Table(
        "peers", ["", *COLUMNS, "clocks", "a frame every", "recorded", "random"], lines, note
    )
