"""Independent calculations with more digits, by other formulas, which judge those of the project.

They use mpmath, and are slow.
"""

import mpmath as mp
import numpy as np

from golden.numbers.real import Real
from studies.physics.plate import Plate

DIGITS = 50
# Terms of a series in exp(-u) are left out from this u on: they are below 1e-26 of the first.
FAR = 60


def harmonic_sum(
    position: float, load: float, centre: float, half_width: float, terms: int
) -> float:
    """Equation 3.17, see ``harmonic_load``."""
    with mp.workdps(DIGITS):
        w, c, p = (mp.mpf(value) for value in (half_width, centre, position))
        return float(
            4
            * mp.mpf(load)
            * mp.fsum(
                mp.sinpi(m * w) * mp.cospi(m * c) * mp.cospi(m * p) / (m * mp.pi)
                for m in range(1, terms + 1)
            )
        )


def deflection(plate: Plate, point: tuple[float, float], load: tuple[float, float]) -> mp.mpf:
    """w in m/N at a point for 1 N at a load.

    Along y the m-th sine obeys f'''' - 2 k^2 f'' + k^4 f = delta(y - eta), k = m pi / a. The
    solution without edges is (1 + u) exp(-u) / (4 k^3), u = k ``|y - eta|``, whose sum over all m
    is in closed form (polylogarithms). Four solutions without a load, found from the four
    conditions at the edges, are added to it.
    """
    with mp.workdps(DIGITS):
        (x, y), (xi, eta) = (tuple(map(mp.mpf, place)) for place in (point, load))
        a, b = mp.mpf(plate.length), mp.mpf(plate.width)
        unit = mp.pi / a
        c = unit * abs(y - eta)

        def summed(theta: mp.mpf) -> mp.mpf:
            z = mp.exp(mp.mpc(-c, theta))
            return mp.re(mp.polylog(3, z) + c * mp.polylog(2, z))

        total = (summed(unit * (x - xi)) - summed(unit * (x + xi))) / 2
        reach = min(y, b - y) + min(eta, b - eta)
        m = 1
        while m * unit * reach < FAR:
            both = mp.sin(m * unit * x) * mp.sin(m * unit * xi)
            total += both * _edges(plate.clamped, m * unit * b, y / b, eta / b) / m**3
            m += 1
        return total * a**2 / (2 * mp.pi**3 * mp.mpf(plate.stiffness))


def _edges(clamped: bool, beta: mp.mpf, y: mp.mpf, eta: mp.mpf) -> mp.mpf:
    """What the edges y = 0 and y = 1 add to (1 + u) exp(-u), u = beta |y - eta|."""
    derivative = 1 if clamped else 2

    def values(at: mp.mpf) -> list[list[mp.mpf]]:
        """Value and first or second derivative by beta y, of the four and of (1 + u) exp(-u)."""
        low, high, u = beta * at, beta * (1 - at), beta * abs(at - eta)
        side = mp.sign(at - eta)
        el, eh, eu = mp.exp(-low), mp.exp(-high), mp.exp(-u)
        if derivative == 1:
            ends = [-el, (1 - low) * el, eh, (high - 1) * eh, -side * u * eu]
        else:
            ends = [el, (low - 2) * el, eh, (high - 2) * eh, (u - 1) * eu]
        return [[el, low * el, eh, high * eh, (1 + u) * eu], ends]

    rows = values(mp.mpf(0)) + values(mp.mpf(1))
    matrix = mp.matrix([row[:4] for row in rows])
    found = mp.lu_solve(matrix, mp.matrix([-row[4] for row in rows]))
    return mp.fdot(found, values(y)[0][:4])


def least_squares(matrix: Real, right: Real) -> tuple[Real, float]:
    """The x with the least ``|matrix x - right|``, and that least length, by the normal equations.

    These square the condition, for which there are digits to spare.
    """
    with mp.workdps(DIGITS):
        exact, wanted = mp.matrix(matrix.tolist()), mp.matrix(right.tolist())
        x = mp.lu_solve(exact.T * exact, exact.T * wanted)
        return np.array([float(value) for value in x]), float(mp.norm(exact * x - wanted))


def inverse_of_squares(matrix: Real) -> Real:
    """The inverse of matrix' matrix."""
    with mp.workdps(DIGITS):
        exact = mp.matrix(matrix.tolist())
        inverse = (exact.T * exact) ** -1
        return np.array(
            [[float(inverse[i, j]) for j in range(inverse.cols)] for i in range(inverse.rows)]
        )


def least_mean_squares(rows: Real, wanted: Real, rate: float, passes: int) -> Real:
    """theta += rate (wanted - row . theta) row, over all rows, from 0."""
    with mp.workdps(DIGITS):
        exact = [list(map(mp.mpf, row)) for row in rows.tolist()]
        theta = [mp.mpf(0)] * rows.shape[1]
        for _ in range(passes):
            for row, goal in zip(exact, wanted.tolist(), strict=True):
                step = rate * (goal - mp.fdot(row, theta))
                theta = [value + step * by for value, by in zip(theta, row, strict=True)]
        return np.array([float(value) for value in theta])
