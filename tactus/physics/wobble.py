"""The lateral wobble of the swing. It is our addition: the thesis measures it without a model."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.numbers.domain import checked
from golden.numbers.real import Real


@dataclass(frozen=True)
class Wobble:
    """A lightly damped second mode, x'' + 2 zeta omega x' + omega^2 x = 0, in closed form.

    It is independent of the pendulum: the frames rock sideways on the plate, with the mass on them.

    amplitude: Amplitude in m at time 0, 0 to 10. 8 mm give the mean of 9 mm from end to end in
        thesis Table 6.2.
    frequency: omega / (2 pi) in Hz, 1e-3 to 1e6; the default of 1.9 is no multiple of the swing's
        0.7 Hz.
    ratio: zeta, 0 to 0.5; with the default the wobble decays about as fast as the swing.
    phase: In rad, -2 pi to 2 pi: x = amplitude cos(phase) at time 0.
    """

    amplitude: float = 0.008
    frequency: float = 1.9
    ratio: float = 0.004
    phase: float = 0.0

    def __post_init__(self) -> None:
        checked(
            amplitude=(self.amplitude, 0, 10),
            frequency=(self.frequency, 1e-3, 1e6),
            ratio=(self.ratio, 0, 0.5),
            phase=(self.phase, -2 * math.pi, 2 * math.pi),
        )

    def displacement(self, time: ArrayLike) -> tuple[Real, Real]:
        """x in m and x'' in m/s^2 at times from 0 to 1e9 s."""
        (t,) = checked(time=(time, 0, 1e9))
        omega = 2 * math.pi * self.frequency
        # The roots of the characteristic equation are -zeta omega +- i omega sqrt(1 - zeta^2).
        root = omega * complex(-self.ratio, math.sqrt(1 - self.ratio**2))
        turning = self.amplitude * np.exp(root * t + 1j * self.phase)
        return np.real(turning), np.real(root**2 * turning)
