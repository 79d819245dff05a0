"""What a check saw: a line each, and whether anything can be done in spite of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from golden.cli import BETWEEN
from golden.input_error import InputError

OK, NOTE, WARNING, FAULT = "ok", "note", "warning", "fault"


@dataclass(frozen=True)
class Finding:
    """One finding.

    Parameters
    ----------
    verdict : str
        ``ok``; ``note``, which is worth knowing; ``warning``, which makes the result worse than it
        seems; ``fault``, with which nothing can be done.
    subject : str
        What was looked at: a file, a column.
    text : str
    """

    verdict: str
    subject: str
    text: str

    def __str__(self) -> str:
        return f"{self.verdict:8} {self.subject}: {self.text}"


def fault(message: object, verdict: str = FAULT) -> Finding:
    """The finding that an error's message tells, which begins with its subject."""
    subject, _, text = str(message).partition(": ")
    return Finding(verdict, subject, text)


@contextmanager
def told(findings: list[Finding]) -> Iterator[None]:
    """A complaint from the block becomes one of the findings; one of several faults that many."""
    try:
        yield
    except InputError as error:
        findings.extend(map(fault, str(error).split(BETWEEN)))


def faults(findings: Iterable[Finding]) -> list[str]:
    """The faults among them, as messages."""
    return [f"{f.subject}: {f.text}" for f in findings if f.verdict == FAULT]


def refuse(findings: Sequence[Finding]) -> None:
    """Stop at faults, all of them in one message.

    Raises
    ------
    InputError
    """
    found = faults(findings)
    if found:
        raise InputError(BETWEEN.join(found))


def several(names: Sequence[str], most: int = 5) -> str:
    """Names in a row, the last ones left out where there are many."""
    shown = ", ".join(map(repr, names[:most]))
    return f"{shown} and {len(names) - most} more" if len(names) > most else shown
