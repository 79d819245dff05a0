"""What a long step says while it runs: what, how many of how many, and about how long still.

Not by a library such as rich: it would draw the one line on a terminal, some ten lines of this
module. Where the output is a pipe or a log it is silent until the end, and there the lines that
come every few seconds, with what runs and for how long still, are what this module is for.
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import TextIO

# Least seconds between two lines where the output is no terminal; nobody waits longer for one.
PAUSE = 4.0
TERMINAL_PAUSE = 0.1
# How often it is looked whether a line is due.
BEAT = 0.5
# No estimate before this part is done: the first parts are seldom like the others.
ESTIMATED = 0.05
# Names of what runs that one line shows.
MOST_NAMES = 3
# Back to the beginning of the line, and nothing on it.
CLEAR = "\r\x1b[K"


def duration(seconds: float) -> str:
    """Seconds as somebody who waits reads them."""
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


class Heartbeat:
    """Calls something again and again while a block runs, in a thread of its own.

    Parameters
    ----------
    call : callable
    """

    def __init__(self, call: Callable[[], None]) -> None:
        self._call = call
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._beat, name="progress", daemon=True)

    def __enter__(self) -> Heartbeat:
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._ended.set()
        self._thread.join()

    def _beat(self) -> None:
        while not self._ended.wait(BEAT):
            self._call()


@contextmanager
def stage(what: str, stream: TextIO | None = None) -> Iterator[None]:
    """Say what the block does, and every few seconds that it still does.

    Parameters
    ----------
    what : str
        ``digit: exporting``.
    stream : file, optional
        Standard output by default.
    """
    out = stream or sys.stdout
    began = told = time.monotonic()

    def beat() -> None:
        nonlocal told
        now = time.monotonic()
        if now - told >= PAUSE:
            told = now
            print(f"{what}, {duration(now - began)}", file=out, flush=True)

    print(what, file=out, flush=True)
    with Heartbeat(beat):
        yield


class Progress:
    """Counts parts as they end.

    On a terminal one line is written over and over; elsewhere a line comes every few seconds, and
    one at the end. Where no part ends for so long, the line says what runs.

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
    alike : bool
        Whether one part takes about as long as another, so that those that are done tell how long
        the others take. Otherwise nothing is estimated, and each part is named when it begins.
    """

    def __init__(
        self,
        what: str,
        total: int,
        parts: str,
        stream: TextIO | None = None,
        clock: Callable[[], float] = time.monotonic,
        alike: bool = True,
    ) -> None:
        self.what, self.total, self.parts = what, total, parts
        self.stream = stream or sys.stdout
        self.clock = clock
        self.alike = alike
        self.terminal = self.stream.isatty()
        self.done = 0
        self.began = self.told = clock()
        self._note = ""
        self._running: list[str] = []
        self._lock = threading.RLock()
        self._heartbeat = Heartbeat(self._beat)

    def __enter__(self) -> Progress:
        self._show()
        self._heartbeat.__enter__()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._heartbeat.__exit__(kind, error, trace)
        if self.terminal:
            print(file=self.stream)

    def step(self, note: str = "") -> None:
        """One more part has ended; ``note`` is what is known by now."""
        with self._lock:
            self.done += 1
            self._note = note
            pause = TERMINAL_PAUSE if self.terminal else PAUSE
            if self.done == self.total or self.clock() - self.told >= pause:
                self._show()

    @contextmanager
    def running(self, name: str) -> Iterator[None]:
        """Around one part, in whatever thread: it is named while nothing else ends."""
        with self._lock:
            self._running.append(name)
            if not self.alike:
                self._show()
        try:
            yield
        finally:
            with self._lock:
                self._running.remove(name)

    def say(self, line: str) -> None:
        """A line of its own that stays."""
        with self._lock:
            text = f"{CLEAR if self.terminal else ''}{line}"
            print(text, file=self.stream, flush=True)

    def _beat(self) -> None:
        with self._lock:
            if self.done < self.total and self.clock() - self.told >= PAUSE:
                self._show()

    def _show(self) -> None:
        self.told = self.clock()
        line = f"{self.what}: {self.done} of {self.total} {self.parts}"
        spent = self.told - self.began
        estimated = self.alike and self.done and self.done >= ESTIMATED * self.total
        if self.done == self.total:
            line += f" in {duration(spent)}"
        elif estimated:
            line += f", about {duration(spent / self.done * (self.total - self.done))} left"
        elif spent >= 1:
            line += f", {duration(spent)}"
        line += f", {self._note}" if self._note else ""
        if self._running and self.done < self.total:
            more = len(self._running) - MOST_NAMES
            names = ", ".join(self._running[:MOST_NAMES])
            line += f", running {names}{f' and {more} more' if more > 0 else ''}"
        if self.terminal:
            print(f"{CLEAR}{line}", end="", file=self.stream, flush=True)
        else:
            print(line, file=self.stream, flush=True)
