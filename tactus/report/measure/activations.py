"""The error of activations against clocks, and of Pade against its iterations."""

from golden.activation.reference import stable_below
from golden.activation.schemes import SCHEMES
from golden.numbers.precision import PRECISIONS
from tactus.report.measure.activation_errors import THESIS_FACTOR, built, measured, variants
from tactus.report.measure.table import Cell, Table

RHOS = (1.0, 2.0, 3.0, 4.0, 4.5, 5.0, 6.0, 8.0)
ITERATIONS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)


def activations(_: int) -> Table:
    """Every scheme in every precision, with equation 4.32, the largest error, and the clocks."""
    rows: list[list[Cell]] = []
    for name, options, scheme in variants():
        full = f"{name}, {options}" if options else name
        for row in measured(name, options, scheme, (THESIS_FACTOR,)):
            timing: list[Cell] = [None, None]
            if row.arithmetic in PRECISIONS:
                block = built(scheme, PRECISIONS[row.arithmetic], row.factor)
                timing = [block.latency, block.interval]
            rows.append(
                [
                    full,
                    row.arithmetic,
                    row.factor,
                    row.mean_percent,
                    row.mean_percent_thesis,
                    row.thesis,
                    row.largest,
                    *timing,
                ]
            )
    return Table(
        "activations",
        [
            "scheme",
            "arithmetic",
            "Q",
            "mean %",
            "mean x 2 %",
            "printed %",
            "largest units",
            "latency clocks",
            "interval clocks",
        ],
        rows,
        "Errors against tanh: equation 4.32 as printed, and twice that, which agrees with the "
        "figures of the thesis. The largest error is in units of 2^-13 over every input code, with "
        "|q| to 3 in floating point and in thesis precision, and to 8 in exact precision. The "
        "latency is from a code to its result, and the interval from one code to the next. With "
        "fewer iterations, pade needs fewer clocks for both.",
    )


def iterations(_: int) -> Table:
    """The error of Pade for more and more iterations, for each rho."""
    rows: list[list[Cell]] = []
    for rho in RHOS:
        stable = stable_below(rho)
        for count in ITERATIONS:
            scheme = SCHEMES["pade"].configured({"rho": rho, "iterations": count})
            for row in measured("pade", "", scheme, (THESIS_FACTOR,)):
                rows.append([rho, stable, count, row.arithmetic, row.mean_percent, row.largest])
    return Table(
        "iterations",
        ["rho", "stable below |q|", "iterations", "arithmetic", "mean %", "largest units"],
        rows,
        "The errors are those of the regression of equation 4.12, with the gate at 3.3, against "
        "tanh. 'mean %' is equation 4.32 as printed. The largest error is in units of 2^-13 over "
        "every input code, with |q| up to 3 in floating point and in thesis precision (Q = 3), and "
        "up to 8 in exact precision, which includes the step at the gate. A rho whose column "
        "'stable below |q|' is less than 3.3 diverges before the gate, and the result saturates.",
    )
