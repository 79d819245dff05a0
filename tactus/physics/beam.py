"""The cantilever of the flexible digit with its loads and gauges: thesis equations 3.1 to 3.9.

Lengths are in m, masses in kg, and forces in N.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.numbers.real import Real

GRAVITY = 9.80665  # m/s^2, a_g


@dataclass(frozen=True)
class Beam:
    """A straight beam of rectangular cross-section, fixed at i_B = 0, free at the other end.

    elastic_modulus: E in Pa.

    Bernoulli's theory holds for small slopes, without shear and without the beam's own weight. The
    error grows with the square of the slope. 23 g at the tip cause a slope of 0.4, at which a
    bending moment is some percent less than in the theory, because the tip comes nearer to the
    root.
    """

    length: float
    width: float
    thickness: float
    elastic_modulus: float

    @property
    def stiffness(self) -> float:
        """Flexural rigidity E I in N m^2, I = width thickness^3 / 12."""
        return self.elastic_modulus * self.width * self.thickness**3 / 12


def mean_arm(distance: ArrayLike, half_width: ArrayLike, triangular: ArrayLike) -> Real:
    """Lever arm max(distance, 0), averaged over a load of some width, in m.

    Equation 3.5 is for a load at a point. A load that is spread over a - h to a + h has the moment
    D a_g times this arm, which is the integral of its density times max(u, 0). Farther than h from
    the sensor both are the same; within h the kink is rounded.

    distance: a - i_B, from the sensor to the middle of the load. The arguments are broadcast.
    half_width: h.
    triangular: Whether the density falls from the middle to 0 at both ends, instead of being
        constant.
    """
    d, h, r = _covered(distance, half_width)
    even = h * r**2
    pointed = np.where(r <= 0.5, h * 4 * r**3 / 3, h * (2 * r - 1 + 4 * (1 - r) ** 3 / 3))
    inside = np.where(np.asarray(triangular, dtype=bool), pointed, even)
    return np.where(np.abs(d) < h, inside, np.maximum(d, 0))


def arm_slopes(
    distance: ArrayLike, half_width: ArrayLike, triangular: ArrayLike
) -> tuple[Real, Real]:
    """Derivatives of ``mean_arm`` by distance and by half-width.

    The first is the part of the load that lies beyond the sensor. The second is 0 wherever the
    sensor does not lie under the load; there the bending moment does not depend on the width.
    """
    d, h, r = _covered(distance, half_width)
    pointed = np.asarray(triangular, dtype=bool)
    nearer = np.minimum(r, 1 - r)
    by_distance = np.where(r <= 0.5, 2 * r**2, 1 - 2 * (1 - r) ** 2)
    by_half_width = 2 * nearer**2 - 8 * nearer**3 / 3
    spread = np.abs(d) < h
    return (
        np.where(spread, np.where(pointed, by_distance, r), (d > 0).astype(np.float64)),
        np.where(spread, np.where(pointed, by_half_width, r * (1 - r)), 0.0),
    )


def _covered(distance: ArrayLike, half_width: ArrayLike) -> tuple[Real, Real, Real]:
    """Distance and half-width, and the part of the load's width beyond the sensor."""
    d, h = np.asarray(distance), np.asarray(half_width)
    spread = np.abs(d) < h
    r = (np.divide(d, h, out=np.zeros(np.broadcast_shapes(d.shape, h.shape)), where=spread) + 1) / 2
    return d, h, r


@dataclass(frozen=True)
class Loads:
    """Loads on the beam in SI units. The arrays are broadcast.

    mass, position, half_width: D in kg; a in m, from the root to the middle of the load; h in m.
    triangular: See ``mean_arm``.
    """

    mass: Real
    position: Real
    half_width: Real
    triangular: Real


def strain(beam: Beam, position: float, loads: Loads) -> tuple[Real, Real]:
    """The strain of a gauge, gamma M_B / (E I) (equation 3.9), where gamma is half the thickness.

    An upward bend is positive. Beside it stand the derivatives by mass, position and half-width,
    shape (..., 3), in 1/kg and 1/m.

    position: That of the gauge in m from the root.
    """
    where = loads.position - position, loads.half_width, loads.triangular
    arm, (by_position, by_half_width) = mean_arm(*where), arm_slopes(*where)
    moments = np.broadcast_arrays(arm, loads.mass * by_position, loads.mass * by_half_width)
    per_moment = -GRAVITY * beam.thickness / (2 * beam.stiffness)
    return per_moment * loads.mass * arm, per_moment * np.stack(moments, axis=-1)
