"""The tables of ``make figures`` for the report, which are recorded, kept or measured."""

from __future__ import annotations

import time
from collections.abc import Collection
from functools import partial
from pathlib import Path
from typing import Any

from joblib import Parallel, delayed

from golden.fingerprint import ROOT, fingerprint, sources
from tb.report.measure import table_records
from tb.report.measure.registry import TABLES
from tb.report.measure.store import Progress, keep, kept, once, packed, unpacked
from tb.report.measure.table import Table


def measuring(*rooms: str) -> list[Path]:
    """The sources of some rooms, except those that only draw or write the report."""
    return [path for path in sources(*rooms) if path.parent.name not in ("draw", "page")]


def measured(tell: Progress, names: Collection[str] = tuple(TABLES)) -> dict[str, Table]:
    """The tables of these names. Tables without run times are measured in parallel."""
    state = fingerprint(
        [*measuring("golden", "tb/report"), ROOT / "golden" / "data"], str(table_records.SEED)
    )
    # Tables with run times are measured alone.
    together = [n for n in names if n not in table_records.TIMED and kept(n, state) is None]
    answers: dict[str, Any] = {}
    if together:
        pool = Parallel(n_jobs=-1, return_as="generator_unordered")
        for name, answer, seconds in pool(delayed(_timed)(name) for name in together):
            keep(name, state, answer)
            tell(name, seconds, False)
            answers[name] = answer
    for name in names:
        if name not in answers:
            answers[name] = once(name, state, tell, partial(_measure, name))
    return {name: unpacked(answers[name]) for name in names}


def _measure(name: str) -> dict[str, Any]:
    table = (
        table_records.read(name)
        if name in table_records.RECORDED
        else TABLES[name](table_records.SEED)
    )
    return packed(table)


def _timed(name: str) -> tuple[str, dict[str, Any], float]:
    started = time.perf_counter()
    return name, _measure(name), time.perf_counter() - started
