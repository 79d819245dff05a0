"""``make monitor``: show what a board sends on a page in the browser, and record it."""

import sys
import time
from contextlib import ExitStack

from golden.input_error import InputError
from golden.link.decoder import FRAMES
from tactus.core.cli import numbers, stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.progress import CLEAR
from tactus.monitor.board import board_of
from tactus.monitor.csv_file import GrowingCsv
from tactus.monitor.lessons import tour_of
from tactus.monitor.line import open_line
from tactus.monitor.load import load
from tactus.monitor.monitor import Monitor, csv_columns
from tactus.monitor.server import Server
from tactus.monitor.twin_board import TWIN, TwinBoard
from tactus.scene.disturbance import MOST, Disturbance

# On a terminal a line with the newest values is shown each so many seconds.
PAUSE = 1.0


class Terminal:
    """Prints lines that stay and, on a terminal, one line below them that is rewritten.

    seconds: After how many seconds to end; None for never.
    """

    def __init__(self, seconds: float | None) -> None:
        self.seconds = seconds
        self.monitor: Monitor | None = None
        self._terminal = sys.stdout.isatty()
        self._began = self._shown = time.monotonic()

    def say(self, text: str) -> None:
        print(f"{CLEAR if self._terminal else ''}{text}", flush=True)

    def over(self) -> bool:
        """Whether it is time to end; it also rewrites the line with the newest values."""
        now = time.monotonic()
        if self._terminal and self.monitor and now - self._shown >= PAUSE:
            self._shown = now
            print(f"{CLEAR}{self.monitor.line()}", end="", flush=True)
        return self.seconds is not None and now - self._began >= self.seconds


def main() -> None:
    arguments = arguments_of("monitor", __doc__, seconds=float)
    drift = None
    if found := numbers("DRIFT", arguments.drift, 2, MOST):
        drift = Disturbance(gain=found[0], offset=found[1])
        if arguments.port != TWIN:
            raise InputError(
                f"DRIFT=: got PORT={arguments.port}, expected {TWIN}: only the sensors of a "
                "simulated board drift when they are told to"
            )
    board = board_of(arguments.scene, arguments.hardware)
    stop_if_dry_run(f"show what the board of scene {board.scene.name} sends on {arguments.port}")
    with ExitStack() as stack:
        line = open_line(arguments.port, arguments.baud, board, drift, arguments.seed)
        stack.enter_context(line)
        csv = None
        if arguments.to:
            csv = stack.enter_context(GrowingCsv(arguments.to, csv_columns(board)))
        if isinstance(line, TwinBoard) and board.instrument.reload:
            print("the simulated board is being loaded", flush=True)
            load(line, board)
        terminal = Terminal(arguments.seconds)
        monitor = terminal.monitor = Monitor(board, terminal.say, csv)
        if monitor.lessons and isinstance(line, TwinBoard):
            monitor.lessons.tour = tour_of(board, line)
        title = f"tactus: {board.scene.name} on {line.label}"
        server = stack.enter_context(Server(title, monitor.state, monitor.actions()))
        terminal.say(f"{line.label}, {line.baud} baud: look at {server.address}; Ctrl-C ends it")
        try:
            monitor.listen(line, terminal.over)
        except KeyboardInterrupt:
            terminal.say("")
        tally = monitor.decoder.tally
        told = f"{tally[FRAMES]} packets, {tally['missed']} missed, {tally['failed']} damaged"
        terminal.say(told)
        if csv:
            terminal.say(f"wrote {csv.path}, {csv.rows} rows")
