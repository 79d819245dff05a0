"""Measures the candidates of a training on several processors."""

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from joblib import Parallel, delayed

from tactus.core.files import reading, writing
from tactus.train.descent.search import Result
from tactus.train.descent.task import Task

# The fewest training rows, and at most as many validation rows, on which candidates are compared.
FIRST_ROWS = 1000

R = TypeVar("R", bound=Result)


def continued(
    measured: Callable[..., R],
    kind: type[R],
    task: Task,
    candidates: Sequence[tuple[Any, ...]],
    record: Path,
    workers: int,
) -> Iterator[R]:
    """The results of all candidates, in order, of a search that can be interrupted.

    measured: Trains and measures one candidate of a task, and returns a ``kind``.
    candidates: What it gets beside the task.
    record: A line for each result, in the order of the candidates. Those that an earlier search has
        left are not computed again.
    workers: The number of processes; -1 for one on each core.
    """
    known = list(_read(record, kind))
    yield from known
    with writing(record):
        record.parent.mkdir(parents=True, exist_ok=True)
        lines = [json.dumps(asdict(result)) + "\n" for result in known]
        # An earlier search may have been interrupted within a line.
        record.write_text("".join(lines), encoding="utf-8")
    jobs = (delayed(measured)(task, *candidate) for candidate in candidates[len(known) :])
    for result in Parallel(n_jobs=workers, return_as="generator")(jobs):
        with writing(record), record.open("a", encoding="utf-8") as handle:
            handle.write(json.dumps(asdict(result)) + "\n")
        yield result


def parts_of(task: Task) -> Iterator[Task]:
    """The task on random rows, each time on those before and as many more; the last has all.

    After each of them the worse half of the candidates is left out (K. Jamieson and A. Talwalkar,
    "Non-stochastic best arm identification and hyperparameter optimization", AISTATS 2016).
    """
    rng = np.random.default_rng([task.scene.training.seed, task.number])
    frames = {name: getattr(task, name) for name in ("training", "validation")}
    orders = {name: rng.permutation(len(part.inputs)) for name, part in frames.items()}
    rows = FIRST_ROWS
    while rows < len(task.training.inputs):
        yield replace(task, **{n: part.take(orders[n][:rows]) for n, part in frames.items()})
        rows *= 2
    yield task


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
