"""A store of answers: a question whose facts have not changed is not asked again."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from golden.files import read_kept, write_kept
from golden.fingerprint import fingerprint
from golden.folders import BUILD

STORE = BUILD / "mutate"
# The files on which an answer of each kind depends.
SCRIPTS = {
    "replay": ("mutants.py", "replay.py"),
    "bench": ("mutants.py",),
    "same": ("mutants.py", "flat.py", "same.py"),
}
Answer = TypeVar("Answer")


def kept(work: Callable[[], Answer], kind: str, *facts: str) -> Answer:
    """The answer of ``work``, from the store if the same facts were asked for before."""
    found = known(kind, *facts)
    if found is not None:
        answer: Answer = found[0]
        return answer
    answer = work()
    keep(answer, kind, *facts)
    return answer


def known(kind: str, *facts: str) -> list[Any] | None:
    """The answer in the store, wrapped in a list; None where there is none."""
    found: list[Any] | None = read_kept(_path(kind, facts))
    return found


def keep(answer: object, kind: str, *facts: str) -> None:
    """Put an answer into the store."""
    write_kept(_path(kind, facts), [answer])


def _path(kind: str, facts: tuple[str, ...]) -> Path:
    return STORE / f"{fingerprint(scripts(kind), kind, *facts)}.json"


def scripts(*kinds: str) -> list[Path]:
    """The files of this package on which answers of some kinds depend, or of all kinds."""
    names = {name for kind in kinds or SCRIPTS for name in SCRIPTS[kind]}
    return [Path(__file__).parent / name for name in sorted(names)]
