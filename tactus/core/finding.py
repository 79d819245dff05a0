"""The findings of a check, one line each, and whether work can go on in spite of them."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from golden.input_error import InputError
from tactus.core.cli import BETWEEN

OK, NOTE, WARNING, FAULT = "ok", "note", "warning", "fault"
# How many names a message shows.
MOST_NAMES = 5


@dataclass(frozen=True)
class Finding:
    """One finding of a check.

    verdict: ``ok``; ``note``, which is worth knowing; ``warning``, with which the result is worse
        than it seems; ``fault``, with which nothing can be done.
    subject: The subject of the check, such as a file or a column.
    """

    verdict: str
    subject: str
    text: str

    def __str__(self) -> str:
        return f"{self.verdict:8} {self.subject}: {self.text}"


def fault(message: object, verdict: str = FAULT) -> Finding:
    """The finding for an error's message, which begins with its subject."""
    subject, _, text = str(message).partition(": ")
    return Finding(verdict, subject, text)


@contextmanager
def collect_faults(findings: list[Finding]) -> Iterator[None]:
    """Add a complaint from the block to the findings, or several if it lists several faults."""
    try:
        yield
    except InputError as error:
        findings.extend(map(fault, str(error).split(BETWEEN)))


def faults(findings: Iterable[Finding]) -> list[str]:
    """The faults among the findings, as messages."""
    return [f"{f.subject}: {f.text}" for f in findings if f.verdict == FAULT]


def refuse(findings: Sequence[Finding]) -> None:
    """Stop if there are faults, with all of them in one message."""
    found = faults(findings)
    if found:
        raise InputError(BETWEEN.join(found))


def several(names: Sequence[str]) -> str:
    """A list of names for a message; if there are many, only the first ones are shown."""
    shown = ", ".join(map(repr, names[:MOST_NAMES]))
    more = len(names) - MOST_NAMES
    return f"{shown} and {more} more" if more > 0 else shown
