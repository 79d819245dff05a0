"""``python -m tactus.physics.digit_data FILE``: vectors of a flexible digit, by its theory.

The sensors are those that fit the recorded vectors best (``strain_sensor.fit_sensors``), so a scene
can use the file in the place of appendix2.csv.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

from golden.numbers.domain import checked
from golden.numbers.real import Real
from golden.numbers.units import FULL_SCALE, LOAD_G, POSITION_MM, WIDTH_MM
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.files import check_writable
from tactus.core.fingerprint import ROOT
from tactus.core.table import read_table, write_table
from tactus.physics.beam import Beam
from tactus.physics.strain_sensor import (
    COLUMNS,
    RECTANGLE_CODE,
    TRIANGLE_CODE,
    fit_sensors,
    loads_from_codes,
    read_sensors,
)

RECORDED = ROOT / "scenes" / "data" / "appendix2.csv"
SENSORS = ("sensor1", "sensor2", "sensor3", "sensor4")

# The residual of sensor 4 after the fit. It is the only sensor that was recorded at every
# placement.
NOISE = 0.008  # V

LEAST_LOAD_G = 6.0  # Table 3.1
WIDTHS_MM = (12.7, 25.4, 38.1, 50.8)
NEAREST_MM = 6.35  # from the tip to the outer edge of a load, section 3.8.2
MOST_ROWS = 1_000_000


def digit_data(rows: int, seed: int, noise: float = NOISE) -> Real:
    """Random placements, and the readings of the four sensors for them.

    rows: 1 to a million.
    seed: 0 or more.
    noise: Standard deviation of Gaussian noise on every sensor, V, 0 to 1.

    Returns, shape (rows, 8): Sensors 1 to 4 in V, within -1 to 1. Then, as coded targets: the load
        (6 to 23 g), the position (from where the outer edge of the load is 6.35 mm from the tip, up
        to 127 mm), the width (one of the four of Table 3.1), and the shape.
    """
    checked(rows=(rows, 1, MOST_ROWS), seed=(seed, 0, 2**63), noise=(noise, 0, 1))
    rng = np.random.default_rng(seed)
    beam = Beam()
    width = rng.choice(WIDTHS_MM, rows)
    codes = np.stack(
        [
            rng.uniform(LEAST_LOAD_G, LOAD_G, rows) / LOAD_G * FULL_SCALE,
            rng.uniform(NEAREST_MM + width / 2, POSITION_MM) / POSITION_MM * FULL_SCALE,
            width / WIDTH_MM * FULL_SCALE,
            rng.choice([RECTANGLE_CODE, TRIANGLE_CODE], rows),
        ],
        axis=-1,
    )
    sensors = fit_sensors(read_table(RECORDED, [*SENSORS, *COLUMNS]), beam)
    volts = read_sensors(sensors, loads_from_codes(codes, beam))
    return np.hstack([np.clip(volts + rng.normal(0, noise, volts.shape), -1, 1), codes])


def main() -> None:
    parser = argparse.ArgumentParser(prog="tactus.physics.digit_data", description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("--rows", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--noise", type=float, default=NOISE, help="V")
    arguments = parser.parse_args()
    check_writable([arguments.file])
    stop_if_dry_run(f"write {arguments.rows} rows into {arguments.file}")
    data = digit_data(arguments.rows, arguments.seed, arguments.noise)
    write_table(arguments.file, [*SENSORS, *COLUMNS], data, 4)
    print(f"wrote {arguments.file}: {arguments.rows} rows, seed {arguments.seed}")


if __name__ == "__main__":
    sys.exit(run(main))
