"""What the sensors do to the errors: noise, drift of their gains, drift of their offsets."""

from __future__ import annotations

from collections.abc import Iterator

from golden.disturbance import Disturbance
from golden.errors import FRAMES, disturbed_errors
from golden.scene import Scene
from tb.report.measure.networks import scenes
from tb.report.measure.table import Cell, Table

# By the name that ``Disturbance`` has for it: how a reader names it, and its sizes.
KINDS: dict[str, tuple[str, tuple[float, ...]]] = {
    "noise": ("noise", (0.0005, 0.001, 0.002, 0.004, 0.008)),
    "gain": ("gain drift", (0.002, 0.005, 0.01, 0.02, 0.03)),
    "offset": ("offset drift", (0.001, 0.002, 0.005, 0.01, 0.02)),
}
NONE = "as recorded"
MEANING = (
    "Bit-true mean errors in percent on all recorded rows with disturbed readings. Sizes are "
    "standard deviations: of noise and offsets on signals from -1 to 1, of which 0.001 is 1 mV "
    "where 1 is a volt; of gains a part of the signal. Noise differs from reading to reading, "
    "a drift of gain or offset from sensor to sensor. All rows are drawn so many times that they "
    f"are {FRAMES:,} frames or more, each with a drift of its own."
)


def disturbances() -> Iterator[tuple[str, float, Disturbance]]:
    """Every kind and size, at first none."""
    yield NONE, 0.0, Disturbance()
    for key, (kind, sizes) in KINDS.items():
        for size in sizes:
            yield kind, size, Disturbance(**{key: size})


def disturbed(scene: Scene, seed: int) -> list[list[Cell]]:
    """Kind, size and the error of every output of a scene."""
    return [
        [kind, size, *disturbed_errors(scene, disturbance, seed)]
        for kind, size, disturbance in disturbances()
    ]


def noise_and_drift(scene: Scene, seed: int) -> Table:
    """One scene: a row a disturbance, a column an output."""
    columns = ["disturbance", "size", *(f"{name} %" for name in scene.outputs)]
    return Table("noise_and_drift", columns, disturbed(scene, seed), MEANING)


def disturbance(seed: int) -> Table:
    """Every output of every shipped scene and of those for comparison: a column a disturbance."""
    rows: list[list[Cell]] = []
    for scene in scenes():
        _, _, *errors = zip(*disturbed(scene, seed), strict=True)
        rows += [
            [scene.name, name, *found] for name, found in zip(scene.outputs, errors, strict=True)
        ]
    headings = [f"{kind} {size:g}" if size else NONE for kind, size, _ in disturbances()]
    return Table("disturbance", ["scene", "output", *headings], rows, MEANING)
