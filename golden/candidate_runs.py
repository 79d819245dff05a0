"""Measures the candidates of a training on several processors."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeVar

from joblib import Parallel, delayed

from golden.training.task import Task

T = TypeVar("T")


def in_order(
    measured: Callable[..., T], task: Task, candidates: Iterable[tuple[Any, ...]], workers: int
) -> Iterator[T]:
    """The results of all candidates, in order, each as soon as it is known.

    Parameters
    ----------
    measured : callable
        Trains and measures one candidate of a task.
    task : Task
    candidates : iterable of tuples
        What ``measured`` gets beside the task.
    workers : int
        The number of processes; -1 for one on each core.
    """
    jobs = (delayed(measured)(task, *candidate) for candidate in candidates)
    yield from Parallel(n_jobs=workers, return_as="generator")(jobs)
