"""How commands must refuse bad input: one line, exit code 2, no files written, no traceback."""

import importlib
import re
import sys
import warnings
from collections.abc import Callable
from pathlib import Path

import pytest

from tactus.core.cli import run
from tactus.core.commands import BY_NAME
from tactus.core.fingerprint import fingerprint

# The commands that tests call with wrong arguments.
COMMANDS = (
    *("train", "vhdl", "sim", "network", "image", "listing", "lean", "synth"),
    *("bitstream", "report", "demo", "scene", "check", "predict"),
)


def main_of(module: str) -> Callable[[], int | None]:
    """The ``main`` that ``tactus.cli.call`` runs for a module."""
    main: Callable[[], int | None] = importlib.import_module(module).main
    return main


def call(command: str, *words: object) -> int | None:
    """Run a command in this process, with words as make gives them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", [command, *map(str, words)])
        return main_of(BY_NAME[command].module)()


class Desk:
    """A folder with the scene ``mine.toml``, its data and its network, to call commands on."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture):
        self.folder = folder
        self._monkeypatch = monkeypatch
        self._capfd = capfd
        monkeypatch.chdir(folder)
        monkeypatch.setattr(warnings, "formatwarning", warnings.formatwarning)

    def edit(self, old: str, new: str, file: str = "mine.toml", encoding: str = "utf-8") -> None:
        """Replace ``old``, which the file must contain, or the whole file by ``new``."""
        text = (self.folder / file).read_text(encoding=encoding)
        assert old in text, f"{file} has no {old!r}"
        text = text.replace(old, new, 1) if old else new
        (self.folder / file).write_text(text, encoding=encoding)

    def call(self, command: str, *words: str) -> tuple[int, str]:
        """The exit code of a command, and its text on stderr without warnings."""
        known = BY_NAME[command]
        main = main_of(known.module)
        self._monkeypatch.setattr(sys, "argv", [command, *words, *known.last])
        self._capfd.readouterr()
        try:
            code = run(main)
        except SystemExit as stop:
            code = stop.code if isinstance(stop.code, int) else 1
        said = self._capfd.readouterr().err
        return code, "".join(
            line for line in said.splitlines(keepends=True) if not line.startswith("warning: ")
        )

    def refuses(self, command: str, *words: str, says: str | list[str] = "") -> None:
        """Check that a command refuses, with a line for each fault, and does not change the folder.

        Each line must hold what is said of it, in which ``.*`` stands for any text.
        """
        expected = [says] if isinstance(says, str) else says
        before = fingerprint([self.folder])
        code, said = self.call(command, *words)
        assert "Traceback" not in said, said
        assert code == 2, said
        lines = [line for line in said.splitlines() if not line.startswith("usage: ")]
        assert len(lines) == len(expected), said
        for line, text in zip(lines, expected, strict=True):
            assert re.search(re.escape(text).replace(r"\.\*", ".*"), line), line
        assert fingerprint([self.folder]) == before
