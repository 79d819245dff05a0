"""Opens what a user names with ``PORT=``: a serial port, or a board of twins."""

import time
from collections.abc import Iterator

from golden.input_error import InputError
from golden.link.decoder import Decoder, fault
from golden.link.packets import Frame
from tactus.monitor.board import Board
from tactus.monitor.line import SerialLine, ports_there
from tactus.monitor.twin_board import TWIN, TwinBoard
from tactus.scene.disturbance import Disturbance

# A board of twins plays each row for so many seconds.
TWIN_HOLD = 0.5

Line = SerialLine | TwinBoard


def open_line(
    port: str, baud: int | None, board: Board, drift: Disturbance | None = None, seed: int = 1
) -> Line:
    """The line to a board, with the baud rate of its scene if no other is given.

    drift, seed: How far the sensors of a simulated board have drifted; see ``TwinBoard``.
    """
    if not port:
        raise InputError(
            f"PORT=: missing, expected {TWIN} or a serial port; there is {ports_there()}"
        )
    if port == TWIN:
        rate = float(board.instrument.packets_a_second)
        hold = max(1, round(TWIN_HOLD * rate))
        return TwinBoard(board.hardware, rate, hold, drift, seed)
    return SerialLine(port, baud or board.baud)


def frames_from(line: Line, board: Board) -> Iterator[Frame]:
    """The frames that come from now on, as long as some come."""
    line.drop()
    decoder = Decoder(board.layout)
    last = time.monotonic()
    while time.monotonic() - last < line.patience:
        for frame in decoder.feed(line.read()):
            last = time.monotonic()
            yield frame
        if line.cut:
            raise InputError(f"PORT={line.label}: the line was cut: {line.cut}")
    faults = "; ".join(filter(None, (fault(*one) for one in decoder.tally.items())))
    raise InputError(
        f"PORT={line.label}: no packet for {line.patience:g} s: "
        + (faults or "is the bitstream loaded, and are TX and RX crossed?")
    )
