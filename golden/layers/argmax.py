"""Argmax: the largest output of each frame, and how far the next one is behind it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.border import Border, State
from golden.common.port import CLOCK, CLOCKED, Port, Unsigned, group, input_port, output_port
from golden.input_error import InputError
from golden.numbers.fixed import Codes, Fix


@dataclass(frozen=True)
class Argmax(Block):
    """Index and margin of the winner of each frame: the class that a network decides for (ours).

    The winner is the largest output. Of equal ones it is the first, and its margin is 0.

    fmt: Format of the outputs.
    outputs: The most outputs of a frame, 2 or more.
    """

    block = "argmax"
    area = "layers"
    # Clocks from the last output of a frame to its index and margin.
    latency = 1
    fmt: Fix
    outputs: int

    def __post_init__(self) -> None:
        self.check(outputs=(2, None))

    @property
    def index_fmt(self) -> Unsigned:
        return Unsigned((self.outputs - 1).bit_length(), last=self.outputs - 1)

    @property
    def margin_fmt(self) -> Unsigned:
        """It holds the difference between the two ends of ``fmt``."""
        return Unsigned(self.fmt.width, self.fmt.frac)

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("in_valid", "`in_data` holds an output"),
            input_port("in_data", "output y, one after the other", self.fmt),
            input_port("in_last", "the output is the last of the frame"),
            *self.result_ports("out", by_weights=False),
        )

    def result_ports(self, name: str, by_weights: bool = True) -> tuple[Port, ...]:
        """The ports of its results, whose names begin with ``name``.

        by_weights: Whether its outputs are those of a network, of which some may never be largest.
        """
        return (
            output_port(
                f"{name}_valid",
                f"`{name}_index` and `{name}_margin` are those of a frame; high for one clock",
            ),
            Port(
                f"{name}_index",
                "out",
                "number of the largest output, from 0",
                self.index_fmt,
                by_weights=by_weights,
            ),
            output_port(
                f"{name}_margin",
                "how far the second largest output is below the largest",
                self.margin_fmt,
            ),
        )

    @property
    def states(self) -> tuple[State, ...]:
        return (State("outputs of the frame so far", range(self.outputs)),)

    @property
    def borders(self) -> tuple[Border, ...]:
        leads = Border("leads", "lead over the largest before", 1)
        second = Border("second", "distance from the largest, less the margin", 0)
        # Of two outputs, none is compared with a margin.
        return (leads, second) if self.outputs > 2 else (leads,)

    def quantities(self, *inputs: Codes) -> dict[str, Codes]:
        """The quantities of all outputs but the first, for frames of shape (frames, outputs)."""
        (codes,) = inputs
        largest = np.maximum.accumulate(codes, axis=-1)[..., :-1]
        lead = codes[..., 1:] - largest
        found = {"lead over the largest before": lead.ravel()}
        if self.outputs == 2:
            return found
        margins = [self.process(codes[..., :count])[1] for count in range(2, codes.shape[-1])]
        behind = (lead[..., 1:] <= 0).ravel()
        short = -lead[..., 1:] - np.stack(margins, axis=-1) if margins else lead[..., 1:]
        return found | {"distance from the largest, less the margin": short.ravel()[behind]}

    def process(self, frames: ArrayLike) -> tuple[Codes, Codes]:
        """Index and margin of the winner of each frame.

        frames, shape (..., outputs): A frame may have fewer outputs, but not fewer than 2.

        Returns index, margin, shape (...): The margin is in units of the last place of ``fmt``.
        """
        codes = self.fmt.check(frames, f"{self.entity} frames")
        if codes.ndim == 0 or not 2 <= codes.shape[-1] <= self.outputs:
            raise InputError(
                f"{self.entity} frames: got shape {codes.shape}, expected 2 to {self.outputs} "
                "outputs on the last axis"
            )
        ordered = np.sort(codes, axis=-1)
        return codes.argmax(axis=-1), ordered[..., -1] - ordered[..., -2]


@dataclass(frozen=True)
class ArgmaxTree(Block):
    """Index and margin of the winner of a frame whose outputs come in one clock (ours).

    The numbers are those of ``Argmax``, which takes one output after the other. In each level of
    the tree, pairs of winners meet. A pair keeps the larger one, with its index, and the largest of
    the others: the loser or the second of the winner. The last clock subtracts the two.

    fmt: Format of the outputs.
    outputs: The outputs of a frame, 2 or more.

    Latency: a clock for each level, and one for the margin. A frame every clock.
    """

    block = "argmax_tree"
    part_of = "adder_graph"
    area = "layers"
    fmt: Fix
    outputs: int

    def __post_init__(self) -> None:
        _ = self.serial

    @property
    def serial(self) -> Argmax:
        """The block that gives the same numbers for outputs one after the other."""
        return Argmax(self.fmt, self.outputs, variant=self.variant)

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            CLOCK,
            *group(input_port("in_data", "output y, number *", self.fmt), self.outputs),
            *(port for port in self.serial.result_ports("out") if port.kind),
        )

    @property
    def levels(self) -> int:
        return (self.outputs - 1).bit_length()

    @property
    def latency(self) -> int:
        return self.levels + 1

    def process(self, frames: ArrayLike) -> tuple[Codes, Codes]:
        """Index and margin of the winner of each frame; see ``Argmax.process``."""
        return self.serial.process(frames)
