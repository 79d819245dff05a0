"""Keeps results for later reports, by name and by the state of all that they depend on."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from golden.files import read_kept, write_kept
from golden.folders import BUILD
from tb.report.measure.table import Table

STORE = BUILD / "report"
# A function that is told the name of a part, the seconds that it took, and whether it was kept.
Progress = Callable[[str, float, bool], None]


def kept(name: str, state: str) -> Any:
    """The result that was kept under a name in the same state, or None."""
    found = read_kept(STORE / f"{name}.json")
    return found["answer"] if isinstance(found, dict) and found.get("state") == state else None


def keep(name: str, state: str, answer: Any) -> None:
    """Keep a result, which JSON must be able to hold, for the next report."""
    write_kept(STORE / f"{name}.json", {"state": state, "answer": answer})


def once(name: str, state: str, tell: Progress, work: Callable[[], Any]) -> Any:
    """The result of ``work``, from the store if the state is the same."""
    answer = kept(name, state)
    if answer is not None:
        tell(name, 0.0, True)
        return answer
    started = time.perf_counter()
    answer = work()
    keep(name, state, answer)
    tell(name, time.perf_counter() - started, False)
    return answer


def packed(table: Table) -> dict[str, Any]:
    """A table as the store holds it."""
    return {"name": table.name, **table.as_data(), "timed": list(table.timed)}


def unpacked(answer: dict[str, Any]) -> Table:
    """The table that was packed."""
    return Table(**answer)
