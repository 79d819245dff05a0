"""What is kept between runs, all of it in one folder: ``build/store``.

An answer is kept under a key: its kind and the parts that enter it, each by its name. A part is a
file or a folder by its content, code by what it does (``golden/closure.py``), or a fact, such as a
seed or the version of a tool. The parts stand in the file beside the answer, so that two files tell
why something was done anew.

A file is written beside its place and renamed, so of two processes that find one answer at once
each leaves a whole one. A file that is damaged counts as none. Where ``TACTUS_STORE`` names a
folder, that is the store: a nightly run names an empty one, and so takes nothing that another run
found.

No library does this: ``diskcache`` keeps pickles in a database, which nobody can read, and has had
no release since 2023; ``joblib.Memory`` keys a function by its own text alone, without what that
calls, and empties its folder when the text changes, whoever else reads there.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from golden.files import read_kept, write_kept
from golden.fingerprint import fingerprint
from golden.folders import BUILD
from golden.input_error import InputError

VARIABLE = "TACTUS_STORE"
# A longer text stands in a key as its digest.
LONGEST = 200
Part = str | int | Path | Sequence["Part"]


@dataclass(frozen=True)
class Key:
    """What an answer is of.

    Attributes
    ----------
    kind : str
        A folder of the store.
    parts : dict of str
        What enters, by name.
    """

    kind: str
    parts: dict[str, str]

    @property
    def digest(self) -> str:
        """A digest of all parts."""
        return fingerprint([], self.kind, *(f"{name} {self.parts[name]}" for name in self.parts))


def key(kind: str, **parts: Part) -> Key:
    """The key of an answer; files and folders enter it as they are now."""
    return Key(kind, {name: _told(parts[name]) for name in sorted(parts)})


def read(asked: Key, build: Path = BUILD) -> Any:
    """The answer that is kept under a key; None where there is none, or a damaged one."""
    found = read_kept(place(asked, build))
    if not isinstance(found, dict) or found.get("key") != asked.parts:
        return None
    answer = found.get("answer")
    return answer if found.get("sum") == _sum(answer) else None


def write(asked: Key, answer: Any, build: Path = BUILD) -> Any:
    """Keep what JSON can hold; the answer as it will be read.

    Raises
    ------
    ValueError
        For None, which stands for no answer, and for numbers that JSON cannot hold.
    InputError
        Where it cannot be written.
    """
    if answer is None:
        raise ValueError(f"{asked.kind}: got None, expected an answer")
    told = json.loads(json.dumps(answer, allow_nan=False))
    write_kept(place(asked, build), {"key": asked.parts, "sum": _sum(told), "answer": told})
    return told


def once(asked: Key, work: Callable[[], Any], build: Path = BUILD) -> Any:
    """The answer that is kept, or else what ``work`` finds, which is kept from now on."""
    found = read(asked, build)
    return write(asked, work(), build) if found is None else found


def place(asked: Key, build: Path = BUILD, suffix: str = ".json") -> Path:
    """Where the answer of a key stands, in the store of a folder for results."""
    return store(build) / asked.kind / f"{asked.digest}{suffix}"


def store(build: Path = BUILD) -> Path:
    """The folder of the store.

    Raises
    ------
    InputError
        Where the environment names one that depends on where a process stands.
    """
    named = os.environ.get(VARIABLE, "")
    if named and not Path(named).is_absolute():
        raise InputError(f"{VARIABLE}: got {named!r}, expected an absolute path")
    return Path(named) if named else build / "store"


def _told(part: Part) -> str:
    if isinstance(part, Path):
        return fingerprint([part])
    text = str(part) if isinstance(part, (str, int)) else json.dumps([_told(one) for one in part])
    short = len(text) <= LONGEST and text.isprintable()
    return text if short else hashlib.sha256(text.encode()).hexdigest()


def _sum(answer: Any) -> str:
    return hashlib.sha256(json.dumps(answer, sort_keys=True).encode()).hexdigest()
