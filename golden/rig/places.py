"""Whether a file can be written, before the work whose result it is to hold."""

from __future__ import annotations

import secrets
import shutil
from contextlib import suppress
from pathlib import Path

# Networks and their exports are some hundred kilobytes.
LEAST_FREE = 4_000_000


def refusal(path: Path) -> str:
    """What keeps a file from being written at ``path``; empty where nothing does.

    It is tried with a file beside it, as ``golden.files`` writes; nothing of it stays. Folders on
    the way that are not there yet can be made.
    """
    made: list[Path] = []
    beside = path.with_name(f".{path.name}.{secrets.token_hex(8)}{path.suffix}")
    try:
        if path.is_dir():
            return "is a folder, expected a file or nothing"
        missing = [folder for folder in path.parents if not folder.exists()]
        for folder in reversed(missing):
            folder.mkdir()
            made.append(folder)
        beside.touch(exist_ok=False)
        beside.unlink()
        free = shutil.disk_usage(path.parent).free
        if free < LEAST_FREE:
            return f"got {free} bytes free on its disk, expected {LEAST_FREE} or more"
    except OSError as error:
        return f"cannot be written: {error.strerror}"
    except ValueError as error:
        return f"cannot be written: {error}"
    finally:
        for folder in reversed(made):
            with suppress(OSError):
                folder.rmdir()
    return ""
