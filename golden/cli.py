"""How every command ends: bad input prints one line and exits 2, never a traceback."""

from __future__ import annotations

import shlex
import sys
import warnings
from collections.abc import Callable


class CommandError(Exception):
    """A fault of the user's input or machine; the message says what to do."""


def words(name: str, text: str) -> list[str]:
    """The words of a command's variable that may hold several; quotes hold blanks together.

    Raises
    ------
    CommandError
        For a quote without its other.
    """
    try:
        return shlex.split(text)
    except ValueError as error:
        raise CommandError(f"{name}={text}: {error}") from None


def run(main: Callable[[], int | None]) -> int:
    """The exit code of ``main``; its complaints about input go to stderr as one message.

    Warnings go there too, each as a line of its own.
    """
    warnings.formatwarning = lambda message, *_, **__: f"warning: {message}\n"
    try:
        return main() or 0
    except (CommandError, ValueError, FileNotFoundError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130
