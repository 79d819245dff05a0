"""The tables of ``make figures`` for the report, which are recorded, kept or measured."""

import time
from collections.abc import Collection
from functools import partial
from typing import Any

from joblib import Parallel, delayed

from tactus.core import store
from tactus.report.measure import table_records
from tactus.report.measure.registry import TABLES
from tactus.report.measure.store import Progress, cached, packed, part_key, unpacked
from tactus.report.measure.table import Table


def measured(tell: Progress, names: Collection[str] = tuple(TABLES)) -> dict[str, Table]:
    """The tables of these names. Tables without run times are measured in parallel."""
    found = {name: table_records.read(name) for name in names if name in table_records.RECORDED}
    for name in found:
        tell(name, 0.0, True)
    asked = {name: table_key(name) for name in names if name not in found}
    # Tables with run times are measured alone.
    together = [n for n in asked if n not in table_records.TIMED and store.read(asked[n]) is None]
    if together:
        pool = Parallel(n_jobs=-1, return_as="generator_unordered")
        for name, answer, seconds in pool(delayed(_timed)(name) for name in together):
            found[name] = unpacked(store.write(asked[name], answer))
            tell(name, seconds, False)
    for name in asked:
        if name not in found:
            found[name] = unpacked(cached(asked[name], tell, partial(_measure, name)))
    return {name: found[name] for name in names}


def table_key(name: str) -> store.Key:
    """What a table hangs on: the code that measures it."""
    return part_key(name, [TABLES[name].__module__], seed=table_records.SEED)


def _measure(name: str) -> dict[str, Any]:
    return packed(TABLES[name](table_records.SEED))


def _timed(name: str) -> tuple[str, dict[str, Any], float]:
    started = time.perf_counter()
    return name, _measure(name), time.perf_counter() - started
