"""``python -m tactus.report.activations``: measures and draws how far activations are from tanh."""

import sys

from golden.activation.schemes import forms
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.files import replace_file
from tactus.report.draw.activation_errors import plot, plot_file
from tactus.report.measure.activation_errors import measure, table, write


def main() -> None:
    arguments = arguments_of("activations", __doc__)
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
