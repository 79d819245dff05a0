"""What make asks of the table of commands: its help, the start of a command, what is refused.

``make help`` must work before anything is installed, so this file imports nothing but the standard
library.
"""

import difflib
import os
import subprocess
import sys
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NoReturn

from golden.input_error import InputError
from tactus.core.cli import run
from tactus.core.commands import BY_NAME, CLOSING, COMMANDS, EVERYWHERE, Command

ROOT = Path(__file__).parents[2]
WIDTH = 100
INDENT = 10


def scene_names() -> list[str]:
    """The same names as ``tactus.scene.scene_names``, which needs numpy."""
    folder = ROOT / "scenes"
    return sorted(
        path.parent.name for path in folder.glob("*/*.toml") if path.parent.name == path.stem
    )


def help_text() -> str:
    """The text that ``make`` without a target prints."""
    lines = []
    for command in COMMANDS:
        # There is no blank within brackets, so no line break falls into an argument.
        lines += _wrapped(command.usage, "", " " * INDENT)
        lines += _wrapped(command.purpose, " " * INDENT, " " * INDENT)
    names = ", ".join(scene_names())
    lines.append("")
    lines += _wrapped(f"SCENE= is a path to a .toml file, or one of {names}.", "", "")
    lines += _wrapped(CLOSING, "", "")
    return "\n".join(lines)


def _wrapped(text: str, first: str, others: str) -> list[str]:
    return textwrap.wrap(
        text,
        WIDTH,
        initial_indent=first,
        subsequent_indent=others,
        break_long_words=False,
        break_on_hyphens=False,
    )


def start(command: Command, given: Mapping[str, str]) -> NoReturn:
    os.execv(sys.executable, [sys.executable, *command.words(given)])


def refuse_unknown(goals: Sequence[str], names: Sequence[str], given: Mapping[str, str]) -> None:
    """Refuse what make would ignore, or take for a 1.

    goals: The targets of the call.
    names: The variables that its command line names.
    given: The values of all variables.
    """
    arguments = [a for goal in goals if goal in BY_NAME for a in BY_NAME[goal].arguments]
    taken = [*dict.fromkeys(argument.name for argument in arguments), *EVERYWHERE]
    for name in names:
        if name not in taken:
            near = difflib.get_close_matches(name.upper(), taken, n=1)
            hint = f"; did you mean {near[0]}=?" if near else ""
            raise InputError(
                f"{name}=: make {' '.join(goals) or 'help'} takes no such variable, expected one "
                f"of {', '.join(taken)}{hint}"
            )
    for name in ["DRY", *(argument.name for argument in arguments if argument.flag)]:
        value = given.get(name, "")
        if value not in ("", "0", "1"):
            raise InputError(f"{name}={value}: expected 1, or 0 or nothing")


def main() -> int | None:
    """``python -m tactus.cli.commands TARGET``: print the help, or run a command or the text of a
    recipe.

    The values of the variables come from the environment, where no character is special.
    """
    name = sys.argv[1]
    if name == "help":
        print(help_text())
        return None
    if name == "shell":
        return subprocess.run(["sh", "-c", sys.argv[2]], check=False).returncode
    if name == "named":
        goals, names = (os.environ[name].split() for name in ("GOALS", "NAMED"))
        refuse_unknown(goals, names, os.environ)
        return None
    start(BY_NAME[name], os.environ)


if __name__ == "__main__":
    sys.exit(run(main))
