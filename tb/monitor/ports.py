"""The port that a user names: a serial one, or that of a simulated board."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from tb.monitor.board import Board
from tb.monitor.line import Line, ports_there
from tb.monitor.twin_board import TwinBoard

SIMULATED = "sim"


@contextmanager
def open_line(port: str, baud: int, board: Board) -> Iterator[Line]:
    """The line to a board.

    Raises
    ------
    ValueError
        Without a port.
    CommandError
        See ``Line``.
    """
    if not port:
        raise ValueError(f"PORT=: missing, expected sim or a serial port; there is {ports_there()}")
    if port == SIMULATED:
        with (
            TwinBoard(board.hardware, 100.0, 40) as simulated,
            Line(simulated.port, baud, SIMULATED) as line,
        ):
            line.simulated = simulated
            yield line
    else:
        with Line(port, baud) as line:
            yield line
