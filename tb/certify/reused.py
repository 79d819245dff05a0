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


def sentence(job: Job) -> str:
    """What is known of an entity by its digest, in words."""
    parts = []
    mutation = same_bytes(job, "mutation")
    if mutation:
        parts.append(
            f"score {100 * mutation['score']:.1f} % of {mutation['mutants']} mutants in the "
            "library's bench"
        )
    coverage = same_bytes(job, "coverage")
    if coverage:
        parts.append("its bench reaches every border and state")
    if same_bytes(job, "unknown"):
        parts.append("bench passed with unknown registers")
    if not parts:
        return "new: no record has these bytes"
    return f"{'; '.join(parts)} (Verilog {verilog(job)[:12]})"
