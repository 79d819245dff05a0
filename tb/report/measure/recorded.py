"""Tables that train for long: the report and its tests take them as recorded.

    make figures TABLE=honest RECORD=1

measures one and records it. A record names the code and the data that it is of: of others it is
stale, which a test tells. ``stability`` is quick, and recorded since another processor has other
last bits, and its page shows every figure: test_stability.py measures it anew.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from golden import window
from golden.files import read_json, write_json
from golden.fingerprint import ROOT, fingerprint, sources
from golden.physics import swing_data
from golden.rig import sensors_needed
from tb.report.measure import honest, past, sensors_dropped, stability, store
from tb.report.measure.table import Table

# By name, where they stand and what they hang on beside what trains.
RECORDED = {
    "honest": (honest,),
    "robustness": (honest,),
    "past": (past, swing_data, window),
    "sensors_dropped": (sensors_dropped, sensors_needed),
    "hidden_nodes": (sensors_dropped, sensors_needed),
    "stability": (stability,),
}
FOLDER = Path(__file__).parent / "records"
SEED = 1


def state(name: str) -> str:
    """A digest of what a table's figures hang on: what trains, and what is trained on."""
    own = [file for module in RECORDED[name] for file in _files(Path(str(module.__file__)))]
    return fingerprint([*sources("golden/training"), *own, ROOT / "golden" / "data"])


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


def _files(module: Path) -> list[Path]:
    """A module's file; of a package all of them."""
    return sorted(module.parent.glob("*.py")) if module.name == "__init__.py" else [module]


def _path(name: str) -> Path:
    return FOLDER / f"{name}.json"


def _found(name: str) -> dict[str, Any]:
    found: dict[str, Any] = read_json(_path(name), "a recorded table; RECORD=1 records it")
    return found
