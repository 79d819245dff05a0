"""Opens the port that a user names: a serial port, or that of a simulated board."""

from collections.abc import Iterator
from contextlib import contextmanager

from golden.input_error import InputError
from tactus.monitor.board import Board, Drift
from tactus.monitor.line import Line, ports_there
from tactus.monitor.simulated_board import SimulatedBoard
from tactus.monitor.twin_board import TwinBoard

# ``sim`` is the hardware in a simulator. ``twin`` is its bit-true models, which send the same
# packets at the speed of the board.
SIMULATED, TWIN = "sim", "twin"
# The models play each row for so many seconds.
TWIN_HOLD = 0.5
# The simulated hardware plays each row of the recording for so many scans, so that all points of a
# profile are seen.
HOLD = 64
# See ``Line``, in seconds. In the simulator everything takes as many clocks as on the board, but
# each clock takes longer.
SILENCE, PATIENCE = 60.0, 600.0


@contextmanager
def open_line(
    port: str, baud: int | None, board: Board, drift: Drift | None = None
) -> Iterator[Line]:
    """The line to a board, with the baud rate of its scene if no other is given.

    drift: How far the sensors of a simulated board have drifted.
    """
    if not port:
        raise InputError(
            f"PORT=: missing, expected sim, twin or a serial port; there is {ports_there()}"
        )
    baud = baud or board.baud
    if port == SIMULATED:
        with (
            SimulatedBoard(board.hardware, HOLD, drift) as simulated,
            Line(simulated.port, baud, SIMULATED) as line,
        ):
            line.simulated = simulated
            line.silence, line.patience = SILENCE, PATIENCE
            yield line
    elif port == TWIN:
        rate = float(board.instrument.packets_a_second)
        with (
            TwinBoard(board.hardware, rate, round(TWIN_HOLD * rate), drift) as twins,
            Line(twins.port, baud, TWIN) as line,
        ):
            line.simulated = twins
            yield line
    else:
        with Line(port, baud) as line:
            yield line


def refuse_drift(port: str) -> None:
    """Refuse a drift of sensors that are not simulated."""
    if port not in (SIMULATED, TWIN):
        raise InputError(
            f"DRIFT=: got PORT={port}, expected {TWIN} or {SIMULATED}: only the sensors of a "
            "simulated board drift when they are told to"
        )
