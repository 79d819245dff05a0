"""Draws Figure 4.5 of the thesis: the error of its Taylor series and of its fraction."""

import numpy as np

from golden.activation.reference import pade_fraction, taylor
from golden.numbers.real import Real
from tactus.report.draw.plots import Plot, side_by_side

# Up to where Pade is used (section 4.3.2.3).
Q = np.linspace(0.02, 3.3, 165)


def errors() -> dict[str, Real]:
    """The magnitude of the errors at ``Q``, in percent of tanh."""
    exact = np.tanh(Q)
    forms = {"Taylor, equation 4.5": taylor(Q), "Pade, equation 4.6": pade_fraction(Q)}
    return {name: 100 * np.abs(values / exact - 1) for name, values in forms.items()}


def drawn() -> str:
    """Both errors against q."""
    points = {
        name: list(zip(Q.tolist(), found.tolist(), strict=True)) for name, found in errors().items()
    }
    plot = Plot(*("taylor", "", "q", "error, % of tanh(q)"), points, "", [], linear="x", floor=1e-6)
    return side_by_side("taylor", "Taylor series and Pade fraction: error against q", [plot])


def sentence() -> str:
    """The largest error of each."""
    told = [f"{found.max():.2g} % ({name})" for name, found in errors().items()]
    return f"The largest errors up to q = {Q[-1]:g} are {' and '.join(told)}."
