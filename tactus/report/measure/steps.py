"""The tables of ``make figures`` for the report, which are kept or measured."""

import time
from collections.abc import Collection
from typing import Any

from joblib import Parallel, delayed

from tactus.core import store
from tactus.report.measure.registry import TABLES
from tactus.report.measure.store import Progress, packed, part_key, unpacked
from tactus.report.measure.table import SEED, Table


def measured(tell: Progress, names: Collection[str] = tuple(TABLES)) -> dict[str, Table]:
    """The tables of these names, those that are not kept measured in parallel."""
    asked = {name: table_key(name) for name in names}
    answers = {name: store.read(key) for name, key in asked.items()}
    pool = Parallel(n_jobs=-1, return_as="generator_unordered")
    missing = [name for name, answer in answers.items() if answer is None]
    for name in set(names) - set(missing):
        tell(name, 0.0, True)
    for name, answer, seconds in pool(delayed(_timed)(name) for name in missing):
        answers[name] = store.write(asked[name], answer)
        tell(name, seconds, False)
    return {name: unpacked(answers[name]) for name in names}


def table_key(name: str) -> store.Key:
    """What a table hangs on: the code that measures it."""
    return part_key(name, [TABLES[name].__module__], seed=SEED)


def _timed(name: str) -> tuple[str, dict[str, Any], float]:
    started = time.perf_counter()
    return name, packed(TABLES[name](SEED)), time.perf_counter() - started
