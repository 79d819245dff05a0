"""Windowed: a network that also reads samples of past frames."""

from dataclasses import dataclass

from golden.common.flow import Flow, Wire
from golden.input_error import InputError
from golden.layers.input_controller import InputController
from golden.networks.network import Around, Network
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.sensing.frame_window import FrameWindow
from golden.trained.window import Window


@dataclass(frozen=True)
class Windowed(Around):
    """y = network(x now, x some frames before): a frame window in front of a network (ours).

    network: A network between two streams.
    window: The samples that the network reads.
    """

    block = "windowed"
    network: Network
    window: Window

    def __post_init__(self) -> None:
        taps = len(self.window.taps)
        self.require(
            self.network.inputs == taps,
            f"a network of {self.network.inputs} inputs",
            f"{taps}, the samples of the window",
        )
        if self.network.stream != "serial" or self.network.image or self.network.past:
            raise InputError(
                f"{self.entity}: got {self.network.entity}, expected a network that takes a stream "
                "of samples, without an image to be loaded and without a past"
            )

    @property
    def frame_window(self) -> FrameWindow:
        slots = self.network.input_controller.inputs - self.network.inputs
        interval = self.network.interval
        spacing = interval if interval > self.inputs else 0
        return FrameWindow(SIGNAL, self.window, slots, spacing)

    @property
    def inputs(self) -> int:
        return len(self.window.delays)

    @property
    def past(self) -> int:
        return self.window.past

    @property
    def interval(self) -> int:
        return self.frame_window.interval

    @property
    def output_clocks(self) -> tuple[int, ...]:
        """They are counted past the frame that the frame window sends."""
        window = self.frame_window
        sent = window.latency + window.elements - 1
        return tuple(sent + clocks for clocks in self.network.output_clocks)

    @property
    def input_controller(self) -> InputController:
        """Judges frames as the frame window does. It is not built."""
        return self.frame_window.input_controller

    def left_out(self) -> list[str]:
        counter = f"{self.frame_window.entity}: the counter that keeps frames apart"
        return super().left_out() + [counter] * (not self.frame_window.spacing)

    def flow(self) -> Flow:
        return Flow(
            (
                Wire(f"{self.inputs} x", SIGNAL),
                self.frame_window,
                Wire(f"{self.network.inputs} x, past and present", SIGNAL),
                self.network,
                Wire(f"{self.outputs} y", SIGNAL),
            )
        )

    def compute(self, frames: Codes) -> Codes:
        return self.network.compute(self.frame_window.process(frames))
