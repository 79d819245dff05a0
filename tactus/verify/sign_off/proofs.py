"""The properties of every block, which stand beside its bench as ``prove_<block>.py``."""

from importlib import import_module
from pathlib import Path
from typing import Any

from tactus.core.fingerprint import ROOT
from tactus.verify.benches.runner import Job
from tb.common.properties import Property

PROOFS = {
    path.stem.removeprefix("prove_"): import_module(f"tb.{path.parent.name}.{path.stem}")
    for path in sorted((ROOT / "tb").glob("*/prove_*.py"))
}


def properties_of(job: Job) -> list[Property]:
    """The properties to prove of an entity: the list that ``properties`` makes for its twin."""
    module: Any = PROOFS[job.block]
    found: list[Property] = module.properties(job.twin)
    return found


def proof_file(block: str) -> Path:
    """Where the properties of a block stand."""
    return Path(str(PROOFS[block].__file__))
