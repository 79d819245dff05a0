"""The processor time of a command of sign-off, which does not depend on what else is running."""

import os


def processor_minutes() -> float:
    """What this process and all those that it started and waited for have used so far."""
    return sum(os.times()[:4]) / 60


def processor_line(minutes: float, processors: int = 2) -> str:
    """The line that tells the processor time, and what it means on an idle machine.

    Answers that were in the store took no time, so only a run with an empty store tells all of it.
    """
    return (
        f"processor time {minutes:.1f} minutes, without the answers that the store had; at least "
        f"{minutes / processors:.1f} minutes on {processors} processors that do nothing else"
    )
