"""Every command of ``make``: its purpose, its variables, and the module that does the work.

``commands.toml`` says it for ``make help``, for the command ``tactus`` (``tactus.cli.console``),
for the table of commands in ``docs/README.md``, for the words that a module is called with and how
it reads them, and for the tests. ``make help`` must work before anything is installed, so this file
imports nothing but the standard library.
"""

import argparse
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tactus.core.cli import whole
from tactus.core.folders import BUILD


@dataclass(frozen=True)
class Argument:
    """A variable that a command of make accepts.

    name: The name of the variable, such as ``BLOCK``.
    kind: "text" and "file", whose ``NAME=x`` becomes ``--name=x``; "word", whose value is a word by
        itself; "flag", whose ``NAME=1`` becomes ``--name``.
    example: What the help shows after ``=``.
    default: The value if the variable is not set; None for no word. A word that is needed is then
        handed on empty, and the module says what is missing.
    needed: Whether the command requires the variable.
    span: The least and the largest value of a whole number; else empty.
    """

    name: str
    kind: str = "text"
    example: str = ""
    default: Any = None
    needed: bool = False
    span: tuple[int, ...] = ()

    @property
    def flag(self) -> bool:
        return self.kind == "flag"

    @property
    def option(self) -> str:
        """What precedes the value when the module is called; empty if it is a word by itself."""
        return "" if self.kind == "word" else f"--{self.name.lower()}{'' if self.flag else '='}"

    @property
    def usage(self) -> str:
        """The variable as the help shows it, in brackets if it may be left out."""
        text = f"{self.name}={'1' if self.flag else self.example}"
        return text if self.needed else f"[{text}]"

    def words(self, given: Mapping[str, str]) -> list[str]:
        """The words that the variable adds to the call of the module."""
        value = given.get(self.name)
        if self.flag:
            return [self.option] if value not in (None, "", "0") else []
        if self.option:
            return [f"{self.option}{value}"] if value else []
        left_out = "" if self.needed else self.default
        word = left_out if value is None else value
        return [] if word is None else [word]

    def add(self, parser: argparse.ArgumentParser) -> None:
        """Let the parser of a module read those words."""
        if self.flag:
            parser.add_argument(self.option, action="store_true")
        elif self.option:
            read: Callable[[str], Any] = Path if self.kind == "file" else str
            read = whole(self.name, *self.span) if self.span else read
            parser.add_argument(self.option.rstrip("="), type=read, default=self.default)
        else:
            missing = "?" if not (self.needed or self.default) else None
            parser.add_argument(self.name.lower(), nargs=missing, default=self.default)


@dataclass(frozen=True)
class Command:
    """A command of make.

    purpose: One paragraph that says what the command does.
    arguments: The variables, in the order in which the module takes them.
    module: The module that does the work. It is empty if the Makefile does it itself.
    last: Words that always end the call of the module.
    """

    name: str
    purpose: str
    arguments: tuple[Argument, ...] = ()
    module: str = ""
    last: tuple[str, ...] = ()

    @property
    def usage(self) -> str:
        """The command with all of its variables, the required ones first."""
        ordered = sorted(self.arguments, key=lambda argument: not argument.needed)
        return " ".join(["make", self.name, *(argument.usage for argument in ordered)])

    def words(self, given: Mapping[str, str]) -> list[str]:
        """The words after ``python`` for the variables ``given``.

        If a word looks like an option, ``--`` separates the options from the words, so that it is
        still read as a word.
        """
        options: list[str] = []
        words: list[str] = []
        for argument in self.arguments:
            (options if argument.option else words).extend(argument.words(given))
        words += self.last
        if any(word.startswith("-") for word in words):
            words.insert(0, "--")
        return ["-m", "tactus.cli.call", self.module, *options, *words]


def _command(name: str, table: dict[str, Any]) -> Command:
    """The command of one table of ``commands.toml``; a name in capitals there is a variable."""
    variables = {key: table.pop(key) for key in [*table] if key.isupper()}
    arguments = tuple(Argument(key, **facts) for key, facts in variables.items())
    return Command(name, " ".join(table.pop("purpose").split()), arguments, **table)


_TABLES = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
COMMANDS = tuple(_command(name, table) for name, table in _TABLES.items())
BY_NAME = {command.name: command for command in COMMANDS}
# What make takes beside any target.
EVERYWHERE = ("DRY", "PYTHON", "SITE", "VENV")
CLOSING = (
    "DRY=1 beside a command checks all that it is given, prints what it would do, and does "
    "nothing. FORCE=1 replaces a file that the command does not recognise as its own."
)


def arguments_of(name: str, doc: str | None, **more: type) -> argparse.Namespace:
    """What a module is called with, as the table says.

    doc: The docstring of the module, for its help.
    more: The types of the options that only its Python callers give, by their names.
    """
    parser = argparse.ArgumentParser(prog=f"make {name}", description=doc)
    for argument in (*BY_NAME[name].arguments, Argument("BUILD", "file", default=BUILD)):
        argument.add(parser)
    for option, kind in more.items():
        parser.add_argument(f"--{option}", type=kind)
    return parser.parse_args()
