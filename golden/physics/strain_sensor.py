"""The gauges of the flexible digit, thesis equations 3.7 to 3.9, fitted to recorded vectors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares

from golden.domain import checked
from golden.input_error import InputError
from golden.physics import GRAVITY
from golden.physics.beam import MOST_MASS, Beam, arm_slopes, mean_arm
from golden.real import Real
from golden.units import FULL_SCALE, LOAD_G, POSITION_MM, WIDTH_MM

# Loads and their columns as golden/data/appendix2.csv has them.
COLUMNS = ("load", "position", "width", "shape")
TRIANGLE_CODE, RECTANGLE_CODE = 0.9, 0.45  # Table 3.1

# A gauge that reads the load alone is one infinitely far away; the search ends at this many lengths
# of the beam, where the arm changes by 0.4 % over the whole working range.
FARTHEST = 100.0


@dataclass(frozen=True)
class Loads:
    """Loads on the beam in SI units; the arrays broadcast.

    Parameters
    ----------
    mass : float array
        D, kg.
    position : float array
        a, m from the root to the middle of the load.
    half_width : float array
        m.
    triangular : bool array
        See ``mean_arm``.
    """

    mass: Real
    position: Real
    half_width: Real
    triangular: Real

    def at_points(self) -> Loads:
        """The same without width: what equation 3.5 is for."""
        return replace(self, half_width=np.zeros_like(self.half_width))


def loads_from_codes(codes: ArrayLike, beam: Beam) -> Loads:
    """What coded targets (load, position, width, shape; Table 3.1) are on the beam.

    Parameters
    ----------
    codes : array_like of float, shape (..., 4)
        0.9 is 23 g, 127 mm from the tip, 50.8 mm of width (``golden.units``).
    beam : Beam
    """
    load, position, width, shape = np.moveaxis(np.asarray(codes, dtype=np.float64), -1, 0)
    return Loads(
        load / FULL_SCALE * LOAD_G / 1e3,
        beam.length - position / FULL_SCALE * POSITION_MM / 1e3,
        width / FULL_SCALE * WIDTH_MM / 2e3,
        shape > (TRIANGLE_CODE + RECTANGLE_CODE) / 2,
    )


def bridge_gain(
    amplifier: float, gauge_factor: float, excitation: float, bridge_factor: float = 2.0
) -> float:
    """Volts per strain, G G_f V_ex / k (equations 3.7 and 3.8).

    Parameters
    ----------
    amplifier, gauge_factor : float
        G and G_f, above 0 to 1e6.
    excitation : float
        V_ex in V, -1000 to 1000.
    bridge_factor : float
        k; 2 for a half bridge (thesis section 3.8.2), 1e-3 to 1e3.

    Raises
    ------
    InputError
        For an argument outside its range.
    """
    least = float(np.finfo(np.float64).tiny)
    checked(
        amplifier=(amplifier, least, 1e6),
        gauge_factor=(gauge_factor, least, 1e6),
        excitation=(excitation, -1e3, 1e3),
        bridge_factor=(bridge_factor, 1e-3, 1e3),
    )
    return amplifier * gauge_factor * excitation / bridge_factor


@dataclass(frozen=True)
class StrainSensor:
    """One gauge with its amplifier: V = gain gamma M_B / (E I) + offset (equation 3.9).

    Parameters
    ----------
    gain : float
        V per strain; see ``bridge_gain``. Positive reads an upward bend as positive.
    offset : float
        V_off, V.
    position : float
        m from the root. Below 0 no gauge of this beam can be; the formula is carried on, so that a
        fit can say that a sensor does not read a bending moment.
    beam : Beam
        gamma is half of its thickness.
    """

    gain: float
    offset: float
    position: float
    beam: Beam

    def read(self, loads: Loads) -> Real:
        """Volts for each load, not clipped.

        Raises
        ------
        InputError
            For a mass outside 0 to 1e6 kg or a load beyond the root, NaN included.
        """
        mass, arm = self._mass_and_arm(loads)
        strain = -mass * GRAVITY * arm * self.beam.thickness / (2 * self.beam.stiffness)
        result: Real = self.gain * strain + self.offset
        return result

    def slopes(self, loads: Loads) -> Real:
        """Derivatives of ``read`` by mass, position and half-width, shape (..., 3); V/kg and V/m.

        Raises
        ------
        InputError
            See ``read``.
        """
        mass, arm = self._mass_and_arm(loads)
        by_position, by_half_width = arm_slopes(
            loads.position - self.position, loads.half_width, loads.triangular
        )
        moments = np.broadcast_arrays(arm, mass * by_position, mass * by_half_width)
        per_moment = -self.gain * GRAVITY * self.beam.thickness / (2 * self.beam.stiffness)
        result: Real = per_moment * np.stack(moments, axis=-1)
        return result

    def _mass_and_arm(self, loads: Loads) -> tuple[Real, Real]:
        mass, place = checked(
            mass=(loads.mass, 0, MOST_MASS), position=(loads.position, 0, self.beam.length)
        )
        return mass, mean_arm(place - self.position, loads.half_width, loads.triangular)


def fit_sensor(readings: ArrayLike, loads: Loads, beam: Beam, spread: bool = True) -> StrainSensor:
    """Gain, offset and position for which equation 3.9 is nearest to recorded readings.

    Least squares over all readings. For each position gain and offset follow from a linear
    solution, so that SciPy searches the position alone, from the root.

    Parameters
    ----------
    readings : array_like of float, shape (n,)
        V.
    loads : Loads
        n of them.
    beam : Beam
    spread : bool
        Take the width of the loads into account (``mean_arm``); otherwise equation 3.5 as printed,
        for a load at a point.

    Raises
    ------
    InputError
        For fewer than four readings, NaN or infinite ones, or loads of another number.
    """
    most = float(np.finfo(np.float64).max)
    (volts,) = checked(readings=(readings, -most, most))
    if volts.ndim != 1 or volts.size < 4:
        raise InputError(f"readings: got shape {volts.shape}, expected (n,) with n of 4 or more")
    if loads.mass.shape != volts.shape:
        raise InputError(f"loads: got shape {loads.mass.shape}, expected {volts.shape}")
    used = loads if spread else loads.at_points()

    def solved(nearness: Real) -> StrainSensor:
        """Of a gauge at length (1 - 1 / nearness): 1 is the root, 0 infinitely far outside."""
        position = beam.length * (1 - 1 / float(nearness[0]))
        unit = StrainSensor(1.0, 0.0, position, beam).read(used)
        matrix = np.stack([unit, np.ones_like(unit)], axis=1)
        # Readings of a distant gauge are huge; columns of like size keep the solution exact.
        scale = np.maximum(np.abs(matrix).max(axis=0), np.finfo(np.float64).tiny)
        gain, offset = np.linalg.lstsq(matrix / scale, volts)[0] / scale
        return StrainSensor(float(gain), float(offset), position, beam)

    last = 0.99 * loads.position.max()
    ends = 1 / FARTHEST, beam.length / (beam.length - last)
    found = least_squares(lambda u: solved(u).read(used) - volts, [1.0], bounds=ends)
    return solved(found.x)


def fit_sensors(table: ArrayLike, beam: Beam, spread: bool = True) -> list[StrainSensor]:
    """One fit for each sensor.

    Parameters
    ----------
    table : array_like of float, shape (rows, sensors + 4)
        Readings, then load, position, width and shape as coded targets.
    beam, spread
        See ``fit_sensor``, whose errors these are.
    """
    rows = np.asarray(table, dtype=np.float64)
    loads = loads_from_codes(rows[:, -len(COLUMNS) :], beam)
    return [fit_sensor(column, loads, beam, spread) for column in rows[:, : -len(COLUMNS)].T]


def read_sensors(sensors: Sequence[StrainSensor], loads: Loads) -> Real:
    """Readings of all sensors, shape (n, sensors)."""
    return np.stack([sensor.read(loads) for sensor in sensors], axis=-1)
