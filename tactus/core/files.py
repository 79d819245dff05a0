"""Reads files so that a fault names them, and writes them completely or not at all.

Files and folders get the permissions that the umask leaves, as if they were written in place.
"""

import errno
import json
import os
import secrets
import shutil
import stat
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

from golden.input_error import InputError, MissingFileError, suggest
from tactus.core.cli import DISK
from tactus.core.folders import refuse_installed


def check_file(path: Path, missing: str = "no such file") -> None:
    """Refuse a path that is no file: nothing, a folder, a device, or an impossible name."""
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        raise MissingFileError(f"{path}: {missing}") from None
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read: {_reason(error)}") from None
    if not stat.S_ISREG(mode):
        kind = "a folder" if stat.S_ISDIR(mode) else "no regular file"
        raise InputError(f"{path}: got {kind}, expected a file")


def named_file(kind: str, name: str, known: Mapping[str, Path], shown: Sequence[str]) -> Path:
    """The file of a name that is known, or that of a path that ends in ``.toml``.

    shown: The names that a message lists.
    """
    try:
        path = known[name] if name in known else Path(name).expanduser()
        if not (name in known or name.endswith(".toml")):
            raise FileNotFoundError
        check_file(path)
    except (FileNotFoundError, RuntimeError):
        raise MissingFileError(
            f"{kind} {name!r}: no such {kind}, expected a path to a .toml file or one of "
            f"{', '.join(shown)}{suggest(name, list(known))}"
        ) from None
    return path


def same_file(one: Path, other: Path) -> bool:
    """Whether two paths name one file, by links or by ``..`` in them, now or once it is written."""
    with suppress(OSError, ValueError):  # a NUL: no file has such a name
        return os.path.realpath(one) == os.path.realpath(other) or one.samefile(other)
    return False


@contextmanager
def reading(path: Path, form: str) -> Iterator[None]:
    """Surround one call that reads the file at ``path``; an error of it becomes a message.

    The block must contain nothing else, because every error in it is taken as a fault of the file.

    form: The expected contents of the file, such as "TOML".
    """
    try:
        yield
    except UnicodeDecodeError as error:
        got = error.object[error.start]
        raise InputError(
            f"{path}: got the byte 0x{got:02x} at {error.start}, expected UTF-8 text"
        ) from None
    except Exception as error:
        if isinstance(error, OSError) and error.errno:
            raise InputError(f"{path}: cannot be read:{_where(error, path)}") from None
        raise InputError(f"{path}: not {form}: {_reason(error)}") from None


def write_json(path: Path, facts: Any) -> None:
    """Record ``facts``, one on each line."""
    text = json.dumps(facts, ensure_ascii=False, allow_nan=False, indent=1)
    with replace_file(path) as temporary:
        temporary.write_text(text + "\n", encoding="utf-8")


@contextmanager
def writing(path: Path, through: Path | None = None) -> Iterator[None]:
    """Surround code that writes ``path``; an error of the machine becomes a message.

    through: The temporary file that is written instead. In this case only errors of this file and
        of the disk become messages, because the block may contain other work.
    """
    try:
        yield
    except OSError as error:
        named = Path(str(error.filename)) if error.filename else None
        if through and not (through in (named, *named.parents) if named else error.errno in DISK):
            raise
        raise InputError(f"{path}: cannot be written:{_where(error, path)}") from None
    except ValueError as error:  # a NUL in the name
        if through or "null" not in str(error):
            raise
        raise InputError(f"{path}: cannot be written: {_reason(error)}") from None


def _reason(error: Exception) -> str:
    """The first line of an error's text, or a text of our own if it has none."""
    if isinstance(error, RecursionError):
        return "nested too deep"
    if isinstance(error, MemoryError):
        return "asks for more memory than there is"
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    return (str(error).strip() or type(error).__name__).splitlines()[0]


def _where(error: OSError, path: Path) -> str:
    """An error's text, with the name of its file if that is not a temporary file of ``path``."""
    named = Path(str(error.filename)) if error.filename else path
    own = named == path or named.name.startswith(f".{path.name}.")
    return f"{'' if own else f' {named}:'} {_reason(error)}"


def _beside(path: Path) -> Path:
    """An unused name in the same folder."""
    refuse_installed(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    return path.with_name(f".{path.name}.{secrets.token_hex(8)}{path.suffix}")


def check_writable(paths: Sequence[Path]) -> None:
    """Refuse paths where no file can be written, before the work whose result goes there."""
    for path in paths:
        missing = [folder for folder in path.parents if not _exists(folder)]
        try:
            _refuse_other(path)
            with writing(path):
                temporary = _beside(path)
                temporary.touch(exist_ok=False)
                temporary.unlink()
        finally:
            for folder in missing:
                with suppress(OSError):
                    folder.rmdir()


def check_output(
    path: Path,
    read: Sequence[Path] = (),
    *,
    own: Callable[[Path], bool] = lambda there: False,
    force: bool = False,
    key: str = "TO",
) -> None:
    """Refuse a path at which a command must not write the file that a user names.

    read: Files that are never replaced, because the command or the scene reads them.
    own: Recognises a file that the same command wrote earlier, which may be replaced.
    force: Whether a file that ``own`` does not recognise may be replaced too.
    key: The variable that names the path.
    """
    if any(same_file(path, file) for file in read):
        raise InputError(f"{key}={path}: is read by this command, expected another file")
    check_folder(path, key)
    check_writable([path])
    if os.path.lexists(path) and not force and not own(path):
        raise InputError(
            f"{key}={path}: is there already, and make cannot tell that this command wrote it; "
            "choose another name, or FORCE=1 to replace it"
        )


def check_folder(path: Path, key: str = "TO") -> None:
    """Refuse a path whose folder is missing, because it may be misspelt."""
    if not os.path.lexists(path.parent):
        raise InputError(f"{key}={path}: got no folder {path.parent}, expected one that is there")


def first_line(path: Path) -> str:
    """The first line of a file; empty if it cannot be read."""
    with suppress(OSError), path.open(encoding="utf-8", errors="replace") as file:
        return file.readline().rstrip()
    return ""


def _exists(path: Path) -> bool:
    """Whether a path exists; also True for a name that cannot exist, which writing will report."""
    try:
        return path.exists()
    except (OSError, ValueError):
        return True


def _refuse_other(path: Path) -> None:
    """Refuse to replace anything but a file; for root, a rename would even replace a device."""
    with writing(path), suppress(FileNotFoundError, NotADirectoryError):
        mode = path.stat().st_mode
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, "got a folder, expected a file")
        if not stat.S_ISREG(mode):
            raise OSError(errno.EINVAL, "got no regular file, expected a file")


@contextmanager
def replace_file(path: Path) -> Iterator[Path]:
    """Yield a temporary path beside ``path``, and rename it to ``path`` if the block succeeds."""
    with replace_files([path]) as (temporary,):
        yield temporary


@contextmanager
def replace_files(paths: Sequence[Path]) -> Iterator[list[Path]]:
    """Yield a temporary path beside each path, and rename all or none when the block ends."""
    temporaries: list[Path] = []
    try:
        with ExitStack() as stack:
            for path in paths:
                _refuse_other(path)
                with writing(path):
                    temporary = _beside(path)
                    temporary.touch(exist_ok=False)
                temporaries.append(temporary)
                stack.enter_context(writing(path, through=temporary))
            yield temporaries
        _rename_all(temporaries, paths)
    finally:
        for temporary in temporaries:
            temporary.unlink(missing_ok=True)


def _rename_all(temporaries: Sequence[Path], paths: Sequence[Path]) -> None:
    """Rename all files; of a replaced file a copy stays until nothing can fail any more."""
    with ExitStack() as tidy, ExitStack() as undo:
        for temporary, path in zip(temporaries, paths, strict=True):
            with writing(path):
                if path is paths[-1]:
                    pass
                elif path.exists():
                    old = _beside(path)
                    tidy.callback(old.unlink, missing_ok=True)
                    shutil.copy2(path, old, follow_symlinks=False)
                    undo.callback(old.replace, path)
                else:
                    undo.callback(path.unlink, missing_ok=True)
                temporary.replace(path)
        undo.pop_all()


@contextmanager
def replace_folder(path: Path) -> Iterator[Path]:
    """Yield a temporary folder beside ``path``, and put it in place if the block succeeds."""
    with writing(path):
        if path.exists() and not path.is_dir():
            raise NotADirectoryError(errno.ENOTDIR, "got a file, expected a folder")
        temporary, old = _beside(path), _beside(path)
        temporary.mkdir()
    try:
        with writing(path, through=temporary):
            yield temporary
        with writing(path):
            if path.exists():
                path.replace(old)
            temporary.replace(path)
        shutil.rmtree(old, ignore_errors=True)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
