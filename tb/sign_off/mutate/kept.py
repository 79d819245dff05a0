"""A store of what was found: what has not changed is not done again."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from golden.files import read_kept, write_kept
from golden.fingerprint import fingerprint
from golden.folders import BUILD

STORE = BUILD / "mutate"
# What an answer of each kind comes from.
SCRIPTS = {
    "replay": ("mutants.py", "replay.py"),
    "bench": ("mutants.py",),
    "same": ("mutants.py", "flat.py", "same.py"),
}
Answer = TypeVar("Answer")


def kept(work: Callable[[], Answer], kind: str, *facts: str) -> Answer:
    """What ``work`` answers, from the store if it was asked with the same facts before."""
    found = known(kind, *facts)
    if found is not None:
        answer: Answer = found[0]
        return answer
    answer = work()
    keep(answer, kind, *facts)
    return answer


def known(kind: str, *facts: str) -> list[Any] | None:
    """The answer in the store, in a list of its own; None where there is none."""
    found: list[Any] | None = read_kept(_path(kind, facts))
    return found


def keep(answer: object, kind: str, *facts: str) -> None:
    """Put an answer into the store."""
    write_kept(_path(kind, facts), [answer])


def _path(kind: str, facts: tuple[str, ...]) -> Path:
    return STORE / f"{fingerprint(scripts(kind), kind, *facts)}.json"


def scripts(*kinds: str) -> list[Path]:
    """The files of this package that answers of some kinds come from, or of all."""
    names = {name for kind in kinds or SCRIPTS for name in SCRIPTS[kind]}
    return [Path(__file__).parent / name for name in sorted(names)]
