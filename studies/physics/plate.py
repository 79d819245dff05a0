"""The surface plate: thesis equations 6.1 to 6.3, for loads and points at any place."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import zeta

from golden.input_error import InputError
from golden.numbers.real import Real, checked

# Number of terms times pairs in one chunk of the series, which is small enough for a cache and
# large enough for numpy.
CHUNK = 1 << 16
MOST_TERMS = 1_000_000

# From docs/studies/numerics.md: at the load itself, where the series converges slowest,
# the sum of so many terms is within 2e-6 of the limit, and takes less time than the coarsest grid.
TERMS = 1000


@dataclass(frozen=True)
class Plate:
    """A thin rectangular plate, simply supported at x = 0 and x = a.

    length, width: a (x) and b (y) in m, 1 mm to 1 km; neither may be more than a hundred times the
        other. The default is the outer plate of thesis section 6.2.1, which is clamped along its
        long sides.
    thickness: t_r in m, 1 um to 1 m.
    elastic_modulus: E in Pa, 1 kPa to 10 TPa. The default is steel, 200 GPa; the thesis prints no
        value.
    poisson: nu, 0 to 0.5. The default is steel, 0.3.
    clamped: Whether the edges y = 0 and y = b are clamped (equation 6.3) or simply supported (6.1,
        6.2).

    Kirchhoff's theory assumes that deflections are small compared with the thickness, that the
    thickness is small compared with the sides, and that loads are static; the plate's own weight is
    left out.
    """

    length: float = 0.910
    width: float = 0.550
    thickness: float = 0.0028
    elastic_modulus: float = 2.0e11
    poisson: float = 0.3
    clamped: bool = True

    def __post_init__(self) -> None:
        checked(
            length=(self.length, 1e-3, 1e3),
            width=(self.width, 1e-3, 1e3),
            length_over_width=(self.length / self.width, 0.01, 100),
            thickness=(self.thickness, 1e-6, 1),
            elastic_modulus=(self.elastic_modulus, 1e3, 1e13),
            poisson=(self.poisson, 0, 0.5),
        )

    @property
    def stiffness(self) -> float:
        """Flexural rigidity in N m, E t_r^3 / (12 (1 - nu^2)); the thesis calls it P."""
        return self.elastic_modulus * self.thickness**3 / (12 * (1 - self.poisson**2))

    def _pairs(self, points: ArrayLike, loads: ArrayLike) -> tuple[Real, Real, Real, Real]:
        """x, y of the points and xi, eta of the loads after a check, as (n, 1) and (1, k)."""
        places = []
        for name, value in (("points", points), ("loads", loads)):
            array = np.asarray(value, dtype=np.float64)
            if array.ndim != 2 or array.shape[1] != 2:
                raise InputError(f"{name}: got shape {array.shape}, expected (n, 2)")
            x, y = checked(
                **{
                    f"{name} x": (array[:, 0], 0, self.length),
                    f"{name} y": (array[:, 1], 0, self.width),
                }
            )
            places.append((x, y))
        (x, y), (xi, eta) = places
        return x[:, None], y[:, None], xi[None, :], eta[None, :]

    def influence(self, points: ArrayLike, loads: ArrayLike, terms: int = TERMS) -> Real:
        """Deflection at each point for 1 N at each load, m/N, positive in the load's direction.

        The plate is linear, so the deflection under forces F is ``influence @ F``.

        Equation 6.1 sums, over m, the effect of a unit load at (xi, eta) along the line x of the
        m-th sine. Clamped edges add the deflection by those edge moments that make both slopes 0;
        it has a symmetric and an antisymmetric part. On the axis y = eta = b / 2 the result is
        equation 6.3, whose second sum is printed for that axis only.

        points, shape (n, 2): x in 0 to a, y in 0 to b, m.
        loads, shape (k, 2): xi and eta, m.
        terms: 1 to a million.

        Returns: shape (n, k).

        Hyperbolic functions appear only as exp(-u) with u of 0 or more. So nothing overflows for
        any number of terms, and factors below the smallest float become 0, as they should. The time
        grows with the number of terms times that of pairs; the memory does not grow with the number
        of terms.

        **Error**: docs/physics.md bounds the sum of the terms that are left out. Rounding errors
        are 1e-13 of the largest deflection for plates with similar sides. For b = a / 100,
        cancellation costs four more digits (studies/stability).
        """
        checked(terms=(terms, 1, MOST_TERMS))
        x, y, xi, eta = self._pairs(points, loads)
        a, b = self.length, self.width
        total = np.zeros((x.shape[0], xi.shape[1]))
        step = max(1, CHUNK // max(1, total.size))
        for first in range(1, terms + 1, step):
            m = np.arange(first, min(first + step, terms + 1), dtype=np.float64)[:, None, None]
            k = m * (np.pi / a)
            sines = np.sin(np.pi * np.remainder(m * (xi / a), 2)) * np.sin(
                np.pi * np.remainder(m * (x / a), 2)
            )
            line = _supported(k * b, k * np.minimum(y, eta), k * (b - np.maximum(y, eta)))
            if self.clamped:
                line = line - _clamping(k * b / 2, k * (y - b / 2), k * eta, k * (b - eta))
            total += (sines * line / m**3).sum(axis=0)
        return total * a**2 / (np.pi**3 * self.stiffness)

    def tail(self, points: ArrayLike, loads: ArrayLike, terms: int = TERMS) -> Real:
        """A bound of the part of ``influence`` in the terms beyond ``terms``, m/N, shape (n, k).

        A supported edge, and even more a clamped edge, only reduces the deflection of an infinite
        strip: 0 <= line <= (1 + u) exp(-u) / 2 with ``u = k |y - eta|``. This decreases with m, so
        the tail is at most its first value times the sum of 1 / m^3 (Hurwitz' zeta function).
        Beside the load it decreases exponentially, and on the load's line as 1 / m^2.

        Arguments and errors are as in ``influence``.
        """
        checked(terms=(terms, 1, MOST_TERMS))
        _, y, _, eta = self._pairs(points, loads)
        u = np.pi * (terms + 1) / self.length * np.abs(y - eta)
        shape = (np.shape(points)[0], np.shape(loads)[0])
        scale = self.length**2 / (2 * np.pi**3 * self.stiffness)
        return np.broadcast_to((1 + u) * np.exp(-u) * scale * zeta(3, terms + 1), shape)


def _minus(u: Real) -> Real:
    """2 sinh(u) / exp(u) for u of 0 or more."""
    return np.asarray(-np.expm1(-2 * u))


def _plus(u: Real) -> Real:
    """2 cosh(u) / exp(u)."""
    return np.asarray(1 + np.exp(-2 * u))


def _supported(beta: Real, p: Real, q: Real) -> Real:
    """The bracket of equation 6.1 times its quotient of hyperbolic sines.

    p is beta eta / b and q is beta y_1 / b. At most one of them exceeds beta / 2, and p + q <=
    beta. u coth(u) sinh(u) is written as u cosh(u), so that nothing is divided by 0 at u = 0.
    """
    sp, sq, sb = _minus(p), _minus(q), _minus(beta)
    scaled = (1 + beta * _plus(beta) / sb) * sp * sq - q * _plus(q) * sp - p * _plus(p) * sq
    return np.asarray(scaled * np.exp(p + q - beta) / (2 * sb))


def _edge_slope(beta: Real, p: Real) -> Real:
    """Slope of equation 6.1 at an edge, over k; p is k times the load's distance from the other."""
    sb = _minus(beta)
    scaled = beta * _plus(beta) / sb * _minus(p) - p * _plus(p)
    return np.asarray(scaled * np.exp(p - beta) / sb)


def _clamping(alpha: Real, t: Real, to_low: Real, to_high: Real) -> Real:
    """The reduction by clamped edges, with t = k (y - b / 2), alpha = k b / 2.

    Both parts solve the plate equation without a load and are 0 at the edges:
    t sinh(t) - alpha tanh(alpha) cosh(t) and t cosh(t) - alpha coth(alpha) sinh(t).
    """
    high = _edge_slope(2 * alpha, to_low)
    low = _edge_slope(2 * alpha, to_high)
    u = np.abs(t)
    s, c, small = _minus(alpha), _plus(alpha), 4 * alpha * np.exp(-2 * alpha)
    decay = np.exp(u - alpha)
    even = (alpha * s / c * _plus(u) - u * _minus(u)) * c / (s * c + small)
    odd = np.sign(t) * (alpha * c / s * _minus(u) - u * _plus(u)) * s / (s * c - small)
    return np.asarray(decay * ((high + low) * even + (high - low) * odd) / 2)
