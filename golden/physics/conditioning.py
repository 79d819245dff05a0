"""From a deflection to a code: the sensors and their conditioning, thesis section 6.4."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import signal

from golden.domain import checked
from golden.fixed import Codes
from golden.networks.mlp import Real
from golden.precision import SIGNAL

RESISTANCE, CAPACITANCE = 560e3, 4.7e-6  # ohm, F: the DC remover of section 6.4.2
CUTOFF = 0.06  # Hz, as the thesis rounds 1 / (2 pi R C)


@dataclass(frozen=True)
class ReflectiveSensor:
    """A reflective proximity sensor below the plate, linear within its range (Figure 6.9).

    Parameters
    ----------
    rest : float
        V without deflection, 0 to 100; the thesis has 3.5 to 4.7.
    sensitivity : float
        V/m, -1e6 to 1e6. 450 by default: ours; with it a 10 kg swing moves the sensors by the 10 to
        60 mV that the thesis reports.
    linear : float
        m, 1 um to 1 m: beyond this deflection either way the output stays what it is there. 1 mm by
        default, what a person on the plate makes (section 6.2.1).
    noise : float
        Standard deviation of Gaussian noise, V, 0 to 10.

    Raises
    ------
    ValueError
        For a value outside its range.
    """

    rest: float = 4.1
    sensitivity: float = 450.0
    linear: float = 1e-3
    noise: float = 0.0

    def __post_init__(self) -> None:
        checked(
            rest=(self.rest, 0, 100),
            sensitivity=(self.sensitivity, -1e6, 1e6),
            linear=(self.linear, 1e-6, 1),
            noise=(self.noise, 0, 10),
        )

    def read(self, deflection: ArrayLike, rng: np.random.Generator) -> Real:
        """Volts for deflections in m; the noise is the next of ``rng``.

        Raises
        ------
        ValueError
            For NaN or infinity.
        """
        most = float(np.finfo(np.float64).max)
        (w,) = checked(deflection=(deflection, -most, most))
        volts = self.rest + self.sensitivity * np.clip(w, -self.linear, self.linear)
        return np.asarray(volts + rng.normal(0, self.noise, w.shape))


@dataclass(frozen=True)
class Conditioning:
    """DC remover, gain, clipping circuit and ADC of one sensor.

    Parameters
    ----------
    gain : float
        G, -1e6 to 1e6; the thesis has 10 for sensors 1 and 3, 80 for sensor 2.
    cutoff : float
        Of the first-order high pass, Hz, 0 to below half of the rate; 0 passes DC too.
    rate : float
        Samples per second, 1e-3 to 1e9.

    Raises
    ------
    ValueError
        For a value outside its range.
    """

    gain: float
    cutoff: float = CUTOFF
    rate: float = 200.0

    def __post_init__(self) -> None:
        checked(gain=(self.gain, -1e6, 1e6), rate=(self.rate, 1e-3, 1e9))
        checked(cutoff=(self.cutoff, 0, 0.499 * self.rate))

    def amplify(self, volts: ArrayLike, rest: float) -> Real:
        """High pass, then gain; V, not clipped.

        The high pass is the bilinear image of s / (s + omega) with its cut-off in place
        (``scipy.signal.butter``), settled at ``rest`` before the first sample.

        Parameters
        ----------
        volts : array_like of float, shape (n,)
            n of 1 or more.
        rest : float
            V.

        Raises
        ------
        ValueError
            For NaN, infinity or another shape.
        """
        most = float(np.finfo(np.float64).max)
        v, r = checked(volts=(volts, -most, most), rest=(rest, -most, most))
        if v.ndim != 1 or not v.size:
            raise ValueError(f"volts: got shape {v.shape}, expected (n,) with n of 1 or more")
        if self.cutoff == 0:
            return np.asarray(self.gain * v)
        b, a = signal.butter(1, self.cutoff, "highpass", fs=self.rate)
        passed, _ = signal.lfilter(b, a, v - r, zi=[0.0])
        return np.asarray(self.gain * passed)

    def convert(self, volts: ArrayLike, rest: float) -> tuple[Codes, int]:
        """What the ADC gives: codes of Fix(14,13), and how many samples the clipping circuit cut.

        Arguments and errors as ``amplify``; rounding and saturation as ``Fix.quantise``.
        """
        return SIGNAL.quantise(self.amplify(volts, rest))


def rc_cutoff(resistance: float = RESISTANCE, capacitance: float = CAPACITANCE) -> float:
    """Cut-off 1 / (2 pi R C) in Hz of a resistor and a capacitor, both above 0.

    Raises
    ------
    ValueError
        For a value outside 1e-12 to 1e12 ohm or F.
    """
    checked(resistance=(resistance, 1e-12, 1e12), capacitance=(capacitance, 1e-12, 1e12))
    return 1 / (2 * math.pi * resistance * capacitance)
