"""The store: one folder, ``build/store``, for everything that is kept between runs.

An answer is kept under a key, which names all that the answer depends on; ``docs/architecture.md``
tells of what parts it is made. If two processes find the same answer at once, each of them leaves a
complete file. The nightly run names an empty folder in ``TACTUS_STORE``, so it uses nothing that an
earlier run found.
"""

import hashlib
import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.core.cli import ENDING
from tactus.core.files import replace_file
from tactus.core.fingerprint import fingerprint
from tactus.core.folders import BUILD

VARIABLE = "TACTUS_STORE"
# A longer text is replaced by its digest in a key.
LONGEST = 200
Part = str | int | Path | Sequence["Part"]


@dataclass(frozen=True)
class Key:
    """The key of an answer.

    kind: The folder of the store in which the answer is kept.
    parts: Everything on which the answer depends, by name.
    """

    kind: str
    parts: dict[str, str]

    @property
    def digest(self) -> str:
        """A digest of all parts."""
        return fingerprint([], self.kind, *(f"{name} {self.parts[name]}" for name in self.parts))


def key(kind: str, **parts: Part) -> Key:
    """Make the key of an answer from the present contents of its files and folders."""
    return Key(kind, {name: _as_text(parts[name]) for name in sorted(parts)})


def is_there(build: Path = BUILD) -> bool:
    """Whether something can be kept without a new folder beside a user's files."""
    return bool(os.environ.get(VARIABLE)) or build.is_dir()


def read(asked: Key, build: Path = BUILD) -> Any:
    """The answer that is kept under a key, or None if it is missing or damaged."""
    try:
        found = json.loads(place(asked, build).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    if not isinstance(found, dict) or found.get("key") != asked.parts:
        return None
    answer = found.get("answer")
    return answer if found.get("sum") == _sum(answer) else None


def write(asked: Key, answer: Any, build: Path = BUILD) -> Any:
    """Keep an answer, and return it as a later ``read`` will give it."""
    if answer is None:
        raise ValueError(f"{asked.kind}: got None, expected an answer")
    kept = json.loads(json.dumps(answer, allow_nan=False))
    # A simulation that was ended would count as one that failed.
    if not ENDING.is_set():
        with replace_file(place(asked, build)) as temporary:
            found = {"key": asked.parts, "sum": _sum(kept), "answer": kept}
            temporary.write_text(json.dumps(found), encoding="utf-8")
    return kept


def cached(asked: Key, work: Callable[[], Any], build: Path = BUILD) -> Any:
    """The kept answer. If there is none, the answer of ``work``, which is kept from now on."""
    found = read(asked, build)
    return write(asked, work(), build) if found is None else found


def place(asked: Key, build: Path = BUILD, suffix: str = ".json") -> Path:
    """The file for the answer of a key, in the store of a folder for results."""
    return store(build) / asked.kind / f"{asked.digest}{suffix}"


def store(build: Path = BUILD) -> Path:
    """The folder of the store."""
    named = os.environ.get(VARIABLE, "")
    if named and not Path(named).is_absolute():
        raise InputError(f"{VARIABLE}: got {named!r}, expected an absolute path")
    return Path(named) if named else build / "store"


def _as_text(part: Part) -> str:
    if isinstance(part, Path):
        return fingerprint([part])
    text = (
        str(part) if isinstance(part, (str, int)) else json.dumps([_as_text(one) for one in part])
    )
    short = len(text) <= LONGEST and text.isprintable()
    return text if short else hashlib.sha256(text.encode()).hexdigest()


def _sum(answer: Any) -> str:
    return hashlib.sha256(json.dumps(answer, sort_keys=True).encode()).hexdigest()
