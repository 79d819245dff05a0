"""``make monitor``: what a board sends, on a page in the browser, and recorded."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

from golden.cli import run, whole
from tb.monitor.board import MOST_BAUD, board_of
from tb.monitor.csv_file import GrowingCsv
from tb.monitor.load import load
from tb.monitor.monitor import HEAD, Monitor
from tb.monitor.ports import open_line
from tb.monitor.server import Server


def main() -> None:
    parser = argparse.ArgumentParser(prog="make monitor", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("port", help="a serial port, or sim")
    parser.add_argument("--hardware", default="", help="scene whose hardware the board has")
    parser.add_argument("--to", type=Path, help="CSV that takes every frame")
    parser.add_argument("--baud", type=whole("BAUD", 300, MOST_BAUD))
    parser.add_argument("--page", type=whole("PAGE", 0, 65535), default=0)
    parser.add_argument("--seconds", type=float, help="end after so long")
    arguments = parser.parse_args()
    board = board_of(arguments.scene, arguments.hardware)
    with ExitStack() as stack:
        line = stack.enter_context(open_line(arguments.port, arguments.baud, board))
        if line.simulated and board.instrument.reload:
            print("the simulated board is loaded", flush=True)
            load(line, board)
        csv = None
        if arguments.to:
            csv = stack.enter_context(GrowingCsv(arguments.to, [*HEAD, *board.columns]))
        monitor = Monitor(board, lambda text: print(text, flush=True), csv)
        title = f"tactus: {board.scene.name} on {arguments.port}"
        server = stack.enter_context(Server(title, monitor.state, arguments.page))
        print(
            f"{line.label}, {line.baud} baud: look at {server.address}; Ctrl-C ends it", flush=True
        )
        try:
            monitor.listen(line, _until(arguments.seconds))
        except KeyboardInterrupt:
            print()
        tally = monitor.decoder.tally
        print(f"{tally.frames} packets, {tally.missed} missed, {tally.failed} damaged")
        if csv:
            print(f"wrote {csv.path}, {csv.rows} rows")


def _until(seconds: float | None) -> Callable[[], bool]:
    began = time.monotonic()
    return lambda: seconds is not None and time.monotonic() - began >= seconds


if __name__ == "__main__":
    sys.exit(run(main))
