"""Draws the training and the validation error during training, from table ``convergence``."""

from itertools import pairwise

from tactus.report.draw.findings import number, rows_of
from tactus.report.draw.plots import Plot
from tactus.report.measure.table import Table

TRAINING, VALIDATION = "training %", "validation %"


def convergence_plot(table: Table) -> Plot:
    """Both errors of each network against the number of evaluations."""
    found: dict[str, list[tuple[float, float]]] = {}
    told = []
    for network in dict.fromkeys(row["network"] for row in rows_of(table)):
        rows = rows_of(table, network=network)
        for column in (TRAINING, VALIDATION):
            found[f"{network}, {column.removesuffix(' %')}"] = [
                (number(row, "evaluations"), number(row, column)) for row in rows
            ]
        rises = sum(number(b, VALIDATION) > number(a, VALIDATION) for a, b in pairwise(rows))
        ratio = number(rows[-1], VALIDATION) / number(rows[-1], TRAINING)
        told.append(
            f"for {network} it rises {rises} times between {len(rows)} points and ends at "
            f"{ratio:.1f} times the training error"
        )
    return Plot(
        "convergence",
        "Training and validation error on the way down",
        "evaluations of the error",
        "root mean square error %",
        found,
        f"The training error falls throughout. The validation error also rises: {'; '.join(told)}.",
        [table.name],
    )
