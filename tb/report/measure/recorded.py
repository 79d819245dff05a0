"""Tables that train for minutes of processor time: the report and its tests take them as recorded.

    make figures TABLE=honest RECORD=1

measures one and records it. A record names the code and the data that it is of: of others it is
stale, which a test tells.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from golden.files import read_json, write_json
from golden.fingerprint import ROOT, fingerprint, sources
from tb.report.measure import honest, store
from tb.report.measure.table import Table

RECORDED = ("honest", "robustness")
FOLDER = Path(__file__).parent / "records"
SEED = 1


def state() -> str:
    """A digest of what these figures hang on: what trains, and what is trained on."""
    files = [*sources("golden/training"), Path(honest.__file__), ROOT / "golden" / "data"]
    return fingerprint(files)


def read(name: str) -> Table:
    """What was recorded, whatever has changed since."""
    return store.unpacked(_found(name)["table"])


def is_stale(name: str) -> bool:
    """Whether it is of other code or other data."""
    return bool(_found(name)["state"] != state())


def write(table: Table) -> Path:
    """Record a table that was measured with SEED."""
    path = _path(table.name)
    write_json(path, {"state": state(), "table": store.packed(table)})
    return path


def _path(name: str) -> Path:
    return FOLDER / f"{name}.json"


def _found(name: str) -> dict[str, Any]:
    found: dict[str, Any] = read_json(_path(name), "a recorded table; RECORD=1 records it")
    return found
