"""Ends the programs that a command has started, when the command itself is stopped."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

PAUSE = 0.1


@contextmanager
def ending_children() -> Iterator[None]:
    """Surround work in threads that wait for programs.

    A pool waits for its threads even if the command is stopped. So the programs for which these
    wait are ended then, and those that the threads may still begin too.
    """
    try:
        yield
    except (KeyboardInterrupt, SystemExit):
        threading.Thread(target=_end_again_and_again, daemon=True).start()
        raise


def _end_again_and_again() -> None:
    while True:
        for process in descendants(os.getpid()):
            with suppress(ProcessLookupError):
                os.kill(process, signal.SIGTERM)
        time.sleep(PAUSE)


def descendants(process: int) -> list[int]:
    """The processes that a process has started, and that these have started; Linux alone tells."""
    started = defaultdict(list)
    for folder in Path("/proc").glob("[0-9]*"):
        # A process may end before its file is read. Its name, in brackets, may hold blanks.
        with suppress(OSError):
            parent = (folder / "stat").read_text(errors="replace").rpartition(")")[2].split()[1]
            started[int(parent)].append(int(folder.name))
    found = [process]
    for one in found:
        found += started[one]
    return found[1:]
