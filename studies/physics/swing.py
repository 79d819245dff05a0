"""The swing of thesis section 6.3.2 and Appendix 7: motion, bearing forces and foot forces."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp

from golden.numbers.real import Real, checked
from tactus.physics.beam import GRAVITY

# From docs/studies/numerics.md: with light damping, DOP853 and LSODA take similar times, and near
# upright DOP853 has the smaller error. With overdamping, from two natural frequencies on, the
# samples of DOP853 between its steps miss the tolerance, and then stability limits its steps. LSODA
# keeps the tolerance there and is faster.
LIGHT, STRONG = "DOP853", "LSODA"
STRONG_DAMPING = 2.0
TOLERANCE = 1e-10

MOST_DAMPING = 1e6  # 1/s
MOST_SAMPLES = 10_000_000


@dataclass(frozen=True)
class Swing:
    """A pendulum between two A-frames. The default is the rig of thesis section 6.2.2.

    mass: D in kg, 1 mg to 1000 t.
    arm: I'_p, the distance from the axis to the centre of the mass, 1 mm to 100 m.
    damping: kappa in m/s, 0 or more; the rate kappa / arm may be up to 1e6 1/s. Appendix 7 has
        0.05.
    leg: I_p, the length of a leg, 1 mm to 100 m.
    feet: Distance of the two feet of a frame in m, above 0 and below two legs; it determines 2 psi.
    frame_mass: Mass in kg, 0 to 1e6, of everything that does not swing, distributed equally on all
        feet.
    """

    mass: float = 10.0
    arm: float = 0.480
    damping: float = 0.05
    leg: float = 0.720
    feet: float = 0.600
    frame_mass: float = 0.0

    def __post_init__(self) -> None:
        checked(
            mass=(self.mass, 1e-6, 1e6),
            arm=(self.arm, 1e-3, 100),
            damping=(self.damping, 0, MOST_DAMPING * self.arm),
            leg=(self.leg, 1e-3, 100),
            feet=(self.feet, 1e-3 * self.leg, 1.999 * self.leg),
            frame_mass=(self.frame_mass, 0, 1e6),
        )

    @property
    def half_angle(self) -> float:
        """psi in rad, the angle between a leg and the vertical."""
        return math.asin(self.feet / (2 * self.leg))

    @property
    def height(self) -> float:
        """Height of the axis above the feet in m."""
        return self.leg * math.cos(self.half_angle)

    @property
    def damping_rate(self) -> float:
        """Rate of the damping, kappa / I'_p, in 1/s."""
        return self.damping / self.arm

    @property
    def natural_frequency(self) -> float:
        """Frequency of small swings without damping in rad/s; its square is a_g / I'_p."""
        return math.sqrt(GRAVITY * self.arm) / self.arm


@dataclass(frozen=True)
class Motion:
    """The motion of a swing over time.

    time, shape (n,): Time in s, from 0.
    angle, shape (n,): phi in rad; 0 when hanging, and positive towards foot 2.
    speed, shape (n,): In rad/s.
    """

    time: Real
    angle: Real
    speed: Real


def swing_motion(swing: Swing, start: float, seconds: float, rate: float = 200.0) -> Motion:
    """Solve Appendix 7, equation 2: phi'' + kappa / I'_p phi' + (a_g / I'_p) sin(phi) = 0.

    start: phi_initial in rad, -pi to pi. The swing is released at rest. pi is upright, where the
        swing stays because nothing pushes it.
    seconds: Duration; it must give two to ten million samples.
    rate: Samples per second, 1e-3 to 1e9; the thesis captured 200.

    Returns: Samples at 0, 1 / rate, ...; there are ``seconds`` times ``rate`` of them.

    **Error** over 4 s: 2e-10 rad in the plain case, 1e-10 rad with strong damping, and 6e-8 rad
    when started from 179.9 degrees, where an error at the start grows about a thousandfold. Without
    damping the energy drifts by less than 1e-8 in 1000 periods (studies/stability).
    """
    checked(start=(start, -math.pi, math.pi), rate=(rate, 1e-3, 1e9))
    checked(seconds=(seconds, 2 / rate, MOST_SAMPLES / rate))
    damping, stiffness = swing.damping_rate, swing.natural_frequency**2

    def derivative(_: float, state: Real) -> tuple[float, float]:
        phi, speed = state.tolist()
        return speed, -damping * speed - stiffness * math.sin(phi)

    def jacobian(_: float, state: Real) -> list[list[float]]:
        return [[0.0, 1.0], [-stiffness * math.cos(state[0]), -damping]]

    strong = damping > STRONG_DAMPING * swing.natural_frequency
    times = np.arange(round(seconds * rate)) / rate
    found = solve_ivp(
        derivative,
        (0.0, times[-1]),
        [start, 0.0],
        method=STRONG if strong else LIGHT,
        t_eval=times,
        rtol=TOLERANCE,
        atol=TOLERANCE * 1e-3,
        **({"jac": jacobian} if strong else {}),
    )
    if not found.success:
        raise ArithmeticError(found.message)
    return Motion(times, found.y[0], found.y[1])


def bearing_forces(swing: Swing, angle: ArrayLike, speed: ArrayLike) -> tuple[Real, Real]:
    """Forces on the axis in N by Appendix 7: F_x towards foot 2, and F_y downwards.

    Along the rod acts F_cp = D (a_g cos(phi) + I'_p phi'^2); across it a point mass exerts no
    force. F_cp is computed from the speed, so that it holds with damping too. Without damping it
    equals what energy gives, D a_g (3 cos(phi) - 2 cos(phi_initial)). Damping acts on the mass,
    like the drag of the air, and not on the bearing.

    angle, speed: phi in rad and phi' in rad/s, finite. They are broadcast.
    """
    phi, rate = checked(angle=(angle, -1e12, 1e12), speed=(speed, -1e12, 1e12))
    pull = swing.mass * (GRAVITY * np.cos(phi) + swing.arm * rate**2)
    return pull * np.sin(phi), pull * np.cos(phi)


def foot_forces(swing: Swing, angle: ArrayLike, speed: ArrayLike) -> tuple[Real, Real]:
    """N_y1 and N_y2 in N, downwards, each for the two feet of one side (equations 6.4, 6.5).

    The leg's length cancels: (F_y sin(psi) -+ F_x cos(psi)) / (2 sin(psi)), plus half of the
    frame's weight on each side. Below 0 the feet would have to be held down, or the swing tips
    over. Arguments and errors are as in ``bearing_forces``.
    """
    horizontal, downward = bearing_forces(swing, angle, speed)
    even = (downward + swing.frame_mass * GRAVITY) / 2
    tilt = horizontal / (2 * math.tan(swing.half_angle))
    return even - tilt, even + tilt
