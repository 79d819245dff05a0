"""The latencies that the hardware publishes, as the tables read them.

The twins model values, not clocks, and this room does not import the hardware. So
``python -m hdl.latencies`` writes what it publishes to a file, and a test compares the two.
"""

from __future__ import annotations

import csv

from golden.fingerprint import ROOT

FILE = ROOT / "golden" / "data" / "latencies.csv"


def latencies(kind: str) -> dict[tuple[str, str], int]:
    """Clocks by name and precision of every ``activation``, or of every ``scene``."""
    with FILE.open(newline="", encoding="utf-8") as handle:
        return {
            (row["name"], row["precision"]): int(row["clocks"])
            for row in csv.DictReader(handle)
            if row["kind"] == kind
        }
