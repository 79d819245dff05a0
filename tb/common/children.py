"""Ends the programs for which threads wait, when the command is stopped."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

from golden.cli import end_descendants

PAUSE = 0.1


@contextmanager
def ending_children() -> Iterator[None]:
    """Surround work in the threads of a pool, which waits for them even if the command is stopped.

    The programs that run are ended by the signal. A thread that does not know of it may begin
    others, so these are ended too.
    """
    try:
        yield
    except KeyboardInterrupt:
        threading.Thread(target=_end_again_and_again, daemon=True).start()
        raise


def _end_again_and_again() -> None:
    while True:
        end_descendants()
        time.sleep(PAUSE)
