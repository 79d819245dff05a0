"""The tables that are recorded: those that need long trainings, and those that pages show.

    make figures TABLE=honest RECORD=1

measures one table and records it. A record of trained networks names a digest of the code and data
that it came from. If these have changed since, the record is stale, and a test says so. The report
and its tests show such tables as they were recorded, because they take long to measure. The note of
such a table is not recorded: it is the text in ``NOTES`` of the module that measures the table. So
the words of a note can change without a new measurement.

``stability`` is measured quickly. It is recorded because its page shows every figure, and another
processor rounds last bits differently; test_stability.py measures the table anew. The tables for
pages hold the run times of one machine, which the record names. A test compares all their other
columns with what it measures.
"""

from pathlib import Path
from typing import Any

from golden.input_error import InputError
from golden.trained import window
from tactus.core.closure import code_of
from tactus.core.files import read_json, write_json
from tactus.core.fingerprint import ROOT, fingerprint, sources
from tactus.core.machine import facts
from tactus.physics import swing_data
from tactus.report.measure import (
    convergence,
    honest,
    outside,
    past,
    sensors_dropped,
    sensors_shipped,
    stability,
    store,
)
from tactus.report.measure.table import Table
from tactus.rig import sensors_needed, smooth_map, trained_on
from tactus.scene.reference import NUMBERS

# By name of the table: the modules that its figures depend on, besides those of training. The first
# one measures the table, and has its note.
RECORDED = {
    "honest": (honest,),
    "robustness": (honest,),
    "past": (past, swing_data, window),
    "convergence": (convergence,),
    "sensors_dropped": (sensors_dropped, sensors_needed),
    "sensors_shipped": (sensors_shipped,),
    "hidden_nodes": (sensors_dropped, sensors_needed),
    "outside": (outside, honest, smooth_map, trained_on),
    "stability": (stability,),
}
# These are measured for every report, since they hold run times.
TIMED = ("series", "plate", "swing", "swing_damping", "training")
FOR_PAGES = (*TIMED, "iterations", "simulators")
FOLDER = Path(__file__).parent / "records"
SEED = 1
# The constants that say something about a table and do not enter its figures.
NOT_MEASURED = ("NOTES",)


def state(name: str) -> str:
    """A digest of what a table's figures depend on: the code that trains, and the data.

    Comments, docstrings, imports and notes do not enter it. Neither do the figures that the thesis
    prints, because nothing is trained on them.
    """
    own = [file for module in RECORDED[name] for file in _files(Path(str(module.__file__)))]
    data = sorted(path for path in (ROOT / "scenes" / "data").iterdir() if path != NUMBERS)
    code = (code_of(file, NOT_MEASURED) for file in [*sources("tactus/train/descent"), *own])
    return fingerprint(data, *code)


def read(name: str) -> Table:
    """The recorded table, whether or not it is stale."""
    found = _found(name)["table"]
    if name in RECORDED:
        found = {**found, "note": RECORDED[name][0].NOTES[name]}
    return store.unpacked(found)


def is_stale(name: str) -> bool:
    """Whether the code or the data has changed since the table was recorded."""
    return bool(_found(name)["state"] != state(name))


def write(table: Table) -> Path:
    """Record a table that was measured with SEED."""
    path = _path(table.name)
    found = store.packed(table)
    if table.name in FOR_PAGES:
        write_json(path, {"machine": facts(), "table": found})
    else:
        del found["note"]
        write_json(path, {"state": state(table.name), "table": found})
    return path


def machine() -> str:
    """The processor on which every table for pages was recorded."""
    found = {_found(name)["machine"]["processor"] for name in FOR_PAGES}
    if len(found) > 1:
        raise InputError(f"tables for pages: got {sorted(found)}, expected one processor")
    return str(found.pop())


def _files(module: Path) -> list[Path]:
    """The file of a module, or all files of a package."""
    return sorted(module.parent.glob("*.py")) if module.name == "__init__.py" else [module]


def _path(name: str) -> Path:
    return FOLDER / f"{name}.json"


def _found(name: str) -> dict[str, Any]:
    found: dict[str, Any] = read_json(_path(name), "a recorded table; RECORD=1 records it")
    return found
