"""packet_sender: what an instrument shows becomes packets, byte after byte."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.block import Block
from golden.border import State
from golden.fixed import Codes
from golden.input_error import InputError
from golden.link.packets import COUNT_BYTES, FLAGS, Frame, FrameLayout
from golden.port import CLOCKED, Port, Unsigned, given, taken
from golden.precision import SIGNAL

# A point's number has a byte.
MOST_POINTS = 256
# A counter reaches no more, see docs/new-block.md.
MOST_PATIENCE = 1 << 30


@dataclass(frozen=True)
class Sending:
    """What stands on the outputs in each clock, and what is sent.

    Attributes
    ----------
    out_valid : bool array
    out_data : int64 array
        The byte in a clock of ``out_valid``, 0 in others.
    begins : list of int
        The clocks in which packets begin.
    frames : list of Frame
        What these say.
    """

    out_valid: NDArray[np.bool_]
    out_data: Codes
    begins: list[int]
    frames: list[Frame]


@dataclass(frozen=True)
class PacketSender(Block):
    """Frames of an instrument as packets (ours; see ``golden.link.packets``).

    A frame is whole with its last output. If the line is free then, a packet says what there is; if
    not, the frame is counted and not sent. A packet goes as well when the line has been free for
    ``patience`` clocks, with the newest samples and the outputs that are held: while the converter
    is missing, or an image.

    Parameters
    ----------
    inputs, outputs : int
        Codes of a packet. Elements of a frame beyond them are not sent.
    points : int
        Of the profile; 0 where none is drawn. Each packet carries the next of them.
    reload : bool
        Whether frames can be refused, and images and bytes of the line be wrong.
    patience : int

    Raises
    ------
    InputError
        For a number outside its range, and for a payload that is too long.
    """

    block = "packet_sender"
    area = "link"
    inputs: int
    outputs: int
    points: int
    reload: bool
    patience: int

    def __post_init__(self) -> None:
        for name, least, most in (
            ("inputs", 1, MOST_POINTS),
            ("outputs", 1, MOST_POINTS),
            ("points", 0, MOST_POINTS),
            ("patience", 2, MOST_PATIENCE),
        ):
            got = getattr(self, name)
            if not least <= got <= most:
                raise InputError(f"{self.entity}: got {name}={got}, expected {least} to {most}")
        _ = self.layout

    @property
    def layout(self) -> FrameLayout:
        return FrameLayout(self.inputs, self.outputs, bool(self.points))

    @property
    def ports(self) -> tuple[Port, ...]:
        told = (
            taken("frame_error", "a frame is refused in this clock"),
            taken("image_error", "the last image was not valid"),
            taken("line_error", "a byte without a stop bit came; high for one clock"),
        )
        drawn = (
            taken("profile_valid", "`profile_x` and `profile_y` hold a new point"),
            taken("profile_x", "i_p", SIGNAL),
            taken("profile_y", "f(i_p)", SIGNAL),
            taken("profile_last", "the point is the last of the ramp"),
        )
        return (
            *CLOCKED,
            taken("sample_valid", "`sample_data` holds an element of the network's frame"),
            taken("sample_data", "the samples, and in a cascade slots", SIGNAL),
            taken("sample_last", "the element is the last of the frame"),
            taken("result_valid", "`result_data` holds an output"),
            taken("result_data", "output y", SIGNAL),
            taken("result_last", "the output is the last of the frame"),
            taken("converter_error", "no frame leaves the reader"),
            *(told if self.reload else ()),
            *(drawn if self.points else ()),
            taken("out_ready", "a byte is taken in this clock"),
            given("out_valid", "`out_data` holds a byte, until it is taken"),
            given("out_data", "the byte", Unsigned(8)),
        )

    @property
    def states(self) -> tuple[State, ...]:
        size = self.layout.packet_bytes
        return (
            State("byte of a packet that a reset cuts", range(size)),
            *([State("point", range(self.points))] if self.points else []),
        )

    @property
    def latency(self) -> int:
        """From the last output of a frame to the first byte."""
        return 2

    @property
    def interval(self) -> int:
        """From one packet's begin to the next, where each byte is taken at once."""
        return self.layout.packet_bytes + 1

    def process(
        self, columns: Mapping[str, ArrayLike], reset: ArrayLike, byte_clocks: int = 0
    ) -> Sending:
        """What happens in each clock.

        Parameters
        ----------
        columns : mapping
            By the name of each input but clock and reset, one element a clock. Data matter in
            clocks of their ``valid`` alone.
        reset : array_like
        byte_clocks : int
            Of a transmitter that takes the bytes, instead of a column ``out_ready``.
        """
        names = [p.name for p in self.ports if p.direction == "in" and p not in CLOCKED]
        if byte_clocks:
            names.remove("out_ready")
        given_ = [np.asarray(columns[name]).tolist() for name in names]
        clears = np.asarray(reset).tolist()
        count = len(clears)
        valid, data = np.zeros(count, dtype=bool), np.zeros(count, dtype=np.int64)
        begins: list[int] = []
        frames: list[Frame] = []
        # With a transmitter, the first clock in which it takes a byte.
        state, free = _State(self), 0
        for t in range(count):
            now = dict(zip(names, (column[t] for column in given_), strict=True))
            if byte_clocks:
                now["out_ready"] = int(t >= free)
            if state.packet:
                valid[t], data[t] = True, state.packet[0]
                free = t + byte_clocks if now["out_ready"] else free
            frame = state.step(now)
            if clears[t]:
                state, free = _State(self), t + 1
            elif frame is not None:
                begins.append(t)
                frames.append(frame)
        return Sending(valid, data, begins, frames)


class _State:
    """What the block holds from clock to clock."""

    def __init__(self, twin: PacketSender) -> None:
        self.twin = twin
        self.samples = [0] * twin.inputs
        self.outputs = [0] * twin.outputs
        self.at = {"sample": 0, "result": 0, "profile": 0}
        self.point, self.wanted = (0, 0, 0), 0
        # Flags since the packet before, and a frame refused since the frame before.
        self.since = dict.fromkeys(FLAGS[1:], False)
        self.refused = False
        self.number = self.count = self.waited = 0
        self.complete = False
        self.packet = b""

    def step(self, now: dict[str, int]) -> Frame | None:
        """One clock; gives the frame of a packet that begins in it."""
        for name in self.since:
            self.since[name] |= bool(now.get(name))
        ready, wanted = bool(now["out_ready"]), self.wanted
        free = ready and not self.packet
        begins = free and (self.complete or self.waited == self.twin.patience - 1)
        self.waited = self.waited + 1 if free and not begins else 0
        frame = self._frame(now) if begins else None
        if frame is not None:
            self.packet = self.twin.layout.to_bytes(frame)
            self.number = (self.number + 1) % 256
            self.since = dict.fromkeys(self.since, False)
            self.wanted = (self.point[0] + 1) % max(1, self.twin.points)
        elif ready:
            self.packet = self.packet[1:]
        self.refused = not self.complete and (self.refused or bool(now.get("frame_error")))
        self._catch(now, "sample", self.samples)
        self.complete = self._catch(now, "result", self.outputs)
        self.count = (self.count + self.complete) % (1 << 8 * COUNT_BYTES)
        if now.get("profile_valid"):
            number = self.at["profile"]
            if number == wanted:
                self.point = (number, now["profile_x"], now["profile_y"])
            self.at["profile"] = 0 if now["profile_last"] else number + 1
        return frame

    def _frame(self, now: dict[str, int]) -> Frame:
        told = self.since | {"frame_error": self.since["frame_error"] or self.refused}
        flags = {"converter_error": bool(now["converter_error"])} | told
        return Frame(
            self.number,
            tuple(name for name in FLAGS if flags[name]),
            self.count,
            tuple(self.samples),
            tuple(self.outputs),
            self.point if self.twin.points else None,
        )

    def _catch(self, now: dict[str, int], name: str, words: list[int]) -> bool:
        """Keep an element of a stream; says whether it is the last of a frame."""
        if not now[f"{name}_valid"]:
            return False
        place, last = self.at[name], bool(now[f"{name}_last"])
        if place < len(words):
            words[place] = now[f"{name}_data"]
        self.at[name] = 0 if last else place + 1
        return last
