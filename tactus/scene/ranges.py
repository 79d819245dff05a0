"""The readings that the first and the last code stand for, and so the range of a converter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from golden.numbers.precision import SIGNAL
from tactus.scene.scale import readings

if TYPE_CHECKING:
    from tactus.scene.scene import Scene


def ranges(scene: Scene) -> list[str]:
    """A line for each sensor and output that has a scale or a unit.

    Neighbouring columns of the same scale and unit share a line.
    """
    ends = SIGNAL.to_real(np.array([[SIGNAL.low], [SIGNAL.high]]))
    found: list[tuple[str, list[str], str]] = []
    for kind, columns in (("sensor", scene.sensors), ("output", scene.outputs)):
        for name, scale in zip(columns, scene.scales(columns), strict=True):
            if name in scene.known_scales or name in scene.units:
                low, high = readings(ends, [scale]).ravel()
                unit = f" {scene.units[name]}" if name in scene.units else ""
                text = (
                    f"code {SIGNAL.low} is {low:.6g}{unit}, {SIGNAL.high} is {high:.6g}{unit}, "
                    f"one code {scale.factor / (1 << SIGNAL.frac):.6g}{unit}"
                )
                if found and found[-1][::2] == (kind, text):
                    found[-1][1].append(name)
                else:
                    found.append((kind, [name], text))
    return [
        f"{kind} {names[0]}: {text}"
        if len(names) == 1
        else f"{kind}s {names[0]} to {names[-1]}: {text}"
        for kind, names, text in found
    ]
