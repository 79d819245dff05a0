"""The sensors of the flexible digit, fitted to its recorded vectors by the theory of the beam."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares

from golden.numbers.real import Real
from golden.numbers.units import FULL_SCALE, LOAD_G, POSITION_MM, WIDTH_MM
from tactus.core.fingerprint import ROOT
from tactus.physics.beam import Beam, Loads, StrainSensor

# The columns of loads in scenes/data/appendix2.csv.
COLUMNS = ("load", "position", "width", "shape")
TRIANGLE_CODE, RECTANGLE_CODE = 0.9, 0.45  # Table 3.1

# A gauge that reads only the load is one at infinity. The search ends at this many lengths of the
# beam, where the arm changes by 0.4 % over the whole working range.
FARTHEST = 100.0

RECORDED = ROOT / "scenes" / "data" / "appendix2.csv"
SENSORS = ("sensor1", "sensor2", "sensor3", "sensor4")


def loads_from_codes(codes: ArrayLike, beam: Beam) -> Loads:
    """The loads on the beam for coded targets (load, position, width, shape; Table 3.1).

    codes, shape (..., 4): 0.9 means 23 g, 127 mm from the tip, and a width of 50.8 mm
        (``golden.numbers.units``).
    """
    load, position, width, shape = np.moveaxis(np.asarray(codes, dtype=np.float64), -1, 0)
    return Loads(
        load / FULL_SCALE * LOAD_G / 1e3,
        beam.length - position / FULL_SCALE * POSITION_MM / 1e3,
        width / FULL_SCALE * WIDTH_MM / 2e3,
        shape > (TRIANGLE_CODE + RECTANGLE_CODE) / 2,
    )


def fit_sensor(volts: Real, loads: Loads, beam: Beam) -> StrainSensor:
    """Gain, offset and position with which equation 3.9 fits recorded readings best.

    It is a least-squares fit over all readings. For each position, gain and offset follow from a
    linear solution, so SciPy searches only the position, starting from the root.
    """

    def solved(nearness: Real) -> StrainSensor:
        """The fit at length (1 - 1 / nearness): 1 is the root, and 0 is infinitely far outside."""
        position = beam.length * (1 - 1 / float(nearness[0]))
        unit = StrainSensor(1.0, 0.0, position, beam).read(loads)
        matrix = np.stack([unit, np.ones_like(unit)], axis=1)
        # The readings of a distant gauge are huge. Columns of similar size keep the solution
        # accurate.
        scale = np.maximum(np.abs(matrix).max(axis=0), np.finfo(np.float64).tiny)
        gain, offset = np.linalg.lstsq(matrix / scale, volts)[0] / scale
        return StrainSensor(float(gain), float(offset), position, beam)

    last = 0.99 * loads.position.max()
    ends = 1 / FARTHEST, beam.length / (beam.length - last)
    found = least_squares(lambda u: solved(u).read(loads) - volts, [1.0], bounds=ends)
    return solved(found.x)


def fit_sensors(table: Real, beam: Beam) -> list[StrainSensor]:
    """Fit each sensor.

    table, shape (rows, sensors + 4): Readings, then load, position, width and shape as coded
        targets.
    """
    loads = loads_from_codes(table[:, -len(COLUMNS) :], beam)
    return [fit_sensor(column, loads, beam) for column in table[:, : -len(COLUMNS)].T]


def read_sensors(sensors: Sequence[StrainSensor], loads: Loads) -> Real:
    """Readings of all sensors, shape (n, sensors)."""
    return np.stack([sensor.read(loads) for sensor in sensors], axis=-1)
