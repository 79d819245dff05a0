"""The time that the 25 Hz low pass behind the gauges takes, and the noise that it removes."""

from golden.numbers.precision import SIGNAL
from golden.numbers.units import FULL_SCALE
from tactus.physics.conditioning import LowPass
from tactus.report.measure.table import Cell, Table
from tactus.scene import load_scene

SCENE = "digit"
# A step is over when half a code is left of the largest step, from no load to full scale.
HALF_A_CODE = SIGNAL.to_real([1])[0] / 2 / FULL_SCALE
PARTS = {"10 %": 0.1, "1 %": 0.01, "0.1 %": 0.001, "half a code": float(HALF_A_CODE)}


def low_pass(_: int) -> Table:
    """How long a step takes to pass, and what the hardware of the scene does in this time."""
    scene, filtered = load_scene(SCENE), LowPass()
    frames = 1e6 * scene.clock_mhz / scene.twin().interval
    rows: list[list[Cell]] = []
    for name, part in PARTS.items():
        seconds = filtered.settling(part)
        rows.append([name, 1e3 * seconds, round(seconds * filtered.rate), round(seconds * frames)])
    return Table(
        "low_pass",
        ["left of a step", "ms", "scans meanwhile", f"frames of {SCENE} meanwhile"],
        rows,
        f"The low-pass is of first order with {filtered.cutoff:g} Hz (section 3.6), at "
        f"{filtered.rate:,.0f} scans a second. Noise that is white from scan to scan keeps "
        f"{100 * filtered.noise_left:.1f} % of its standard deviation.",
    )
