"""What the library's records say of the entities of an export that are the same bytes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from tb.common.runner import Job
from tb.sign_off.record import read_record, record_path
from tb.sign_off.source import verilog
from tb.sign_off.subject import recorded_cases


def same_bytes(job: Job, kind: str) -> dict[str, Any] | None:
    """The record of a kind that was made of the same Verilog as an entity; None without one."""
    digest = verilog(job)
    for record in _records(job.block, kind):
        for found in record.get("runs", [record]):
            if found.get("verilog") == digest:
                return dict(found)
    return None


def _records(block: str, kind: str) -> Iterator[dict[str, Any]]:
    for name in recorded_cases(block):
        if record_path(kind, name).exists():
            yield read_record(kind, name)
