"""How every command ends: bad input prints one line and exits with 2, never with a traceback."""

import _posixsubprocess
import ctypes
import errno
import os
import shlex
import shutil
import signal
import sys
import threading
import traceback
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import Any

from golden.input_error import InputError

# Errors of a full or broken disk, in writing a file that the error may not name.
DISK = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EROFS}
# In the environment of a process whose output is the same on every run.
HASH_SEED = {"PYTHONHASHSEED": "0"}
# An option of the system's prctl: what loses its parent becomes a child of the calling process.
PR_SET_CHILD_SUBREAPER = 36
_FORK_EXEC = _posixsubprocess.fork_exec
# What is said after each signal that asks a command to end.
SAID = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated", signal.SIGHUP: "terminated"}
# Set when a command is asked to end: what its threads find from then on is not to be kept.
ENDING = threading.Event()
# Separates the complaints in one exception, so that each is printed as an error of its own.
BETWEEN = "\nerror: "
REPORT = (
    "This is a fault in tactus and not in what it was given. Please report the lines above, with "
    "the command and the files that it read, to those from whom you have tactus."
)


def whole(name: str, least: int, most: int) -> Callable[[str], int]:
    """A function for argparse that reads a whole number from a command's variable."""

    def number(text: str) -> int:
        with suppress(ValueError):
            if least <= int(text) <= most:
                return int(text)
        raise InputError(f"{name}={text}: expected a whole number, {least} to {most}")

    return number


def numbers(name: str, text: str, count: int, most: float) -> list[float]:
    """The numbers in a command's variable, from 0 to ``most``; none if it is empty."""
    if not text:
        return []
    with suppress(ValueError):
        found = [float(part) for part in text.split(",")]
        if len(found) == count and all(0 <= one <= most for one in found):
            return found
    wanted = "a number" if count == 1 else f"{count} numbers with a comma between"
    raise InputError(f"{name}={text}: expected {wanted}, each from 0 to {most:g}")


def words(name: str, text: str) -> list[str]:
    """The words in a command's variable that may hold several; quotes keep blanks together."""
    try:
        return shlex.split(text)
    except ValueError as error:
        raise InputError(f"{name}={text}: {error}") from None


def dry() -> bool:
    """Whether a command should only check what it was given, and do nothing: ``DRY=1``."""
    return os.environ.get("DRY", "") not in ("", "0")


def stop_if_dry_run(work: str) -> None:
    """End a command, which has checked all that it was given, here if ``DRY=1`` is set.

    work: What is printed that it would do now, such as "simulate 12 benches".
    """
    if dry():
        print(f"DRY=1: nothing done; would {work}")
        raise SystemExit(0)


def run(main: Callable[[], int | None]) -> int:
    """Run ``main`` and return its exit code; complaints about input go to stderr as one message.

    Warnings go there too, one line for each. A fault of this project keeps its traceback. A signal
    to end stops the processes that the command has started, and leaves no temporary files.
    """
    warnings.formatwarning = lambda message, *_, **__: f"warning: {message}\n"
    try:
        with _stopped_by_signals():
            code = main() or 0
            sys.stdout.flush()
            return code
    except BrokenPipeError:
        # The reader of the output, such as head, has read enough.
        _print_no_more()
        return 141
    except KeyboardInterrupt as stop:
        number = next((one for one in stop.args if one in SAID), signal.SIGINT)
        print(SAID[number], file=sys.stderr)
        return 128 + int(number)
    except Exception as error:
        if isinstance(error, OSError) and error.errno in DISK:
            place = error.filename or "what is printed, or a file"
            print(f"error: {place}: cannot be written: {error.strerror}", file=sys.stderr)
            _print_no_more()
            return 2
        if not isinstance(error, InputError):
            traceback.print_exc()
            print(f"\n{REPORT}", file=sys.stderr)
            return 1
        print(f"error: {error}", file=sys.stderr)
        return 2


@contextmanager
def _stopped_by_signals() -> Iterator[None]:
    """Let each signal that asks a command to end raise a KeyboardInterrupt that names it.

    So files are tidied up as after any error. The processes that the command has started are ended
    at once, because threads that wait for them would not see the exception.
    """
    ended: list[int] = []
    over = threading.Event()

    def stop(number: int, _: FrameType | None) -> None:
        # Make may pass on what the whole group of processes gets too.
        if not ended:
            ended.append(number)
            ENDING.set()
            # Once before anything else, so that no process sees what the exception undoes.
            end_descendants()
            threading.Thread(target=end_more, args=(over,), daemon=True).start()
            raise KeyboardInterrupt(number)

    # A signal that is ignored, such as after nohup, stays so.
    heard = [number for number in SAID if signal.getsignal(number) != signal.SIG_IGN]
    try:
        before = {number: signal.signal(number, stop) for number in heard}
    except ValueError:  # only the main thread gets signals
        yield
        return
    _posixsubprocess.fork_exec = _start_deaf
    try:
        yield
    finally:
        _posixsubprocess.fork_exec = _FORK_EXEC
        over.set()
        if ended:
            end_workers()
            ENDING.clear()
        for number, handler in before.items():
            signal.signal(number, handler)


def _start_deaf(*given: Any) -> int:
    """Start a worker of joblib, which ``stop`` ends, so that it does not notice Ctrl-C.

    It would print a traceback while it imports. The module ``subprocess`` has a name of its own for
    what this replaces.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        return _FORK_EXEC(*given)
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def end_descendants() -> None:
    """Ask all processes to end that this one has started, and those that these have started.

    A process that starts another one meanwhile may end before it, so this one takes its place as
    the parent, and looks again until it finds no more.
    """
    with suppress(AttributeError, OSError):  # Linux alone has it
        ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1)
    asked: set[int] = set()
    while new := set(descendants(os.getpid())) - asked:
        for process in new:
            with suppress(OSError):
                os.kill(process, signal.SIGTERM)
        asked |= new


def end_more(over: threading.Event) -> None:
    """End also the processes that threads still start, because a pool waits for its threads."""
    while not over.wait(0.1):
        end_descendants()


def descendants(process: int) -> list[int]:
    """The processes that a process has started, and that these have started; Linux alone tells."""
    started: dict[int, list[int]] = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        # A process may end before its file is read. Its name, in parentheses, may hold anything.
        with suppress(OSError, ValueError):
            _, parent, *_ = path.read_bytes().rpartition(b")")[2].split()
            started.setdefault(int(parent), []).append(int(path.parent.name))
    found = [process]
    for one in found:
        found += started.get(one, [])
    return found[1:]


def end_workers() -> None:
    """Let the workers of joblib, if it was used, release their semaphores and shared memory."""
    loky = sys.modules.get("joblib.externals.loky.reusable_executor")
    executor = getattr(loky, "_executor", None)
    if executor is not None:
        executor.shutdown(wait=True, kill_workers=True)
    if loky is not None:
        # What was just being made when the signal came is in nobody's list.
        memory, own = Path("/dev/shm"), os.getpid()
        for path in memory.glob(f"sem.loky-{own}-*"):
            path.unlink(missing_ok=True)
        for path in memory.glob(f"joblib_memmapping_folder_{own}_*"):
            shutil.rmtree(path, ignore_errors=True)


def _print_no_more() -> None:
    """Discard all further output, so that the interpreter does not complain at its end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
