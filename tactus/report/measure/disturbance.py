"""How noise and drift of the sensors change the errors."""

from collections.abc import Iterator

from tactus.errors import FRAMES, disturbed_errors, full_scale_of
from tactus.report.measure.table import Cell, Table
from tactus.scene import Scene
from tactus.scene.disturbance import Disturbance

# For each field of ``Disturbance``: its name for a reader, and its sizes. Those of noise and offset
# are parts of the full scale of a reading.
KINDS: dict[str, tuple[str, tuple[float, ...]]] = {
    "noise": ("noise", (0.0005, 0.001, 0.002, 0.004, 0.008)),
    "gain": ("gain drift", (0.002, 0.005, 0.01, 0.02, 0.03)),
    "offset": ("offset drift", (0.001, 0.002, 0.005, 0.01, 0.02)),
}
NONE = "as recorded"
MEANING = (
    "The figures are bit-true mean errors in percent on all recorded rows, with disturbed "
    "readings. Sizes are standard deviations. Those of noise and offsets are in the unit of the "
    "readings, so that 0.001 is 1 mV of a volt; those of gains are a part of the reading. Noise "
    "differs from reading to reading, and the drift of gain or offset from sensor to sensor. All "
    f"rows are drawn repeatedly, until there are {FRAMES:,} frames or more, each with a drift of "
    "its own."
)


def disturbances(full_scale: float) -> Iterator[tuple[str, float, Disturbance]]:
    """Every kind and size of disturbance for a full scale, beginning with none."""
    yield NONE, 0.0, Disturbance()
    for key, (kind, parts) in KINDS.items():
        for part in parts:
            size = part if key == "gain" else float(f"{part * full_scale:.6g}")
            yield kind, size, Disturbance(**{key: size})


def noise_and_drift(scene: Scene, seed: int) -> Table:
    """The table of one scene, with a row for each disturbance and a column for each output."""
    columns = ["disturbance", "size", *(f"{name} %" for name in scene.outputs)]
    rows: list[list[Cell]] = [
        [kind, size, *disturbed_errors(scene, disturbance, seed)]
        for kind, size, disturbance in disturbances(full_scale_of(scene))
    ]
    return Table("noise_and_drift", columns, rows, MEANING)
