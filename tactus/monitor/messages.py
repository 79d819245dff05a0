"""The messages of the monitor, which does not repeat one kind of message all the time."""

import time
from collections import deque
from collections.abc import Callable

# The least number of seconds between two messages of the same kind.
PAUSE = 10.0
# The most lines that the page shows.
MOST_LINES = 30


class Messages:
    """Messages with the time of day; the newest comes first.

    say: Called with each line as it comes, for a terminal.
    clock: Gives a time in seconds.
    """

    def __init__(
        self, say: Callable[[str], None], clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.lines: deque[str] = deque(maxlen=MOST_LINES)
        self._say, self._clock = say, clock
        self._last: dict[str, float] = {}

    def due(self, kind: str) -> bool:
        """Whether so much time has passed that a message of this kind may be printed again."""
        now = self._clock()
        return now - self._last.get(kind, -PAUSE) >= PAUSE

    def tell(self, kind: str, text: str) -> None:
        """Print a message now, even if it is not ``due``."""
        self._last[kind] = self._clock()
        line = f"{time.strftime('%H:%M:%S')} {text}"
        self.lines.appendleft(line)
        self._say(line)
