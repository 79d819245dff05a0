"""What a long step says while it runs: what, how many of how many, and about how long still."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from types import TracebackType
from typing import TextIO

# Least seconds between two lines where the output is no terminal.
PAUSE = 5.0
TERMINAL_PAUSE = 0.1
# Back to the beginning of the line, and nothing on it.
CLEAR = "\r\x1b[K"


def duration(seconds: float) -> str:
    """Seconds as somebody who waits reads them."""
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


class Progress:
    """Counts parts as they end.

    On a terminal one line is written over and over; elsewhere a line comes every few seconds, and
    one at the end.

    Parameters
    ----------
    what : str
        What runs: ``digit: simulating``.
    total : int
    parts : str
        What is counted: ``benches``.
    stream : file, optional
        Standard output by default.
    clock : callable
        Seconds from some beginning.
    """

    def __init__(
        self,
        what: str,
        total: int,
        parts: str,
        stream: TextIO | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.what, self.total, self.parts = what, total, parts
        self.stream = stream or sys.stdout
        self.clock = clock
        self.terminal = self.stream.isatty()
        self.done = 0
        self.began = self.told = clock()

    def __enter__(self) -> Progress:
        self._show("")
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self.terminal:
            print(file=self.stream)

    def step(self, note: str = "") -> None:
        """One more part has ended; ``note`` is what is known by now."""
        self.done += 1
        pause = TERMINAL_PAUSE if self.terminal else PAUSE
        if self.done == self.total or self.clock() - self.told >= pause:
            self._show(note)

    def say(self, line: str) -> None:
        """A line of its own that stays."""
        print(f"{CLEAR if self.terminal else ''}{line}", file=self.stream, flush=True)

    def _show(self, note: str) -> None:
        self.told = self.clock()
        line = f"{self.what}: {self.done} of {self.total} {self.parts}"
        spent = self.told - self.began
        if self.done == self.total:
            line += f" in {duration(spent)}"
        elif self.done:
            line += f", about {duration(spent / self.done * (self.total - self.done))} left"
        line += f", {note}" if note else ""
        if self.terminal:
            print(f"{CLEAR}{line}", end="", file=self.stream, flush=True)
        else:
            print(line, file=self.stream, flush=True)
