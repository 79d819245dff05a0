"""The comparison: the network, the frames, and the errors against floating point."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from golden.networks.constants import Constants, constants_of
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.trained.mlp import Mlp, tanh
from studies.peers.cells import Cells
from tactus.scene import Scene

# The scene whose network every peer computes that takes ours at all, with weights of 18 bits, and
# one whose weights have few signed digits.
MAIN = "comparison/digit-fast-full"
FEW = "digit-fast"
# Networks that tell classes apart: of the jets at a collider, and of wines.
JETS, WINE, BEANS = "jets", "wine", "beans"
RANDOM_FRAMES = 2000
# The headings of the columns, and the family and the kind of cells that stand below them.
COLUMNS = {
    "LUT4": ("xc2v", "LUT"),
    "LUT6": ("xc7", "LUT"),
    "flip-flop": ("xc2v", "flip-flop"),
    "MULT18": ("xc2v", "multiplier"),
    "RAMB16": ("xc2v", "block RAM"),
}


@dataclass(frozen=True)
class Task:
    """The task that all designs compute.

    scene: Network and frames come from it.
    mlp: The network in floating point.
    constants: The codes of its weights and biases, which are the same for all designs.
    recorded, random, shape (frames, inputs): The codes of the samples.
    """

    scene: Scene
    mlp: Mlp
    constants: Constants
    recorded: Codes
    random: Codes

    @property
    def name(self) -> str:
        """The name of the network in the table."""
        return self.scene.name

    @property
    def frames(self) -> Codes:
        """The recorded frames, then the random ones."""
        return np.concatenate([self.recorded, self.random])

    def question(self) -> dict[str, Any]:
        """The codes and fraction bits of both layers, and the frames, in a form for JSON."""
        layers = {"first": self.constants.first, "second": self.constants.second}
        return {
            **{
                name: {"weights": one.weights, "biases": one.biases, "frac": one.fmt.frac}
                for name, one in layers.items()
            },
            "frames": self.frames.tolist(),
        }

    def errors(self, outputs: Codes) -> tuple[float, float]:
        """The ``mean_error`` of outputs for ``frames``, over recorded and over random frames."""
        if outputs.shape != (len(self.frames), self.mlp.shape[-1]):
            raise ValueError(f"outputs: got shape {outputs.shape} for {len(self.frames)} frames")
        cut = len(self.recorded)
        return (
            mean_error(outputs[:cut], self.mlp.process(SIGNAL.to_real(self.recorded), tanh)),
            mean_error(outputs[cut:], self.mlp.process(SIGNAL.to_real(self.random), tanh)),
        )


def mean_error(outputs: Codes, real: Real) -> float:
    """The mean magnitude of the error in units of 2**-13, over frames and outputs.

    real: The results in floating point. Beyond the range of codes, its end counts as right.
    """
    reached = np.clip(real, SIGNAL.to_real(SIGNAL.low), SIGNAL.to_real(SIGNAL.high))
    return float(np.abs(SIGNAL.to_real(outputs) - reached).mean() * (1 << SIGNAL.frac))


def task_of(scene: Scene, seed: int) -> Task:
    """The one network of a scene, its recorded frames, and uniformly random frames."""
    (mlp,) = scene.mlps()
    # Every code is equally likely.
    rng = np.random.default_rng(seed)
    random = rng.integers(SIGNAL.low, SIGNAL.high + 1, (RANDOM_FRAMES, mlp.shape[0]))
    constants = constants_of(mlp, scene.settings())
    return Task(scene, mlp, constants, scene.vectors().codes, random)


@dataclass(frozen=True)
class Row:
    """One design.

    network: The network that it computes.
    cells: The count of each kind of ``tactus.synth.cells.KINDS``, in each family; None for a
    design
        that is not in an FPGA.
    clocks: The clocks from the last sample of a frame to its last output.
    interval: The clocks from one frame to the next.
    errors: See ``Task.errors``; None twice for a network that tells classes apart.
    right: Of such a network, how many of the rows held out from its training are decided rightly,
        in percent.
    """

    network: str
    name: str
    cells: Cells | None
    clocks: int
    interval: int
    errors: tuple[float | None, float | None] = (None, None)
    right: float | None = None
