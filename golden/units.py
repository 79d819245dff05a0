"""The coded targets of the recorded vectors in grams and millimetres."""

import tomllib
from pathlib import Path

_FULL_SCALE = tomllib.loads(
    (Path(__file__).parent / "data" / "appendix2.toml").read_text(encoding="utf-8")
)["full_scale"]

FULL_SCALE: float = _FULL_SCALE["code"]
POSITION_MM: float = _FULL_SCALE["position_mm"]
WIDTH_MM: float = _FULL_SCALE["width_mm"]
LOAD_G: float = _FULL_SCALE["load_g"]
