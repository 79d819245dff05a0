"""Plots what past samples, noise and the sampling rate do, from the table ``past``."""

from tactus.report.draw.findings import Row, number, rows_of
from tactus.report.draw.plots import Plot
from tactus.report.measure.table import Table

NETWORK, FITTED, WIENER = "network %", "least squares %", "Wiener %"
# A linear estimator that errs no more than this many times as much is as good.
AS_GOOD = 1.1


def past_plots(table: Table) -> list[Plot]:
    """The error of networks and linear estimators against past samples, noise and sampling rate."""
    return [
        _plot(
            table,
            "samples",
            "samples a sensor",
            "samples of each sensor",
            _samples_sentence(table),
        ),
        _plot(table, "noise", "noise uV", "noise at each sensor, uV", _noise_sentence(table)),
        _plot(table, "rate, same times", "rate Hz", "frames a second", _rate_sentence(table)),
    ]


def _plot(table: Table, varied: str, x: str, across: str, sentence: str) -> Plot:
    found: dict[str, list[tuple[float, float]]] = {}
    for row in rows_of(table, varied=varied):
        for kind in (NETWORK, WIENER):
            points = found.setdefault(f"{row['output']}, {kind.removesuffix(' %')}", [])
            points.append((number(row, x), number(row, kind)))
    return Plot(
        f"past_{varied.split(',')[0]}",
        f"Swing: error against {across.split(',')[0]}",
        across,
        "error %, equation 6.6",
        found,
        sentence,
        [table.name],
        linear="x",
    )


def _samples_sentence(table: Table) -> str:
    rows = rows_of(table, varied="samples")
    first, last = rows[:3], rows[-3:]
    told = "; ".join(
        f"{a['output']} from {number(a, NETWORK):.2g} to {number(b, NETWORK):.2g} %"
        for a, b in zip(first, last, strict=True)
    )
    count = number(last[0], "samples a sensor")
    return f"{count:g} samples of each sensor instead of one take {told}. {linear_sentence(last)}"


def linear_sentence(rows: list[Row]) -> str:
    """A sentence that says, for each output, whether a linear estimator would be as good."""
    told = []
    for row in rows:
        network, linear = number(row, NETWORK), min(number(row, FITTED), number(row, WIENER))
        name = "least squares" if linear == number(row, FITTED) else "the Wiener filter"
        verdict = "as good or better" if linear <= AS_GOOD * network else "worse"
        told.append(f"{row['output']}: {name}, {linear:.2g} %, is {verdict}")
    return f"The best linear estimator on the same past, {'; '.join(told)}."


def _noise_sentence(table: Table) -> str:
    rows = rows_of(table, varied="noise")
    told = "; ".join(
        f"{a['output']} from {number(a, NETWORK):.2g} to {number(b, NETWORK):.2g} %"
        for a, b in zip(rows[:3], rows[-3:], strict=True)
    )
    return (
        f"From no noise to {number(rows[-1], 'noise uV'):g} uV the network goes, {told}. "
        f"{linear_sentence(rows[-3:])}"
    )


def _rate_sentence(table: Table) -> str:
    same, frames = (rows_of(table, varied=f"rate, same {what}") for what in ("times", "frames"))

    def in_words(rows: list[Row]) -> str:
        return "; ".join(
            f"{a['output']} {number(a, NETWORK):.2g} and {number(b, NETWORK):.2g} %"
            for a, b in zip(rows[:3], rows[-3:], strict=True)
        )

    slow, fast = number(same[0], "rate Hz"), number(same[-1], "rate Hz")
    return (
        f"At {slow:g} and {fast:g} frames a second the network errs, with samples of the same "
        f"times, {in_words(same)}; with the same numbers of frames, {in_words(frames)}."
    )
