"""packet_sender: sends an instrument's samples and outputs as packets, byte by byte."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCKED, Port, Unsigned, input_port, output_port
from golden.layers.argmax import Argmax
from golden.link.packets import COUNT_BYTES, FLAGS, STATES, Frame, FrameLayout
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL

# The number of a point has one byte.
MOST_POINTS = 256
# A counter cannot go higher; see docs/new-block.md.
MOST_PATIENCE = 1 << 30


@dataclass(frozen=True)
class PacketSender(Block):
    """Sends the frames of an instrument as packets (ours; see ``golden.link.packets``).

    A frame is complete with its last output or, where the largest output is told, with that. If the
    line is free then, a packet with the frame is sent; otherwise the frame is only counted. A
    packet is also sent when the line has been free for ``patience`` clocks, as while the converter
    or an image is missing.

    inputs, outputs: Number of codes in a packet. Elements of a frame beyond them are not sent.
    points: Number of points of the profile; 0 where none is drawn. Each packet carries the next
        point.
    reload: Whether frames can be refused, and whether images and bytes of the line can be wrong.
    patience: Clocks without a packet after which one is sent.
    decides: Whether a packet carries index and margin of the largest output.
    elements: Number of elements of the theta that the network learns, so that lessons, steps and
        bytes of the line can be wrong; 0 where it learns nothing. Each packet carries the next
        element.
    """

    block = "packet_sender"
    part_of = "uart_instrument"
    area = "link"
    # Clocks from what completes a frame, its last output or its winner, to the first byte.
    latency = 2
    inputs: int
    outputs: int
    points: int
    reload: bool
    patience: int
    decides: bool = False
    elements: int = 0

    def __post_init__(self) -> None:
        self.check(inputs=(1, MOST_POINTS), outputs=(1, MOST_POINTS), points=(0, MOST_POINTS))
        self.check(patience=(2, MOST_PATIENCE), elements=(0, MOST_POINTS))
        self.require(not (self.reload and self.learns), "reload and learns", "one of them")
        _ = self.layout, self.argmax

    @property
    def learns(self) -> bool:
        return bool(self.elements)

    @property
    def layout(self) -> FrameLayout:
        drawn = bool(self.points)
        return FrameLayout(self.inputs, self.outputs, drawn, self.decides, self.learns)

    @property
    def argmax(self) -> Argmax | None:
        """What finds the largest output in front of this block, where a packet carries it."""
        return Argmax(SIGNAL, self.outputs) if self.decides else None

    @property
    def ports(self) -> tuple[Port, ...]:
        line = input_port("line_error", "a byte without a stop bit came; high for one clock")
        errors = (
            input_port("frame_error", "a frame is refused in this clock"),
            input_port("image_error", "the last image was not valid"),
            line,
        )
        lessons = (
            line,
            input_port("lesson_error", "a lesson, or its known outputs, were refused"),
            input_port("learn_error", "a step of learning was refused"),
            input_port("learning", "the network learns"),
            input_port("theta_valid", "`theta_data` holds an element of theta"),
            input_port("theta_data", "the element, in their order behind a frame", SIGNAL),
        )
        winner = self.argmax.result_ports("winner") if self.argmax else ()
        drawn = (
            input_port("profile_valid", "`profile_x` and `profile_y` hold a new point"),
            input_port("profile_x", "i_p", SIGNAL),
            input_port("profile_y", "f(i_p)", SIGNAL),
            input_port("profile_last", "the point is the last of the ramp"),
        )
        return (
            *CLOCKED,
            input_port("sample_valid", "`sample_data` holds an element of the network's frame"),
            input_port("sample_data", "the samples, and in a cascade slots", SIGNAL),
            input_port("sample_last", "the element is the last of the frame"),
            input_port("result_valid", "`result_data` holds an output"),
            input_port("result_data", "output y", SIGNAL),
            input_port("result_last", "the output is the last of the frame"),
            *(replace(port, direction="in") for port in winner),
            input_port("converter_error", "no frame leaves the reader"),
            *(errors if self.reload else ()),
            *(lessons if self.learns else ()),
            *(drawn if self.points else ()),
            input_port("out_ready", "a byte is taken in this clock"),
            output_port("out_valid", "`out_data` holds a byte, until it is taken"),
            output_port("out_data", "the byte", Unsigned(8)),
        )

    @property
    def interval(self) -> int:
        """Clocks from the beginning of a packet to the next, if each byte is accepted at once."""
        return self.layout.packet_bytes + 1

    def process(
        self, columns: Mapping[str, ArrayLike], reset: ArrayLike, byte_clocks: int = 0
    ) -> tuple[Codes, Codes, list[Frame]]:
        """``out_valid`` and ``out_data`` in each clock, and the contents of the packets.

        columns: For the name of each input except clock and reset, one element per clock. Data are
            used only in clocks in which their ``valid`` is high.
        byte_clocks: Clocks per byte of a transmitter that accepts the bytes; it replaces the column
            ``out_ready``.
        """
        names = [p.name for p in self.ports if p.direction == "in" and p not in CLOCKED]
        if byte_clocks:
            names.remove("out_ready")
        inputs = [np.asarray(columns[name]).tolist() for name in names]
        clears = np.asarray(reset).tolist()
        count = len(clears)
        valid, data = np.zeros((2, count), dtype=np.int64)
        frames: list[Frame] = []
        # With a transmitter: the first clock in which it accepts the next byte.
        state, free = _State(self), 0
        for t in range(count):
            now = dict(zip(names, (column[t] for column in inputs), strict=True))
            if byte_clocks:
                now["out_ready"] = int(t >= free)
            if state.packet:
                valid[t], data[t] = True, state.packet[0]
                free = t + byte_clocks if now["out_ready"] else free
            frame = state.step(now)
            if clears[t]:
                state, free = _State(self), t + 1
            elif frame is not None:
                frames.append(frame)
        return valid, data, frames


class InTurn:
    """Of items that come over and over, one is shown, as it came last; then the next one is."""

    def __init__(self, count: int, codes: int) -> None:
        self.count = max(1, count)
        # The number and the codes of the item that is shown.
        self.item = (0,) * (1 + codes)
        self.place = self.wanted = 0

    def step(self, shown: bool, comes: object, codes: tuple[int, ...], restarts: object) -> None:
        """Advance by one clock, in which the item was shown, one comes, or the next is number 0."""
        wanted = self.wanted
        if shown:
            self.wanted = (self.item[0] + 1) % self.count
        if comes and self.place == wanted:
            self.item = (self.place, *codes)
        self.place = 0 if restarts else self.place + bool(comes)


class _State:
    """The state that the block holds from clock to clock."""

    def __init__(self, twin: PacketSender) -> None:
        self.twin = twin
        self.samples = [0] * twin.inputs
        self.outputs = [0] * twin.outputs
        self.at = {"sample": 0, "result": 0}
        self.winner = (0, 0)
        self.point, self.theta = InTurn(twin.points, codes=2), InTurn(twin.elements, codes=1)
        # The flags that were set since the packet before, and whether a frame was refused since the
        # frame before.
        self.since = {name: False for name in FLAGS if name not in STATES}
        self.refused = False
        self.number = self.count = self.waited = 0
        self.complete = False
        self.packet = b""

    def step(self, now: dict[str, int]) -> Frame | None:
        """Advance by one clock; returns the frame of a packet that begins in it, or None."""
        for name in self.since:
            self.since[name] |= bool(now.get(name))
        ready = bool(now["out_ready"])
        free = ready and not self.packet
        begins = free and (self.complete or self.waited == self.twin.patience - 1)
        self.waited = self.waited + 1 if free and not begins else 0
        frame = self._frame(now) if begins else None
        if frame is not None:
            self.packet = self.twin.layout.to_bytes(frame)
            self.number = (self.number + 1) % 256
            self.since = dict.fromkeys(self.since, False)
        elif ready:
            self.packet = self.packet[1:]
        self.refused = not self.complete and (self.refused or bool(now.get("frame_error")))
        self._catch(now, "sample", self.samples)
        self.complete = self._catch(now, "result", self.outputs)
        if self.twin.decides:
            self.complete = bool(now["winner_valid"])
            if self.complete:
                self.winner = (now["winner_index"], now["winner_margin"])
        self.count = (self.count + self.complete) % (1 << 8 * COUNT_BYTES)
        if self.twin.points:
            comes, codes = now["profile_valid"], (now["profile_x"], now["profile_y"])
            self.point.step(begins, comes, codes, comes and now["profile_last"])
        if self.twin.learns:
            # The elements come behind a frame.
            ends = now["result_valid"] and now["result_last"]
            self.theta.step(begins, now["theta_valid"], (now["theta_data"],), ends)
        return frame

    def _frame(self, now: dict[str, int]) -> Frame:
        reported = self.since | {"frame_error": self.since["frame_error"] or self.refused}
        flags = {name: bool(now.get(name)) for name in STATES} | reported
        return Frame(
            self.number,
            tuple(name for name in FLAGS if flags[name]),
            self.count,
            tuple(self.samples),
            tuple(self.outputs),
            self.point.item if self.twin.points else None,
            self.winner if self.twin.decides else None,
            self.theta.item if self.twin.learns else None,
        )

    def _catch(self, now: dict[str, int], name: str, words: list[int]) -> bool:
        """Store an element of a stream; returns whether it is the last of a frame."""
        if not now[f"{name}_valid"]:
            return False
        place, last = self.at[name], bool(now[f"{name}_last"])
        if place < len(words):
            words[place] = now[f"{name}_data"]
        self.at[name] = 0 if last else place + 1
        return last
