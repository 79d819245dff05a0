"""Tables that train for long: the report and its tests take them as recorded.

    make figures TABLE=honest RECORD=1

measures one and records it. A record names the code and the data that it is of: of others it is
stale, which a test tells.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from golden import window
from golden.files import read_json, write_json
from golden.fingerprint import ROOT, fingerprint, sources
from golden.physics import swing_data
from golden.scene.reference import NUMBERS
from tb.report.measure import convergence, honest, past, store
from tb.report.measure.table import Table

# By name, where they stand and what they hang on beside what trains.
RECORDED = {
    "honest": (honest,),
    "robustness": (honest,),
    "past": (past, swing_data, window),
    "convergence": (convergence,),
}
FOLDER = Path(__file__).parent / "records"
SEED = 1


def state(name: str) -> str:
    """A digest of what a table's figures hang on: what trains, and what is trained on.

    The printed figures that others are compared with train nothing.
    """
    own = [Path(str(module.__file__)) for module in RECORDED[name]]
    data = sorted(path for path in (ROOT / "golden" / "data").iterdir() if path != NUMBERS)
    return fingerprint([*sources("golden/training"), *own, *data])


def read(name: str) -> Table:
    """What was recorded, whatever has changed since."""
    return store.unpacked(_found(name)["table"])


def is_stale(name: str) -> bool:
    """Whether it is of other code or other data."""
    return bool(_found(name)["state"] != state(name))


def write(table: Table) -> Path:
    """Record a table that was measured with SEED."""
    path = _path(table.name)
    write_json(path, {"state": state(table.name), "table": store.packed(table)})
    return path


def _path(name: str) -> Path:
    return FOLDER / f"{name}.json"


def _found(name: str) -> dict[str, Any]:
    found: dict[str, Any] = read_json(_path(name), "a recorded table; RECORD=1 records it")
    return found
