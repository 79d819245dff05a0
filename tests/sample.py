"""A drawn sample of the tests that ``make test ALL=1`` adds: ``make test SAMPLE=60``.

Tests that only ALL=1 runs must not break unnoticed between two nightly runs, so CI adds a
minute of them to every run. The digest of the tree is the seed: the same tree draws the same
tests, and the next tree draws others. The time of each test is recorded, so that the sample fits
its time. A test that takes longer than the whole sample is never drawn, and is left to the nightly
run.
"""

import hashlib
import os
import subprocess
from collections.abc import Iterable, Mapping
from pathlib import Path

from golden.files import read_json, write_json

ROOT = Path(__file__).parents[1]
SECONDS = Path(__file__).parent / "data" / "seconds.json"
# The assumed time of a test that was never timed. It may be long, so only few of these are drawn.
UNTIMED = 180.0


def tree() -> str:
    """The digest of the committed tree."""
    command = ["git", "-C", str(ROOT), "rev-parse", "HEAD^{tree}"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def cores() -> int:
    """The processors that share a sample's time."""
    return os.cpu_count() or 1


def timed() -> dict[str, float]:
    """For each test or unit, the seconds of one processor when ALL=1 was last timed."""
    found: dict[str, float] = read_json(SECONDS, "JSON", "no times of tests are recorded")
    return found


def record(times: Mapping[str, float]) -> None:
    """Record how long tests take, without forgetting others: ``make test ALL=1 RECORD=1``."""
    now = {name: round(seconds, 1) for name, seconds in times.items()}
    write_json(SECONDS, {**timed(), **now}, sort_keys=True)


def draw(
    names: Iterable[str], seconds: Mapping[str, float], budget: float, digest: str
) -> list[str]:
    """The tests that fit into ``budget`` seconds, in an order that the digest shuffles.

    names: All tests that could be drawn, and the units of those that are drawn together.
    seconds: For each test or unit, how long it takes.
    budget: The time for the sample, in seconds of one processor.
    digest: The digest of the tree.
    """
    order = sorted(names, key=lambda name: hashlib.sha256(f"{digest} {name}".encode()).digest())
    drawn, left = [], budget
    for name in order:
        takes = seconds.get(name, UNTIMED)
        if takes <= left:
            drawn.append(name)
            left -= takes
    return drawn
