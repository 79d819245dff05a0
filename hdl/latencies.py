"""``python -m hdl.latencies``: writes the published latencies for the tables of ``make figures``.

Activations as ``make activations`` measures them, whole; networks of every shipped scene and of
those for comparison.
"""

from __future__ import annotations

import csv
import io
import sys

from golden.cli import run
from golden.files import replace_file
from hdl.common.lookup import latency
from tb.report.measure.activation_errors import THESIS_FACTOR, built, variants
from tb.report.measure.latency import FILE
from tb.report.measure.networks import scenes


def text() -> str:
    """The file: kind, name, precision, clocks."""
    rows = [("kind", "name", "precision", "clocks")]
    for name, options, scheme in variants():
        for precision in scheme.precisions:
            block = built(scheme, precision, THESIS_FACTOR if precision.normalise else 1)
            full = f"{name}, {options}" if options else name
            rows.append(("activation", full, precision.name, latency(block)))
    for scene in scenes():
        rows.append(("scene", scene.name, scene.precision.name, latency(scene.twin())))
    handle = io.StringIO()
    csv.writer(handle, lineterminator="\n").writerows(rows)
    return handle.getvalue()


def main() -> None:
    with replace_file(FILE) as temporary:
        temporary.write_text(text(), encoding="utf-8")
    print(f"wrote {FILE}")


if __name__ == "__main__":
    sys.exit(run(main))
