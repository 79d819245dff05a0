"""AXI4-Stream around a network, so that both sides of it can be made to wait."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.common.flow import Flow, Wire
from golden.common.port import CLOCK, RESET, Port, Unsigned, input_port, output_port
from golden.input_error import InputError
from golden.layers.argmax import Argmax
from golden.layers.input_controller import InputController
from golden.networks.network import Around, Network, frame_error
from golden.numbers.fixed import Codes, Fix
from golden.numbers.precision import SIGNAL

# AXI4-Stream carries whole bytes.
BYTES = (SIGNAL.width + 7) // 8
TDATA = Fix(8 * BYTES, SIGNAL.frac)
# TUSER holds the index of the largest output in its lower half, and the margin in its upper half.
TUSER_HALF = 16
TUSER = Unsigned(2 * TUSER_HALF)

# Clocks of a result in the FIFO of the output: one into the memory, and one out of it.
FIFO_CLOCKS = 2


@dataclass(frozen=True)
class AxisNetwork(Around):
    """A network whose frames and outputs are transferred with a handshake.

    A frame consists of its samples alone; the slots that a cascade needs behind them are added
    inside.

    network: A network whose outputs are a stream.
    decides: Whether the last output of a frame carries index and margin of the largest one as
        TUSER.
    """

    block = "axis_network"
    stream = "axi_stream"
    network: Network
    decides: bool = False

    def __post_init__(self) -> None:
        _ = self.argmax

    @property
    def argmax(self) -> Argmax | None:
        return Argmax(SIGNAL, self.outputs) if self.decides else None

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            replace(CLOCK, meaning=f"{CLOCK.meaning}: ACLK"),
            replace(RESET, meaning=f"{RESET.meaning}: ARESETn the other way round"),
            input_port("s_axis_tvalid", "`s_axis_tdata` holds a sample"),
            output_port("s_axis_tready", "a valid sample is accepted in this clock"),
            input_port(
                "s_axis_tdata",
                f"sample x, {SIGNAL}, in the lower {SIGNAL.width} bits; the upper ones are ignored",
                TDATA,
            ),
            input_port("s_axis_tlast", "the sample is the last of the frame"),
            output_port("m_axis_tvalid", "`m_axis_tdata` holds an output until it is accepted"),
            input_port("m_axis_tready", "a valid output is accepted in this clock"),
            output_port("m_axis_tdata", f"output y, {SIGNAL}, sign-extended", TDATA),
            output_port("m_axis_tlast", "the output is the last of the frame"),
            *(
                [
                    output_port(
                        "m_axis_tuser",
                        "with `m_axis_tlast`: number of the largest output, from 0, in bits 0 to "
                        f"{TUSER_HALF - 1}, and by how many codes it exceeds the second largest, "
                        "above",
                        TUSER,
                    )
                ]
                if self.decides
                else []
            ),
            frame_error("of the wrong length"),
        )

    @property
    def storing(self) -> int:
        """Clocks from an output of the network to the same output behind the memory."""
        return FIFO_CLOCKS + (self.argmax.latency if self.argmax else 0)

    @property
    def frames_under_way(self) -> int:
        """How many frames may be between their last sample and the transfer of their last output.

        This many frames keep the network busy while nobody waits. From a frame's last sample until
        the clock in which another frame may take its place there are ``slots``, the clocks to the
        last output and ``storing``.
        """
        clocks = self.slots + self.network.output_clocks[-1] + self.storing
        return -(-clocks // self.interval)

    @property
    def output_clocks(self) -> tuple[int, ...]:
        """The clocks of the outputs when neither side waits."""
        return tuple(self.slots + self.storing + c for c in self.network.output_clocks)

    @property
    def slots(self) -> int:
        """Elements behind the samples in a frame of the network inside."""
        return self.network.input_controller.inputs - self.inputs

    @property
    def spacing(self) -> int:
        """Clocks from frame to frame that must be enforced; 0 where a frame is long enough itself.

        They are counted from a frame's last sample to the next frame's last sample, or to its first
        sample where the network accepts none before.
        """
        if self.network.busy:
            return self.network.busy + 1
        return self.interval if self.interval > self.inputs + self.slots else 0

    @property
    def input_controller(self) -> InputController:
        """Judges frames as they are sent. It is not built, and no frame comes too close."""
        return InputController(self.inputs, 0)

    def left_out(self) -> list[str]:
        counter = f"{self.entity}: the counter that keeps frames apart"
        return super().left_out() + [counter] * (not self.spacing)

    def flow(self) -> Flow:
        return Flow((Wire("s_axis", TDATA), self.network, Wire("m_axis", TDATA)))

    def winners(self, outputs: ArrayLike) -> Codes:
        """``m_axis_tuser`` at the last output of each frame.

        outputs, shape (..., outputs): The results of ``process``.
        """
        if self.argmax is None:
            raise InputError(f"{self.entity}: looks for no largest output")
        index, margin = self.argmax.process(outputs)
        return (margin << TUSER_HALF) + index

    def process_stream(
        self, data: ArrayLike, last: ArrayLike
    ) -> tuple[Codes, NDArray[np.bool_], int]:
        """The transfers that leave, for those that enter after a reset, however long anybody waits.

        data: ``s_axis_tdata`` of each transfer, codes of ``TDATA``; bits above the sample's are
            ignored.
        last: ``s_axis_tlast`` of each transfer.

        Returns data, last: ``m_axis_tdata``, sign-extended, and ``m_axis_tlast`` of each transfer.
        Returns errors: Frames of the wrong length, which cause no transfer.
        """
        words = TDATA.check(data, f"{self.entity} s_axis_tdata")
        codes = ((words - SIGNAL.low) & ((1 << SIGNAL.width) - 1)) + SIGNAL.low
        # The handshake keeps frames apart, so the clocks of the transfers do not matter here.
        scan = self.input_controller.process(last, np.arange(len(words)))
        ends = np.flatnonzero(scan.done)
        frames = codes[ends[:, np.newaxis] + np.arange(1 - self.inputs, 1)]
        results = self.process(frames)
        closes = np.zeros(results.shape, dtype=bool)
        closes[:, -1] = True
        return results.ravel(), closes.ravel(), int(scan.error.sum())
