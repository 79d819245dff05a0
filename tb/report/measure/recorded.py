"""Tables that are recorded: those that train for long, and those that pages show.

    make figures TABLE=honest RECORD=1

measures one and records it. A record names the code and the data that it is of: of others it is
stale, which a test tells. What trains for long the report and its tests take as recorded.
``stability`` is quick, and recorded since another processor has other last bits, and its page shows
every figure: test_stability.py measures it anew. What is recorded for pages holds the run times of
one machine, which the record names; a test compares the rest of each table with what is measured.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from golden import window
from golden.closure import code_of
from golden.files import read_json, write_json
from golden.fingerprint import ROOT, fingerprint, sources
from golden.input_error import InputError
from golden.machine import facts
from golden.physics import swing_data
from golden.rig import sensors_needed, smooth_map, trained_on
from golden.scene.reference import NUMBERS
from tb.report.measure import convergence, honest, outside, past, sensors_dropped, stability, store
from tb.report.measure.table import Table

# By name, where they stand and what they hang on beside what trains.
RECORDED = {
    "honest": (honest,),
    "robustness": (honest,),
    "past": (past, swing_data, window),
    "convergence": (convergence,),
    "sensors_dropped": (sensors_dropped, sensors_needed),
    "hidden_nodes": (sensors_dropped, sensors_needed),
    "outside": (outside, honest, smooth_map, trained_on),
    "stability": (stability,),
}
# With run times in every report.
TIMED = ("series", "plate", "swing", "swing_damping", "training")
FOR_PAGES = (*TIMED, "iterations", "simulators")
FOLDER = Path(__file__).parent / "records"
SEED = 1


def state(name: str) -> str:
    """A digest of what a table's figures hang on: what trains, and what is trained on.

    Comments, docstrings and imports are no part of it. The printed figures that others are
    compared with train nothing.
    """
    own = [file for module in RECORDED[name] for file in _files(Path(str(module.__file__)))]
    data = sorted(path for path in (ROOT / "golden" / "data").iterdir() if path != NUMBERS)
    code = map(code_of, [*sources("golden/training"), *own])
    return fingerprint(data, *code)


def read(name: str) -> Table:
    """What was recorded, whatever has changed since."""
    return store.unpacked(_found(name)["table"])


def is_stale(name: str) -> bool:
    """Whether it is of other code or other data."""
    return bool(_found(name)["state"] != state(name))


def write(table: Table) -> Path:
    """Record a table that was measured with SEED."""
    path = _path(table.name)
    known = {"machine": facts()} if table.name in FOR_PAGES else {"state": state(table.name)}
    write_json(path, {**known, "table": store.packed(table)})
    return path


def machine() -> str:
    """The processor on which every table for pages was recorded.

    Raises
    ------
    InputError
        When they are of several: record all of them on one.
    """
    found = {_found(name)["machine"]["processor"] for name in FOR_PAGES}
    if len(found) > 1:
        raise InputError(f"tables for pages: got {sorted(found)}, expected one processor")
    return str(found.pop())


def _files(module: Path) -> list[Path]:
    """A module's file; of a package all of them."""
    return sorted(module.parent.glob("*.py")) if module.name == "__init__.py" else [module]


def _path(name: str) -> Path:
    return FOLDER / f"{name}.json"


def _found(name: str) -> dict[str, Any]:
    found: dict[str, Any] = read_json(_path(name), "a recorded table; RECORD=1 records it")
    return found
