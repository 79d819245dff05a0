"""The messages of the monitor: each kind comes once, and again only after a while."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

# A kind of message is not repeated within so many seconds.
PAUSE = 10.0
# The page shows at most so many lines.
MOST_LINES = 30


class Told:
    """Messages with the time of day; the newest comes first.

    Parameters
    ----------
    say : callable
        Called with each line as it comes, for a terminal.
    clock : callable
        Gives a time in seconds.
    """

    def __init__(
        self, say: Callable[[str], None], clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.lines: deque[str] = deque(maxlen=MOST_LINES)
        self._say, self._clock = say, clock
        self._last: dict[str, float] = {}

    def due(self, kind: str) -> bool:
        """Whether a message of that kind may come now."""
        now = self._clock()
        return now - self._last.get(kind, -PAUSE) >= PAUSE

    def tell(self, kind: str, text: str) -> None:
        """Give a message now, whenever the last one of its kind came."""
        self._last[kind] = self._clock()
        line = f"{time.strftime('%H:%M:%S')} {text}"
        self.lines.appendleft(line)
        self._say(line)
