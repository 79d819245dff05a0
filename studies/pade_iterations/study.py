"""The error of the regression of Pade after more and more iterations, for each rho."""

from collections.abc import Iterator

from golden.activation.pade import stable_below
from golden.activation.schemes import SCHEMES
from tactus.report.activations import THESIS_FACTOR, measured
from tactus.report.measure.table import Cell

RHOS = (1.0, 2.0, 3.0, 4.0, 4.5, 5.0, 6.0, 8.0)
ITERATIONS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)


def rows() -> Iterator[dict[str, Cell]]:
    for rho in RHOS:
        for count in ITERATIONS:
            scheme = SCHEMES["pade"].configured({"rho": rho, "iterations": count})
            found = {m.arithmetic: m for m in measured(scheme, (THESIS_FACTOR,))}
            row: dict[str, Cell] = {
                "rho": rho,
                "stable below |q|": stable_below(rho),
                "iterations": count,
            }
            for name in ("exact", "thesis"):
                row[f"{name} mean %"] = found[name].mean_percent
                row[f"{name} largest units"] = found[name].largest
            yield row
