"""The source of a record: the Verilog of an entity, and what the bench played on it.

A bench is identified by its trace and not by its text. The trace says what each test drove, in
which clocks it looked at which port, and how many results it compared. So a function that moves
makes no record stale, but another stimulus does. Every run of a bench compares the trace with the
records (``tactus/verify/sign_off/current.py``). Kept results of benches must be found before the
bench runs, so their key holds the bench's code instead (``tactus/verify/benches/kept_results.py``).
"""

from typing import Any

from tactus.synth.tools import digest
from tactus.verify.benches.runner import Job

# This stands in a record if all tests of the bench were played.
EVERY = "all"


def verilog(job: Job) -> str:
    """A digest of the code in the files of a job, without their comments."""
    return digest(job.hdl_folder, sorted(job.files))


def source(job: Job, played: dict[str, str]) -> dict[str, Any]:
    """The fields of a record that say from which source it was made.

    job: The entity on its exported Verilog.
    played: For each test the digest of its trace, as in the facts of an ``Outcome``.
    """
    return {"verilog": verilog(job), "played": played}
