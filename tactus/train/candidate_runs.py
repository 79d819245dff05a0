"""Measures the candidates of a training on several processors."""

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeVar

from joblib import Parallel, delayed

from tactus.core.files import reading, writing
from tactus.train.descent.search import Result
from tactus.train.descent.task import Task

T = TypeVar("T")
R = TypeVar("R", bound=Result)


def in_order(
    measured: Callable[..., T], task: Task, candidates: Iterable[tuple[Any, ...]], workers: int
) -> Iterator[T]:
    """The results of all candidates, in order, each as soon as it is known.

    measured: Trains and measures one candidate of a task.
    candidates: What ``measured`` gets beside the task.
    workers: The number of processes; -1 for one on each core.
    """
    jobs = (delayed(measured)(task, *candidate) for candidate in candidates)
    yield from Parallel(n_jobs=workers, return_as="generator")(jobs)


def continued(
    measured: Callable[..., R],
    kind: type[R],
    task: Task,
    candidates: Sequence[tuple[Any, ...]],
    record: Path,
    workers: int,
) -> Iterator[R]:
    """The results of all candidates, as ``in_order``, of a search that can be interrupted.

    kind: What ``measured`` returns.
    record: A line for each result, in the order of the candidates. Those that an earlier search has
        left are not computed again.
    """
    known = list(_read(record, kind))
    yield from known
    with writing(record):
        record.parent.mkdir(parents=True, exist_ok=True)
        lines = [json.dumps(asdict(result)) + "\n" for result in known]
        # An earlier search may have been interrupted within a line.
        record.write_text("".join(lines), encoding="utf-8")
    for result in in_order(measured, task, candidates[len(known) :], workers):
        with writing(record), record.open("a", encoding="utf-8") as handle:
            handle.write(json.dumps(asdict(result)) + "\n")
        yield result


def _read(record: Path, kind: type[R]) -> Iterator[R]:
    if not record.is_file():
        return
    with reading(record, "a record of candidates, which may be deleted"):
        for line in record.read_text(encoding="utf-8").split("\n")[:-1]:
            facts: dict[str, Any] = json.loads(line)
            found: dict[str, Any] = {
                name: tuple(value) if isinstance(value, list) else value
                for name, value in facts.items()
            }
            yield kind(**found)
