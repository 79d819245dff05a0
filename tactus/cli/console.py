"""``tactus COMMAND``: the commands of ``tactus.core.commands``, from any folder, where tactus is
installed.

click reads the command line, and the table says what the line may hold. ``SCENE`` is a word, a
variable ``NAME=1`` of make is a flag ``--name``, and any other ``NAME=x`` is an option
``--name=x``. The values then go to the same module as from make.
"""

import os
import re
import sys
import textwrap
from collections.abc import Sequence
from functools import partial
from typing import Any

import click
from click.shell_completion import CompletionItem

from golden.input_error import InputError, suggest
from tactus.cli.commands import WIDTH, scene_names, start
from tactus.core.cli import run
from tactus.core.commands import BY_NAME, COMMANDS, Argument, Command
from tactus.core.folders import is_checkout

NAME = "tactus"
WORD = "SCENE"
# The variables whose value is the name or the path of a scene.
SCENES = (WORD, "HARDWARE", "BESIDE")
DRY = Argument("DRY", "flag")
ARGUMENTS = {a.name: a for a in (DRY, *(a for c in COMMANDS for a in c.arguments))}
INSTALLED = [command for command in COMMANDS if command.module]
SETTINGS: dict[str, Any] = {"help_option_names": ["-h", "--help"], "max_content_width": WIDTH}


def typed(text: str) -> str:
    """A text of the table, with its commands and variables written as ``tactus`` takes them."""
    text = re.sub(rf"\bmake (?=(?:{'|'.join(BY_NAME)})\b)", f"{NAME} ", text)
    return re.sub(r"\b([A-Z]+)=(\w*)", lambda found: _typed(found[0], *found.groups()), text)


def _typed(whole: str, name: str, value: str) -> str:
    argument = ARGUMENTS.get(name)
    if argument is None:
        return whole
    if name == WORD:
        return value or WORD
    return _option(argument) + (f"={value}" if value and not argument.flag else "")


def _option(argument: Argument) -> str:
    return f"--{argument.name.lower()}"


def _paragraph(text: str) -> str:
    """A paragraph that click does not wrap again, since it would break names at their hyphens."""
    return "\b\n" + textwrap.fill(text, 76, break_long_words=False, break_on_hyphens=False)


class Front(click.Group):
    """All commands in the order of the table. An unknown command gets a suggestion."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The commands in the order of the table, and not of the alphabet."""
        return list(self.commands)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find a command as click does, and suggest the nearest name for an unknown one."""
        name = args[0]
        if name not in self.commands and not ctx.resilient_parsing and not name.startswith("-"):
            if name in BY_NAME:
                raise InputError(f"{name}: is a command of a checkout of tactus alone: make {name}")
            raise InputError(
                f"{name}: no such command, expected one of {', '.join(self.commands)}"
                f"{suggest(name, list(self.commands))}"
            )
        return super().resolve_command(ctx, args)


def front() -> Front:
    """The commands of the table that ``tactus`` has; some exist only in make."""
    closing = (
        f"SCENE is a path to a .toml file, or one of {', '.join(scene_names())}.",
        "Results go below build in the folder in which you stand.",
        f"Pages and messages name what a command takes as make does: make sim BLOCK=engine is "
        f"{NAME} sim --block=engine.",
    )
    group = Front(
        NAME,
        commands={command.name: _command(command) for command in INSTALLED},
        help="Small neural networks for distributive tactile sensing as verified hardware.",
        epilog="\n\n".join(map(_paragraph, closing)),
        context_settings=SETTINGS,
        subcommand_metavar="COMMAND [SCENE] [OPTIONS]",
    )
    return click.version_option(package_name=NAME, message="%(prog)s %(version)s")(group)


def _command(command: Command) -> click.Command:
    purpose = typed(command.purpose)
    first = re.split(r"(?<=[.;]) ", purpose)[0].rstrip(";.")
    default = next((a.default for a in command.arguments if a.name == WORD), None)
    texts = [purpose, *([f"SCENE is {default} where none is given."] if default else [])]
    return click.Command(
        command.name,
        params=[_parameter(argument) for argument in (*command.arguments, DRY)],
        help="\n\n".join(map(_paragraph, texts)),
        short_help=first,
        callback=partial(_call, command),
        context_settings=SETTINGS,
    )


def _parameter(argument: Argument) -> click.Parameter:
    key, complete = argument.name.lower(), partial(_offered, argument)
    if argument.name == WORD:
        return click.Argument([key], required=argument.needed, shell_complete=complete)
    about = "Check the arguments, print what would be done, and do nothing."
    return click.Option(
        [key, _option(argument)],
        is_flag=argument.flag,
        required=argument.needed,
        metavar=None if argument.flag else argument.example or argument.name,
        help=about if argument is DRY else None,
        shell_complete=complete,
    )


def _offered(
    argument: Argument, _: click.Context, __: click.Parameter, begun: str
) -> list[CompletionItem]:
    """The completions of a word. A shell adds file names where a file is possible."""
    names: Sequence[str] = ()
    if argument.name == "BLOCK":
        # Only here, since it imports numpy.
        from tactus.verify.benches.blocks import block_names

        names = block_names()
    elif argument.name in SCENES:
        names = scene_names()
    elif "|" in argument.example:
        names = argument.example.split("|")
    found = [CompletionItem(name) for name in names if name.startswith(begun)]
    if not found and (argument.name in SCENES or re.search(r"[./]|folder", argument.example)):
        return [CompletionItem(begun, type="file")]
    return found


def _call(command: Command, /, **given: str | bool | None) -> None:
    """Run the module of a command with the values, under the names that make gives them."""
    words = {
        key.upper(): "1" if value is True else str(value)
        for key, value in given.items()
        if value not in (None, False)
    }
    if "RECORD" in words and not is_checkout() and not words.get(WORD, "").endswith(".toml"):
        raise InputError(
            "--record: the records of blocks, of tables and of shipped scenes belong to a "
            "checkout of tactus; expected a scene of your own, as a path to a .toml file"
        )
    # Use the installed modules, even if the folder of the user holds modules with the same names.
    os.environ["PYTHONSAFEPATH"] = "1"
    os.environ[DRY.name] = words.pop(DRY.name, "")
    start(command, words)


def _parsed() -> int:
    try:
        code = front().main(sys.argv[1:] or ["--help"], prog_name=NAME, standalone_mode=False)
    except click.UsageError as error:
        path = error.ctx.command_path if error.ctx else NAME
        said = " ".join(error.format_message().split())
        said += "" if said.endswith((".", "?")) else "."
        raise InputError(f"{path}: {said} See: {path} --help") from None
    return int(code or 0)


def main() -> int:
    return run(_parsed)
