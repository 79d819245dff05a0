"""Draws how far an activation is from tanh."""

import numpy as np
from matplotlib.figure import Figure

from golden.activation.scheme import Scheme
from golden.numbers.precision import EXACT, THESIS
from tactus.report.draw.svg import svg
from tactus.report.measure.activation_errors import built


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
    return svg(figure, name.replace(" ", "_"))
