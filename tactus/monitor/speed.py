"""``python -m tactus.monitor.speed``: measure how many packets the monitor takes per second.

The packets come from a pseudo-terminal that gives as many as are read; the board of twins behind it
is a process of its own. It is measured without a page, with a page that is read five times a
second, and with a recording as well. Then the packets come from the simulated hardware.
"""

import argparse
import json
import multiprocessing
import sys
import threading
import time
import urllib.request
from contextlib import ExitStack
from multiprocessing.connection import Connection
from pathlib import Path
from tempfile import TemporaryDirectory

from tactus.core.cli import run, stop_if_dry_run
from tactus.core.machine import closing
from tactus.monitor.board import Board, board_of
from tactus.monitor.csv_file import GrowingCsv
from tactus.monitor.line import Line
from tactus.monitor.load import load
from tactus.monitor.monitor import Monitor, csv_columns
from tactus.monitor.ports import SIMULATED, open_line
from tactus.monitor.server import Server
from tactus.monitor.twin_board import TwinBoard

SECONDS = 5.0
PAGE_SECONDS = 0.2


def _board(name: str, pipe: Connection) -> None:
    board = board_of(name)
    with TwinBoard(board.hardware) as simulated:
        if board.instrument.reload:
            simulated.start()
        pipe.send(simulated.port)
        pipe.recv()


def packets_a_second(
    line: Line, board: Board, page: bool = False, recorded: bool = False, seconds: float = SECONDS
) -> float:
    """How many of the packets that come a monitor takes per second."""
    with ExitStack() as stack:
        csv = None
        if recorded:
            folder = Path(stack.enter_context(TemporaryDirectory()))
            csv = stack.enter_context(GrowingCsv(folder / "a.csv", csv_columns(board)))
        monitor = Monitor(board, print, csv)
        ends = threading.Event()
        if page:
            server = stack.enter_context(Server("speed", monitor.state))
            viewer = threading.Thread(target=_look, args=(server.address, ends))
            viewer.start()
            stack.callback(viewer.join)
        began = time.perf_counter()
        monitor.listen(line, lambda: time.perf_counter() - began >= seconds)
        took = time.perf_counter() - began
        ends.set()
        return monitor.decoder.tally.frames / took


def _look(address: str, ends: threading.Event) -> None:
    while not ends.wait(PAGE_SECONDS):
        with urllib.request.urlopen(address + "state") as answer:
            json.load(answer)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", nargs="?", default="digit-board")
    scene = parser.parse_args().scene
    board = board_of(scene)
    stop_if_dry_run(f"measure how many packets of scene {scene} are shown in a second")
    began = time.perf_counter()
    layout, rate = board.layout, board.baud / 10 / board.layout.packet_bytes
    print(f"{layout.packet_bytes} bytes a packet: {rate:.0f} a second at {board.baud} baud")
    ours, theirs = multiprocessing.Pipe()
    process = multiprocessing.Process(target=_board, args=(scene, theirs))
    process.start()
    with Line(ours.recv(), board.baud) as line:
        for text, page, recorded in (
            ("no page", False, False),
            ("a page", True, False),
            ("a page, recorded", True, True),
        ):
            line.drop()
            print(f"{text}: {packets_a_second(line, board, page, recorded):.0f} a second")
    ours.send(None)
    process.join()
    with open_line(SIMULATED, None, board) as line:
        if board.instrument.reload:
            started = time.perf_counter()
            load(line, board)
            print(f"{SIMULATED}: loaded in {time.perf_counter() - started:.0f} s")
        found = packets_a_second(line, board, True, True, 4 * SECONDS)
        print(f"{SIMULATED}: {found:.2g} a second")
    print("\n".join(closing(time.perf_counter() - began)))


if __name__ == "__main__":
    sys.exit(run(main))
