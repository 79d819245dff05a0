"""The best errors that the sensors of the digit allow, beside those of its networks."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from golden.numbers.real import Real
from golden.numbers.units import FULL_SCALE, POSITION_MM
from tactus.core.table import read_table
from tactus.errors import disturbed_rows
from tactus.physics.beam import Beam
from tactus.physics.bound import UNKNOWN, least_errors, least_mean_errors
from tactus.physics.digit_data import RECORDED, SENSORS
from tactus.physics.strain_sensor import (
    COLUMNS,
    StrainSensor,
    fit_sensors,
    loads_from_codes,
    read_sensors,
)
from tactus.report.measure.table import Cell, Table
from tactus.scene import Scene, load_scene
from tactus.scene.disturbance import Disturbance
from tactus.scene.metrics import error_scale
from tactus.scene.vectors import read_recorded

SCENE = "digit"
NOISES = (0.001, 0.002, 0.008)  # V
ALONG_NOISE = 0.002  # V, for the errors along the beam
DRAWS = 20
AS_RECORDED = "as recorded"


@dataclass(frozen=True)
class Limits:
    """Errors in percent at each recorded placement, one column an output.

    bound: The bound. It is infinite if the readings do not determine the output.
    reached: The bit-true error of the scene.
    any_load, known_loads: The errors of the best estimator that knows the existing widths and
        shapes, and of the best that knows the existing loads.
    """

    bound: Real
    reached: Real
    any_load: Real
    known_loads: Real

    def rows(self, output: int, where: NDArray[np.bool_]) -> list[Cell]:
        """The number of placements, and the mean of each error over them."""
        limits = (self.bound, self.reached, self.any_load, self.known_loads)
        means = [float(errors[where, output].mean()) for errors in limits]
        return [int(where.sum()), *(m if np.isfinite(m) else None for m in means)]


@cache
def limits(noise: float | None, seed: int) -> Limits:
    """The limits at one noise of every sensor in V.

    With None, the noise is the residual of each fit.
    """
    scene = load_scene(SCENE)
    table = read_table(RECORDED, [*SENSORS, *COLUMNS])
    readings, targets = table[:, : len(SENSORS)], table[:, len(SENSORS) :]
    scale = error_scale(targets, COLUMNS, scene.full_scale)
    rng = np.random.default_rng(seed)
    beam = Beam()
    sensors = fit_sensors(table, beam)
    if noise is None:
        left = read_sensors(sensors, loads_from_codes(targets, beam)) - readings
        sigma = np.sqrt((left**2).mean(axis=0))
    else:
        sigma = np.full(len(SENSORS), noise)
    reached = disturbed_rows(scene, Disturbance(noise or 0.0), seed)
    bound = _bound(sensors, targets, sigma, scale)
    any_load, known_loads = (
        least_errors(sensors, targets, sigma, scale, known, DRAWS, rng) for known in (False, True)
    )
    return Limits(bound, reached, any_load, known_loads)


def _bound(sensors: Sequence[StrainSensor], targets: Real, sigma: Real, scale: Real) -> Real:
    """The bound of every output in percent, or infinity if the readings do not determine it."""
    bound = np.full(targets.shape, np.inf)
    unknown = slice(len(UNKNOWN))
    bound[:, unknown] = least_mean_errors(sensors, targets, sigma, scale[:, unknown])
    return bound


def bounds_of(scene: Scene, noises: Sequence[float]) -> dict[str, list[float]]:
    """The mean bounds in percent at each noise, of outputs that every row determines.

    There are none if the sensors of the scene are not those of the digit.
    """
    if scene.data_paths != (RECORDED,) or scene.sensors != SENSORS:
        return {}
    table = read_table(RECORDED, [*SENSORS, *COLUMNS])
    rows = read_recorded(scene).numbers
    sensors, targets = fit_sensors(table, Beam()), table[rows, len(SENSORS) :]
    scale = error_scale(targets, COLUMNS, scene.full_scale)
    # The bound is proportional to the noise.
    means = _bound(sensors, targets, np.ones(len(SENSORS)), scale).mean(axis=0)
    return {
        name: [float(noise * mean) for noise in noises]
        for name, mean in zip(COLUMNS, means, strict=True)
        if name in scene.outputs and np.isfinite(mean)
    }


def bounds(seed: int) -> Table:
    """The bound of every output against noise, and the error that the scene reaches."""
    rows: list[list[Cell]] = []
    for noise in (None, *NOISES):
        found = limits(noise, seed)
        for c, output in enumerate(COLUMNS):
            within = np.isfinite(found.bound[:, c])
            for said, where in (("yes", within), ("no", ~within)):
                if where.any():
                    name = AS_RECORDED if noise is None else f"{1e3 * noise:g} mV"
                    rows.append([name, output, said, *found.rows(c, where)])
    return Table(
        "bounds",
        ["noise", "output", "in the readings", "placements", *_ERRORS],
        rows,
        "The figures are mean errors in % (equation 3.16) over the recorded placements. 'Bound' is "
        "the bound of Cramer and Rao for the sensors of table beam with a known shape. It is given "
        "as the mean error of an estimator that reaches it, which is sqrt(2 / pi) of its standard "
        "deviation. At placements with 'no' in the column 'in the readings', no sensor changes "
        "with that output alone. The width changes sensor 3 where it lies under the load, and "
        "sensor 2 at the nearest placement. The shape never does while the width is unknown; seven "
        "of the eight loads are rectangles, so a guess is wrong for one. "
        f"'{SCENE}' is the scene, bit-true, on the recorded readings with that noise. 'Any load' "
        "and 'known loads' are the least mean errors, on readings of the model, of estimators that "
        "know which widths and shapes exist, and which eight loads exist. 'As recorded' treats "
        "what the fit leaves of each sensor as noise, and adds none. Most of it is not noise but "
        "the difference of this beam from theory, which is the same every time and is learnt by a "
        "network.",
    )


_ERRORS = ("bound %", f"{SCENE} %", "any load %", "known loads %")


def bound_along(seed: int) -> Table:
    """The bound and the error of the scene at one noise, against the position of the load."""
    found = limits(ALONG_NOISE, seed)
    targets = read_table(RECORDED, list(COLUMNS))
    rows: list[list[Cell]] = []
    for c, output in enumerate(COLUMNS):
        within = np.isfinite(found.bound[:, c])
        for place in np.unique(targets[:, 1]):
            for said, where in (("yes", within), ("no", ~within)):
                here = where & (targets[:, 1] == place)
                if here.any():
                    mm = float(place / FULL_SCALE * POSITION_MM)
                    rows.append([output, mm, said, *found.rows(c, here)])
    return Table(
        "bound_along",
        ["output", "position mm", "in the readings", "placements", *_ERRORS],
        rows,
        f"The table shows the figures of table bounds at {1e3 * ALONG_NOISE:g} mV along the beam. "
        "The position is measured from the tip of the beam to the middle of the load.",
    )
