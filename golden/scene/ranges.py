"""The readings that the first and the last code stand for, and so the range of a converter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from golden.precision import SIGNAL
from golden.scene.scale import readings

if TYPE_CHECKING:
    from golden.scene.scene import Scene


def ranges(scene: Scene) -> list[str]:
    """A line for each sensor and output that has a scale or a unit."""
    ends = SIGNAL.to_real(np.array([[SIGNAL.low], [SIGNAL.high]]))
    lines = []
    for kind, columns in (("sensor", scene.sensors), ("output", scene.outputs)):
        for name, scale in zip(columns, scene.scales(columns), strict=True):
            if name in scene.known_scales or name in scene.units:
                low, high = readings(ends, [scale]).ravel()
                unit = f" {scene.units[name]}" if name in scene.units else ""
                lines.append(
                    f"{kind} {name}: code {SIGNAL.low} is {low:.6g}{unit}, {SIGNAL.high} is "
                    f"{high:.6g}{unit}, one code {scale.factor / (1 << SIGNAL.frac):.6g}{unit}"
                )
    return lines
