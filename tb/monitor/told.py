"""What the monitor says of a line, in words: each thing once, and again only after a while."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

# Seconds in which the same kind of thing is not said again.
PAUSE = 10.0
# Lines that the page shows.
MOST_LINES = 30


class Told:
    """Lines with the time of day, the newest first.

    Parameters
    ----------
    say : callable
        Takes each line as it comes, for a terminal.
    clock : callable
        Seconds from some beginning.
    """

    def __init__(
        self, say: Callable[[str], None], clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.lines: deque[str] = deque(maxlen=MOST_LINES)
        self._say, self._clock = say, clock
        self._last: dict[str, float] = {}

    def due(self, kind: str) -> bool:
        """Whether a thing of that kind may be said now."""
        now = self._clock()
        return now - self._last.get(kind, -PAUSE) >= PAUSE

    def tell(self, kind: str, text: str) -> None:
        """Say it, whenever it was said before."""
        self._last[kind] = self._clock()
        line = f"{time.strftime('%H:%M:%S')} {text}"
        self.lines.appendleft(line)
        self._say(line)
