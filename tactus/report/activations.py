"""``python -m tactus.report.activations``: measures and draws how far activations are from tanh."""

import sys

import numpy as np
from matplotlib.figure import Figure

from golden.activation.scheme import Scheme
from golden.activation.schemes import forms
from golden.numbers.precision import EXACT, THESIS
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.files import replace_file, write_json
from tactus.core.machine import versions
from tactus.report.draw.svg import svg
from tactus.report.measure.activation_errors import activation_table, built


def plot_file(name: str) -> str:
    """The file name of the plot of a form."""
    return f"{name.replace(' ', '_')}.svg"


def plot(name: str, scheme: Scheme) -> str:
    """The error over q as SVG, the same text on every run.

    All schemes are odd, so q starts at 0. In ``thesis`` precision Q is 8: the steps of q are
    2**-10, and q reaches beyond the end of every scheme.
    """
    figure = Figure(figsize=(7, 2.6), layout="constrained")
    axes = figure.add_subplot()
    for precision, factor, step, colour in (
        (THESIS, 8, 4, "tab:orange"),
        (EXACT, 1, 64, "tab:blue"),
    ):
        if precision not in scheme.precisions:
            continue
        codes = np.arange(0, 5 * (1 << precision.hidden_fmt.frac) // factor + 1, step)
        block = built(scheme, precision, factor)
        q = factor * block.real_input(codes)
        results = block.real_result(block.process(codes))
        label = f"{precision.name}, Q = {factor}" if precision.normalise else precision.name
        axes.plot(q, 8192 * (results - np.tanh(q)), label=label, color=colour, linewidth=0.9)
    axes.set_xlabel("q")
    axes.set_ylabel("error in $2^{-13}$")
    axes.set_xlim(0, 5)
    axes.grid(linewidth=0.3)
    axes.legend(title=name, fontsize="small", title_fontsize="small")
    return svg(figure, name.replace(" ", "_"), f"The error of {name} against q")


def main() -> None:
    arguments = arguments_of("activations", __doc__)
    folder = arguments.build / "activations"
    stop_if_dry_run(f"measure every activation and write its plot into {folder}")
    table = activation_table()
    print("\n".join(table.lines()))
    with replace_file(folder / "errors.csv") as path:
        table.write_csv(path)
    data = {"versions": versions("python", "numpy", "matplotlib"), **table.as_data()}
    write_json(folder / "errors.json", data)
    for name, scheme in forms().items():
        with replace_file(folder / plot_file(name)) as path:
            path.write_text(plot(name, scheme), encoding="utf-8")
    print(f"\nwrote {folder}/errors.csv, errors.json and plots")


if __name__ == "__main__":
    sys.exit(run(main))
