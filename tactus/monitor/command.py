"""``make monitor``: show what a board sends on a page in the browser, and record it."""

import math
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
        clear = CLEAR if sys.stdout.isatty() else ""

        def say(text: str) -> None:
            print(f"{clear}{text}", flush=True)

        monitor, shown = Monitor(board, say, csv), time.monotonic()
        ends = shown + (math.inf if arguments.seconds is None else arguments.seconds)

        def over() -> bool:
            """Whether it is time to end; on a terminal the newest values stand in the last line."""
            nonlocal shown
            now = time.monotonic()
            if clear and now - shown >= PAUSE:
                shown = now
                print(f"{clear}{monitor.line()}", end="", flush=True)
            return now >= ends

        if monitor.lessons and isinstance(line, TwinBoard):
            monitor.lessons.tour = tour_of(board, line)
        title = f"tactus: {board.scene.name} on {line.label}"
        server = stack.enter_context(Server(title, monitor.state, monitor.actions()))
        say(f"{line.label}, {line.baud} baud: look at {server.address}; Ctrl-C ends it")
        try:
            monitor.listen(line, over)
        except KeyboardInterrupt:
            say("")
        tally = monitor.decoder.tally
        say(f"{tally[FRAMES]} packets, {tally['missed']} missed, {tally['failed']} damaged")
        if csv:
            say(f"wrote {csv.path}, {csv.rows} rows")
