"""Instrument: a network and the profile that is drawn from its outputs."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from golden.block import Block
from golden.fixed import Codes
from golden.layers.input_controller import InputController
from golden.networks.network import Network
from golden.visualisation.load_profile import LoadProfile


@dataclass(frozen=True)
class Instrument(Network):
    """The outputs of a network, and the load along the beam (thesis Figures 5.12 and 5.25).

    As a network it is the one inside: same frames, same outputs, same clocks.

    Parameters
    ----------
    network : Network
    load_profile : LoadProfile
    results : tuple of int
        Which outputs of the network are load, position, width and shape.

    Raises
    ------
    ValueError
        When ``results`` are not four different outputs of the network.
    """

    block = "instrument"
    area = "instruments"
    network: Network
    load_profile: LoadProfile
    results: tuple[int, int, int, int]

    def __post_init__(self) -> None:
        if len(set(self.results)) != 4 or not set(self.results) <= set(range(self.outputs)):
            raise ValueError(
                f"{self.entity}: got results {self.results}, expected four different numbers from "
                f"0 to {self.outputs - 1}"
            )

    @property
    def inputs(self) -> int:
        return self.network.inputs

    @property
    def outputs(self) -> int:
        return self.network.outputs

    @property
    def interval(self) -> int:
        return self.network.interval

    @property
    def input_controller(self) -> InputController:
        return self.network.input_controller

    def parts(self) -> tuple[Block, ...]:
        return (self.network, self.load_profile)

    def left_out(self) -> list[str]:
        return self.network.left_out()

    def compute(self, frames: Codes) -> Codes:
        return self.network.compute(frames)

    def profile(self, outputs: ArrayLike) -> tuple[Codes, Codes]:
        """Positions and profiles, see ``LoadProfile.process``, of frames of outputs.

        Parameters
        ----------
        outputs : array_like of int, shape (..., outputs)
            What ``process`` gives.

        Raises
        ------
        ValueError
            For a wrong last axis or a code outside the signal format.
        """
        codes = self.load_profile.fmt.check(outputs, f"{self.entity} outputs", self.outputs)
        return self.load_profile.process(codes[..., list(self.results)])
