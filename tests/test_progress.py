"""Progress: lines where somebody reads a file later, one line on a terminal."""

from __future__ import annotations

import io

import pytest

from golden.progress import PAUSE, Progress, duration


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


class Clock:
    """Stands still until it is moved."""

    now = 100.0

    def __call__(self) -> float:
        return self.now


def test_a_line_at_the_beginning_every_few_seconds_and_at_the_end() -> None:
    stream, clock = io.StringIO(), Clock()
    with Progress("digit: simulating", 4, "benches", stream, clock) as progress:
        clock.now += PAUSE - 1
        progress.step()
        clock.now += 2
        progress.step("best 3")
        progress.say("FAIL")
        progress.step()
        clock.now += 1
        progress.step()
    assert stream.getvalue().splitlines() == [
        "digit: simulating: 0 of 4 benches",
        "digit: simulating: 2 of 4 benches, about 6 s left, best 3",
        "FAIL",
        "digit: simulating: 4 of 4 benches in 7 s",
    ]


def test_a_terminal_shows_one_line() -> None:
    stream, clock = Terminal(), Clock()
    with Progress("a", 2, "parts", stream, clock) as progress:
        for _ in range(2):
            clock.now += 1
            progress.step()
    shown = stream.getvalue()
    assert shown.count("\n") == 1
    assert shown.split("\r\x1b[K")[1:] == [
        "a: 0 of 2 parts",
        "a: 1 of 2 parts, about 1 s left",
        "a: 2 of 2 parts in 2 s\n",
    ]


def test_an_interrupted_step_leaves_the_terminal_on_a_new_line() -> None:
    stream = Terminal()
    with pytest.raises(KeyboardInterrupt), Progress("a", 2, "parts", stream):
        raise KeyboardInterrupt
    assert stream.getvalue().endswith("\n")


@pytest.mark.parametrize(("seconds", "text"), [(0, "0 s"), (89, "89 s"), (90, "2 min")])
def test_how_long_in_words(seconds: float, text: str) -> None:
    assert duration(seconds) == text
