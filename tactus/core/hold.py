"""Lets one command at a time work in the folder of a scene's results; others wait for it.

Two commands on one scene, or on scenes of one name in different folders, would otherwise replace
the exported files and the builds of each other's benches.
"""

import fcntl
import os
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from tactus.core.progress import stage

# In the environment of a command: the folders that the commands which called it hold for it.
VARIABLE = "TACTUS_HELD"


@contextmanager
def held(folders: Iterable[Path]) -> Iterator[None]:
    """Hold folders for this command and for those that it calls, as long as the block runs.

    If another command holds one of them, say so, and wait for its end.
    """
    before = os.environ.get(VARIABLE, "")
    ours = set(filter(None, before.split(os.pathsep)))
    wanted = {os.path.realpath(folder) for folder in folders} - ours
    with ExitStack() as stack:
        # Everybody takes them in the same order, so that no two commands wait for each other.
        for folder in sorted(wanted):
            stack.enter_context(_locked(Path(folder)))
        os.environ[VARIABLE] = os.pathsep.join([*ours, *wanted])
        try:
            yield
        finally:
            os.environ[VARIABLE] = before


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    number = -1
    try:
        # A command that cannot write there says so itself, and some file systems have no locks.
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            number = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
            try:
                fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                with stage(f"{folder}: waiting for another command, which works there"):
                    fcntl.flock(number, fcntl.LOCK_EX)
        yield
    finally:
        if number >= 0:
            os.close(number)
