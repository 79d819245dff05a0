"""The error for faults of the input or the machine, as opposed to faults of this project."""

import difflib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager


class InputError(Exception):
    """A fault of the user's input or machine; the message says what to do.

    It names the file and the key, or the variable of the command, and says what came and what was
    expected. A command prints it as one line and exits with 2. Every other exception is a fault of
    this project, and keeps its traceback.
    """


class MissingFileError(InputError, FileNotFoundError):
    """A file is missing that the user names, or that a command should have written before."""


@contextmanager
def naming(place: object) -> Iterator[None]:
    """Put the place of a fault, such as a file or a key, before complaints from the block."""
    try:
        yield
    except InputError as error:
        raise type(error)(f"{place}: {error}") from None


def suggest(name: str, known: Sequence[str]) -> str:
    """A hint that names the nearest known name; empty if none is near."""
    near = difflib.get_close_matches(name, known, n=1)
    return f"; did you mean {near[0]!r}?" if near else ""
