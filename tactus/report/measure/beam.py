"""The fitted sensors of the digit, beside the theory of the beam."""

import numpy as np

from tactus.core.table import read_table
from tactus.physics.beam import Beam
from tactus.physics.digit_data import RECORDED, SENSORS
from tactus.physics.strain_sensor import COLUMNS, fit_sensors, loads_from_codes, read_sensors
from tactus.report.measure.table import Row, Table


def beam(_: int) -> Table:
    """The sensor model of equation 3.9, fitted to the recorded vectors."""
    rig = Beam()
    table = read_table(RECORDED, [*SENSORS, *COLUMNS])
    loads = loads_from_codes(table[:, len(SENSORS) :], rig)
    spans = np.ptp(table[:, : len(SENSORS)], axis=0)
    rows: list[Row] = []
    for kind, spread in (("at a point", False), ("of its width", True)):
        sensors = fit_sensors(table, rig, spread)
        used = loads if spread else loads.at_points()
        residuals = read_sensors(sensors, used) - table[:, : len(SENSORS)]
        for name, sensor, residual, span in zip(SENSORS, sensors, residuals.T, spans, strict=True):
            rms = float(np.sqrt((residual**2).mean()))
            rows.append(
                {
                    "sensor": name,
                    "load": kind,
                    "gain V per strain": sensor.gain,
                    "offset V": sensor.offset,
                    "position mm": 1e3 * sensor.position,
                    "rms mV": 1e3 * rms,
                    "rms % of span": float(100 * rms / span),
                    "largest mV": float(1e3 * np.abs(residual).max()),
                }
            )
    return Table.of(
        "beam",
        rows,
        "Equation 3.9 was fitted to the 143 recorded vectors, for loads at a point (equation 3.5) "
        "and for loads spread over their width. The position is measured from the root of the beam "
        "of 228.6 mm. That of sensor 4 is the end of the search range, a hundred lengths outside: "
        "its reading grows with the load and hardly with the position, as no bending moment on "
        "this beam does.",
    )
