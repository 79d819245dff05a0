"""How far every activation is from tanh.

The question is how large the error of each scheme is, and how much its arithmetic adds. Every input
code is measured in each precision of the scheme, in ``thesis`` precision for several Q, and the
same inputs in floating point. The reference is numpy's tanh. The figures that the thesis prints
stand beside the results.
"""

import csv
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from golden.activation.activation_block import ActivationBlock
from golden.activation.pade import UnsettledWarning
from golden.activation.scheme import Scheme
from golden.activation.schemes import forms
from golden.numbers.precision import Precision
from tactus.core.files import replace_file, write_json
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
