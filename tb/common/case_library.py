"""Cases that several benches share: the groups of ``cases.toml``."""

import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from golden.trained.dense import Quantiser
from golden.trained.window import Window
from tb.common.cases import FRONT_END, VISUALISATION, Case

# They are computed without a library, so that every machine has the same tables. The first is odd,
# and the second needs words for negative sums too.
FUNCTIONS = {"soft": "x / (1 + abs(x))", "bell": "1 / (1 + x * x)"}
GROUPS = tomllib.loads(Path(__file__).with_name("cases.toml").read_text(encoding="utf-8"))
MADE: dict[str, Callable[[Any], Any]] = {
    "shapes": lambda shapes: [tuple(shape) for shape in shapes],
    "activations": tuple,
    "functions": lambda names: tuple((name, FUNCTIONS[name]) for name in names),
    "quantiser": lambda fields: Quantiser(*fields),
    "sections": lambda text: text.format(visualisation=VISUALISATION, front_end=FRONT_END),
    "window": lambda delays: Window(tuple(map(tuple, delays))),
}


def _every() -> dict[str, Case]:
    found: dict[str, Case] = {}
    for group in GROUPS.values():
        for name, row in group.items():
            fields: dict[str, Any] = {
                key: MADE[key](value) if key in MADE else value for key, value in row.items()
            }
            of = fields.pop("of", None)
            found[name] = replace(found[of], **fields) if of else Case(**fields)
    return found


CASE = _every()


def cases(*names: str) -> dict[str, Case]:
    """The cases of these groups, or of these names."""
    return {case: CASE[case] for name in names for case in GROUPS.get(name, [name])}
