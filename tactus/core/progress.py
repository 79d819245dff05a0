"""Shows what a long step does, how many parts are done, and about how long the rest takes.

A library such as rich would replace only the ten lines that draw the one line on a terminal. In a
pipe or a log it prints nothing until the end, and there a line every few seconds is needed.
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TextIO

# The least number of seconds between two lines if the output is no terminal, and about the longest
# wait for a line.
PAUSE = 4.0
TERMINAL_PAUSE = 0.1
# How often to check whether a line is due.
BEAT = 0.5
# There is no estimate before this part is done, because the first parts are seldom typical.
ESTIMATED = 0.05
# How many of the running parts one line names.
MOST_NAMES = 3
# Returns to the beginning of the line and clears it.
CLEAR = "\r\x1b[K"


def duration(seconds: float) -> str:
    """A duration as text, in seconds or in minutes."""
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


@contextmanager
def heartbeat(call: Callable[[], None]) -> Iterator[None]:
    """Call a function again and again in a thread of its own, while a block runs."""
    ended = threading.Event()

    def beat() -> None:
        while not ended.wait(BEAT):
            call()

    thread = threading.Thread(target=beat, name="progress", daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


@contextmanager
def stage(
    what: str | Callable[[], str],
    stream: TextIO | None = None,
    quick: bool = False,
    pause: float | None = None,
) -> Iterator[None]:
    """Print what the block does, and every few seconds that it is still running.

    what: Description of the work, such as ``digit: exporting``; or gives it anew for each line.
    stream: Standard output by default.
    quick: Whether the work is usually done before the first of these lines, so that nothing is
        printed at its beginning.
    pause: The seconds between two lines, if not ``PAUSE``.
    """
    out = stream or sys.stdout
    said = what if callable(what) else lambda: what
    began = printed = time.monotonic()

    def beat() -> None:
        nonlocal printed
        now = time.monotonic()
        if now - printed >= (pause or PAUSE):
            printed = now
            print(f"{said()}, {duration(now - began)}", file=out, flush=True)

    if not quick:
        print(said(), file=out, flush=True)
    with heartbeat(beat):
        yield


class Progress:
    """Counts parts of a job as they end.

    On a terminal one line is written again and again. Elsewhere there is a line every few seconds,
    and one at the end. If no part ends for this long, the line names the parts that are running.

    what: Description of the job, such as ``digit: simulating``.
    parts: Name of the parts, such as ``benches``.
    alike: Whether all parts take about the same time, so that the time for the remaining ones can
        be estimated. Otherwise nothing is estimated, and each part is named when it begins.
    costs: Of parts that are not alike, about how long each takes compared with the others, in the
        order in which they end. The first one counts for nothing, because processes start in its
        time.
    known: How many parts an earlier run has done, which take no time.
    """

    def __init__(
        self,
        what: str,
        total: int,
        parts: str,
        stream: TextIO | None = None,
        clock: Callable[[], float] = time.monotonic,
        alike: bool = True,
        costs: Sequence[float] = (),
        known: int = 0,
    ) -> None:
        self.what, self.total, self.parts = what, total, parts
        self.stream = stream or sys.stdout
        self.clock = clock
        self.alike = alike
        self.costs = costs or [1.0] * total
        self.starting = bool(costs)
        self.known = known
        self.terminal = self.stream.isatty()
        self.done = 0
        self.began = self.timed = self.printed = clock()
        self._note = ""
        self._running: list[str] = []
        self._lock = threading.RLock()
        self._heartbeat = heartbeat(self._beat)

    def __enter__(self) -> Progress:
        self._show()
        self._heartbeat.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        self._heartbeat.__exit__(None, None, None)
        if self.terminal:
            print(file=self.stream)

    def step(self, note: str = "") -> None:
        """Count one more part that has ended; ``note`` is what is known so far."""
        with self._lock:
            self.done += 1
            self._note = note
            if self.starting and self.done > self.known:
                self.starting, self.known = False, self.done
                self.timed = self.clock()
            pause = TERMINAL_PAUSE if self.terminal else PAUSE
            if self.done == self.total or self.clock() - self.printed >= pause:
                self._show()

    @contextmanager
    def running(self, name: str) -> Iterator[None]:
        """Surround one part, in any thread; the part is named while no other part ends."""
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
        """Print a line that stays."""
        with self._lock:
            text = f"{CLEAR if self.terminal else ''}{line}"
            print(text, file=self.stream, flush=True)

    def _beat(self) -> None:
        with self._lock:
            if self.done < self.total and self.clock() - self.printed >= PAUSE:
                self._show()

    def _show(self) -> None:
        self.printed = self.clock()
        line = f"{self.what}: {self.done} of {self.total} {self.parts}"
        spent = self.printed - self.began
        done, left = sum(self.costs[self.known : self.done]), sum(self.costs[self.done :])
        estimated = self.alike and done and done >= ESTIMATED * (done + left)
        if self.done == self.total:
            line += f" in {duration(spent)}"
        elif estimated:
            each = (self.printed - self.timed) / done
            line += f", about {duration(each * left)} left"
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
