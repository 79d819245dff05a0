"""``python -m tactus.report.measure.activation_errors``: how far every activation is from tanh.

The question is how large the error of each scheme is, and how much its arithmetic adds. Every input
code is measured in each precision of the scheme, in ``thesis`` precision for several Q, and the
same inputs in floating point. The reference is numpy's tanh. The figures that the thesis prints
stand beside the results.
"""

import argparse
import csv
import sys
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from golden.activation.activation_block import ActivationBlock
from golden.activation.pade import UnsettledWarning
from golden.activation.scheme import Scheme
from golden.activation.schemes import forms
from golden.numbers.precision import EXACT, THESIS, Precision
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.files import replace_file, write_json
from tactus.core.folders import BUILD
from tactus.core.machine import versions
from tactus.scene import thesis_table
from tactus.scene.metrics import ACTIVATION_RANGE, activation_error

FACTORS = (1, 3, 8, 32, 128, 512)
THESIS_FACTOR = 3
# The options with which the thesis measured, if they are not the default. It does not print its
# number of iterations.
THESIS_OPTIONS: dict[str, dict[str, Any]] = {"pade": {"rho": 4.0, "iterations": 24}}


@dataclass(frozen=True)
class Row:
    """The errors of one scheme in one arithmetic with one Q.

    scheme, options, arithmetic: ``arithmetic`` is "float" or the name of a precision.
    factor: Q.
    mean_percent, mean_percent_thesis: Equation 4.32 in both readings, see ``ActivationError``. None
        if the codes do not cover its range.
    largest: The largest error over all codes, in units of 2**-13.
    thesis: The figure that the thesis prints for equation 4.32, at Q = 3.
    """

    scheme: str
    options: str
    arithmetic: str
    factor: int
    mean_percent: float | None
    mean_percent_thesis: float | None
    largest: float
    thesis: float | None


def thesis_figure(name: str) -> float | None:
    """The mean error that the thesis prints for a scheme, or None for a scheme of our own."""
    figure = thesis_table(f"activation.{name.removesuffix('_parallel')}").get("mean_percent_error")
    return None if figure is None else float(figure)


def variants() -> Iterator[tuple[str, str, Scheme]]:
    """Every form of every scheme and, if they differ, the one with the options of the thesis."""
    for name, scheme in forms().items():
        yield name, "", scheme
        if name in THESIS_OPTIONS:
            text = ", ".join(f"{key} = {value:g}" for key, value in THESIS_OPTIONS[name].items())
            yield name, text, scheme.configured(THESIS_OPTIONS[name])


def built(scheme: Scheme, precision: Precision, factor: int) -> ActivationBlock:
    """The whole block, without a warning that it is not settled, as that is measured here."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnsettledWarning)
        return scheme.build(precision, factor, precision.hidden_fmt.high)


def measure() -> list[Row]:
    """All rows, one scheme after the other."""
    return [row for variant in variants() for row in measured(*variant)]


def measured(
    name: str, options: str, scheme: Scheme, factors: Sequence[int] = FACTORS
) -> Iterator[Row]:
    """The rows of one scheme in its precisions, for each Q if it is normalised."""
    for precision in scheme.precisions:
        codes = np.arange(precision.hidden_fmt.low, precision.hidden_fmt.high + 1)
        for factor in factors if precision.normalise else (1,):
            block = built(scheme, precision, factor)
            q = factor * block.real_input(codes)
            results = {precision.name: block.real_result(block.process(codes))}
            if precision.normalise:
                results = {"float": scheme.real(q)[0], **results}
            for arithmetic, values in results.items():
                yield _row(name, options, arithmetic, factor, q, values)


def _row(
    name: str,
    options: str,
    arithmetic: str,
    factor: int,
    q: NDArray[np.float64],
    values: NDArray[np.float64],
) -> Row:
    errors = values - np.tanh(q)
    measured = activation_error(errors, q) if np.abs(q).max() >= ACTIVATION_RANGE else None
    compared = arithmetic != "exact" and factor == THESIS_FACTOR
    return Row(
        name,
        options,
        arithmetic,
        factor,
        measured.mean_percent if measured else None,
        measured.mean_percent_thesis if measured else None,
        8192 * float(np.abs(errors).max()),
        thesis_figure(name) if compared else None,
    )


def table(rows: list[Row]) -> list[str]:
    """The printed lines, one for each scheme and arithmetic."""
    lines = [
        "equation 4.32 in % at Q = 3, and the largest error in units of 2**-13",
        "",
        f"{'':37}{'mean, as':>9}{'mean':>7}{'':8}  largest error at Q =",
        f"{'scheme':<19}{'options':<9}{'':9}{'printed':>9}{'x 2':>7}{'thesis':>8}"
        + "".join(f"{factor:>8}" for factor in FACTORS),
    ]
    groups: dict[tuple[str, str, str], dict[int, Row]] = {}
    for row in rows:
        groups.setdefault((row.scheme, row.options, row.arithmetic), {})[row.factor] = row
    for (scheme, options, arithmetic), by_factor in groups.items():
        chosen = by_factor.get(THESIS_FACTOR, next(iter(by_factor.values())))
        means = "".join(
            f"{'':{width}}" if value is None else f"{value:>{width}.{digits}f}"
            for value, width, digits in (
                (chosen.mean_percent, 9, 3),
                (chosen.mean_percent_thesis, 7, 3),
                (chosen.thesis, 8, 2),
            )
        )
        marked = "as thesis" if options else ""
        largest = "".join(
            f"{by_factor[f].largest:>8.1f}" if f in by_factor else f"{'':8}" for f in FACTORS
        )
        lines.append(f"{scheme:<19}{marked:<10}{arithmetic:<8}{means}{largest}".rstrip())
    lines += [
        "",
        "exact precision has no Q: its largest error is over every code of Fix(18,14), |q| to 8",
    ]
    lines += [f"as thesis: {name} with {text}" for name, text, _ in variants() if text]
    return lines


def write(rows: list[Row], folder: Path) -> None:
    """Write ``errors.csv`` and ``errors.json`` into ``folder``."""
    records = [asdict(row) for row in rows]
    with (
        replace_file(folder / "errors.csv") as path,
        path.open("w", newline="", encoding="utf-8") as handle,
    ):
        writer = csv.DictWriter(handle, list(records[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(records)
    data = {"versions": versions("python", "numpy", "matplotlib"), "rows": records}
    write_json(folder / "errors.json", data)


def plot_file(name: str) -> str:
    """The file name of the plot of a form."""
    return f"{name.replace(' ', '_')}.svg"


def plot(name: str, scheme: Scheme) -> str:
    """The error over q as SVG, the same text on every run.

    All schemes are odd, so q starts at 0. In ``thesis`` precision Q is 8: the steps of q are
    2**-10, and q reaches beyond the end of every scheme.
    """
    # It is imported only here, because every command that measures imports this module.
    import matplotlib
    from matplotlib.figure import Figure

    # Without a salt, the ids in the file would be random.
    with matplotlib.rc_context({"svg.hashsalt": "tactus", "svg.fonttype": "none"}):
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
        written = StringIO()
        figure.savefig(written, format="svg", metadata={"Date": None, "Creator": None})
    # What stands before would not be HTML, and pages hold the picture as it is.
    return written.getvalue().partition("<!DOCTYPE")[2].partition(">")[2].strip() + "\n"


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
