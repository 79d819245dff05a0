"""The path from a deflection to a code: sensors and conditioning, thesis sections 3.6 and 6.4."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.input_error import InputError
from golden.numbers.domain import checked
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real

# Hz, of the DC remover of section 6.4.2. The thesis rounds 1 / (2 pi R C) of 560 kilohm and
# 4.7 microfarad to it.
CUTOFF = 0.06
SCAN_RATE = 15_625.0  # complete scans of the digit's sensors a second: section 5.4.4


@dataclass(frozen=True)
class ReflectiveSensor:
    """A reflective proximity sensor below the plate, linear within its range (Figure 6.9).

    rest: Output in V without deflection, 0 to 100; the thesis has 3.5 to 4.7.
    sensitivity: V/m, -1e6 to 1e6. The default of 450 is ours: with it a 10 kg swing moves the
        sensors by the 10 to 60 mV that the thesis reports.
    linear: m, 1 um to 1 m. Beyond this deflection, in both directions, the output stays constant.
        The default of 1 mm is the lower end of the 1 to 2 mm that section 6.2.1 prints for a person
        on the plate.
    noise: Standard deviation of Gaussian noise, V, 0 to 10.
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
        """Volts for deflections in m; the noise comes from ``rng``."""
        most = float(np.finfo(np.float64).max)
        (w,) = checked(deflection=(deflection, -most, most))
        volts = self.rest + self.sensitivity * np.clip(w, -self.linear, self.linear)
        return np.asarray(volts + rng.normal(0, self.noise, w.shape))


@dataclass(frozen=True)
class Conditioning:
    """DC remover, gain, clipping circuit and ADC of one sensor.

    gain: G, -1e6 to 1e6; the thesis has 10 for sensors 1 and 3, and 80 for sensor 2.
    cutoff: Cut-off of the first-order high pass in Hz, 0 to below half of the rate; with 0, DC
        passes too.
    rate: Samples per second, 1e-3 to 1e9.
    """

    gain: float
    cutoff: float = CUTOFF
    rate: float = 200.0

    def __post_init__(self) -> None:
        checked(gain=(self.gain, -1e6, 1e6), rate=(self.rate, 1e-3, 1e9))
        checked(cutoff=(self.cutoff, 0, 0.499 * self.rate))

    def amplify(self, volts: ArrayLike, rest: float) -> Real:
        """Apply the high pass and then the gain; the result in V is not clipped.

        The high pass is the bilinear transform of s / (s + omega) with the right cut-off
        (``scipy.signal.butter``). Before the first sample it has settled at ``rest``.

        volts, shape (n,): At least one sample.
        rest: Output of the sensor at rest, in V.
        """
        most = float(np.finfo(np.float64).max)
        v, r = checked(volts=(volts, -most, most), rest=(rest, -most, most))
        if v.ndim != 1 or not v.size:
            raise InputError(f"volts: got shape {v.shape}, expected (n,) with n of 1 or more")
        if self.cutoff == 0:
            return np.asarray(self.gain * v)
        # It is imported only here, because that takes half a second and few commands filter.
        from scipy import signal

        b, a = signal.butter(1, self.cutoff, "highpass", fs=self.rate)
        passed, _ = signal.lfilter(b, a, v - r, zi=[0.0])
        return np.asarray(self.gain * passed)

    def convert(self, volts: ArrayLike, rest: float) -> tuple[Codes, int]:
        """The output of the ADC: codes of Fix(14,13), and the number of samples that were clipped.

        Arguments and errors are as in ``amplify``; rounding and saturation as in ``Fix.quantise``.
        """
        return SIGNAL.quantise(self.amplify(volts, rest))
