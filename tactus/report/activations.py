"""``python -m tactus.report.activations``: measures and draws how far activations are from tanh."""

import argparse
import sys
from pathlib import Path

from golden.activation.schemes import forms
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.files import replace_file
from tactus.core.folders import BUILD
from tactus.report.draw.activation_errors import plot, plot_file
from tactus.report.measure.activation_errors import measure, table, write


def main() -> None:
    parser = argparse.ArgumentParser(prog="make activations", description=__doc__)
    parser.add_argument("--build", type=Path, default=BUILD)
    arguments = parser.parse_args()
    folder = arguments.build / "activations"
    stop_if_dry_run(f"measure every activation and write its plot into {folder}")
    rows = measure()
    print("\n".join(table(rows)))
    write(rows, folder)
    for name, scheme in forms().items():
        with replace_file(folder / plot_file(name)) as path:
            path.write_text(plot(name, scheme), encoding="utf-8")
    print(f"\nwrote {folder}/errors.csv, errors.json and plots")


if __name__ == "__main__":
    sys.exit(run(main))
