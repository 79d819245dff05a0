"""What a record is of: the Verilog of an entity, and what its bench played on it.

A bench is told by its trace and not by its text: what each test drove, in which clocks it looked at
which port, and how many results it compared. So a function that moves makes no record stale, and
another stimulus does. Whoever runs a bench compares its trace with the records
(``tb/sign_off/current.py``). What keeps results of benches has to know before they run, so it asks
for their code (``tb/common/kept.py``).
"""

from __future__ import annotations

from typing import Any

from hdl.synth.tools import digest
from tb.common.runner import Job

# In a record: all tests of the bench were played.
EVERY = "all"


def verilog(job: Job) -> str:
    """A digest of the code in the files of a job, whatever their comments say."""
    return digest(job.hdl_folder, sorted(job.files))


def source(job: Job, played: dict[str, str]) -> dict[str, Any]:
    """The fields of a record that tell what it is of.

    Parameters
    ----------
    job : Job
        The entity on its exported Verilog.
    played : dict of str
        By test: the digest of its trace, as the facts of an ``Outcome`` have it.
    """
    return {"verilog": verilog(job), "played": played}
