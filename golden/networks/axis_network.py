"""AXI4-Stream around a network: a network that can be made to wait."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.block import Block
from golden.fixed import Codes, Fix
from golden.flow import Carried, Flow
from golden.layers.input_controller import InputController
from golden.networks.network import Network
from golden.precision import SIGNAL

# AXI4-Stream carries whole bytes.
BYTES = (SIGNAL.width + 7) // 8
TDATA = Fix(8 * BYTES, SIGNAL.frac)


@dataclass(frozen=True)
class AxisNetwork(Network):
    """The outputs of a network, its frames taken and given with a handshake.

    As a network it is the one inside: same frames of samples, same outputs. A frame is its samples
    alone; the slots that a cascade needs behind them are made inside.

    Parameters
    ----------
    network : Network
        One whose outputs are a stream.
    """

    block = "axis_network"
    stream = "axi_stream"
    network: Network

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
    def slots(self) -> int:
        """Elements of a frame of the network behind the samples."""
        return self.network.input_controller.inputs - self.inputs

    @property
    def spacing(self) -> int:
        """Clocks from frame to frame that a frame does not take by its own length, or 0."""
        return self.interval if self.interval > self.inputs + self.slots else 0

    @property
    def input_controller(self) -> InputController:
        """Judges frames as they are sent; it is no part, and no frame comes too close."""
        return InputController(self.inputs, 0)

    @property
    def core(self) -> Network:
        return self.network.core

    def parts(self) -> tuple[Block, ...]:
        return (self.network,)

    def flow(self) -> Flow:
        return Flow((Carried("s_axis", TDATA), self.network, Carried("m_axis", TDATA)))

    def left_out(self) -> list[str]:
        texts = self.network.left_out()
        if not self.spacing:
            texts.append(f"{self.entity}: the counter that keeps frames apart")
        return texts

    def compute(self, frames: Codes) -> Codes:
        return self.network.compute(frames)

    def process_stream(
        self, data: ArrayLike, last: ArrayLike
    ) -> tuple[Codes, NDArray[np.bool_], int]:
        """What leaves, for transfers that enter after a reset, however long anybody waits.

        Parameters
        ----------
        data : array_like of int
            ``s_axis_tdata`` of each transfer, codes of ``TDATA``; bits above the sample's are
            ignored.
        last : array_like of bool
            ``s_axis_tlast`` of each transfer.

        Returns
        -------
        data, last : int array, bool array
            ``m_axis_tdata``, sign-extended, and ``m_axis_tlast`` of each transfer.
        errors : int
            Frames of the wrong length, which give no transfer.

        Raises
        ------
        ValueError
            For data that no ``TDATA`` holds.
        """
        words = TDATA.check(data, f"{self.entity} s_axis_tdata")
        codes = ((words - SIGNAL.low) & ((1 << SIGNAL.width) - 1)) + SIGNAL.low
        # Frames cannot come too close, so their clocks do not matter.
        scan = self.input_controller.process(last, np.arange(len(words)))
        ends = np.flatnonzero(scan.done)
        frames = codes[ends[:, np.newaxis] + np.arange(1 - self.inputs, 1)]
        results = self.process(frames)
        closes = np.zeros(results.shape, dtype=bool)
        closes[:, -1] = True
        return results.ravel(), closes.ravel(), int(scan.error.sum())
