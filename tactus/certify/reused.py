"""What the library's records say of the entities of an export that are the same bytes."""

from typing import Any

from tactus.verify.benches.runner import Job
from tactus.verify.sign_off.record import recorded, short
from tactus.verify.sign_off.source import verilog
from tactus.verify.sign_off.subject import recorded_cases


def same_bytes(job: Job, kind: str) -> dict[str, Any] | None:
    """The record of a kind that was made of the same Verilog as an entity; None without one."""
    digest = short(verilog(job))
    for record in (recorded(kind, name) for name in recorded_cases(job.block)):
        for found in record.get("runs", [record]):
            if found.get("verilog") == digest:
                return dict(found)
    return None
