"""Readout: holds a network's outputs, draws a profile from them, and finds the largest."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.flow import Flow, Step, Wire
from golden.common.port import Port, group, output_port
from golden.input_error import InputError
from golden.layers.argmax import Argmax
from golden.networks.network import Around, Network, serial_ports
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.visualisation.load_profile import LoadProfile


@dataclass(frozen=True)
class Readout(Around):
    """The outputs of a network as a stream and in registers, and what is made of them.

    Thesis section 5.5, Figures 5.12 and 5.25. The outputs are those of the network, in the same
    clocks.

    load_profile: None where no profile is drawn.
    results: Indices of the outputs that are load, position, width and shape, where a profile is
        drawn.
    decides: Whether there are the index and the margin of the largest output.
    holds: Whether there are registers for the outputs.
    """

    block = "readout"
    section = "5.5, 5.8"
    area = "instruments"
    network: Network
    load_profile: LoadProfile | None = None
    results: tuple[int, ...] = ()
    decides: bool = False
    holds: bool = True

    def __post_init__(self) -> None:
        count = 0 if self.load_profile is None else 4
        chosen = set(self.results)
        four = f"four different numbers from 0 to {self.outputs - 1}"
        self.require(
            len(chosen) == len(self.results) == count and chosen <= set(range(self.outputs)),
            f"results {self.results}",
            four if count else "none without a load_profile",
        )
        self.require(self.holds or not count, "holds=False with a load_profile", "True")
        _ = self.argmax

    @property
    def argmax(self) -> Argmax | None:
        """The part that finds the largest output, where there is one."""
        return Argmax(SIGNAL, self.outputs) if self.decides else None

    @property
    def result_ports(self) -> tuple[Port, ...]:
        """The ports of the held outputs, of the largest output, and of the profile."""
        held = output_port("held", "output *, until the next of its kind", SIGNAL)
        shown = (
            *(group(held, self.outputs) if self.holds else ()),
            *(self.argmax.result_ports("winner") if self.argmax else ()),
        )
        if self.load_profile is None:
            return shown
        return (
            *shown,
            output_port("profile_valid", "`profile_x` and `profile_y` hold a new point"),
            output_port("profile_x", "i_p, which stays until the next point", SIGNAL),
            output_port("profile_y", "f(i_p), which stays until the next point", SIGNAL),
            output_port("profile_last", "the point is the last of the ramp; high for one clock"),
        )

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *serial_ports("an element", "element of the network's frame", "of the wrong length"),
            *self.result_ports,
            *self.network.load_ports,
            *self.network.lesson_ports,
        )

    @property
    def image(self) -> bytes:
        return self.network.image

    @property
    def output_clocks(self) -> tuple[int, ...]:
        return self.network.output_clocks

    @property
    def busy(self) -> int:
        return self.network.busy

    def parts(self) -> tuple[Block, ...]:
        return (self.network, *(part for part in (self.argmax, self.load_profile) if part))

    def flow(self) -> Flow:
        steps: list[Step] = [Wire("samples", SIGNAL), self.network, Wire("outputs", SIGNAL)]
        if self.load_profile:
            steps += [self.load_profile, Wire("profile", SIGNAL)]
        elif self.argmax:
            steps += [self.argmax, Wire("margin", self.argmax.margin_fmt.width)]
        return Flow(tuple(steps))

    def profile(self, outputs: ArrayLike) -> tuple[Codes, Codes]:
        """Positions and profiles for frames of outputs; see ``LoadProfile.process``.

        outputs, shape (..., outputs): The results of ``process``.
        """
        if self.load_profile is None:
            raise InputError(f"{self.entity}: draws no profile")
        codes = self.load_profile.fmt.check(outputs, f"{self.entity} outputs", self.outputs)
        return self.load_profile.process(codes[..., list(self.results)])
