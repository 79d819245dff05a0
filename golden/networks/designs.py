"""The designs that a scene can name: every subclass of ``Design`` in this package."""

from __future__ import annotations

import pkgutil
from importlib import import_module
from pathlib import Path

from golden.networks.design import Design


def _found() -> dict[str, type[Design]]:
    designs: dict[str, type[Design]] = {}
    for module in pkgutil.iter_modules([str(Path(__file__).parent)]):
        if module.name == "designs":
            continue
        for value in vars(import_module(f"golden.networks.{module.name}")).values():
            # A design's block is its module's name; an imported design is met in its own module.
            if isinstance(value, type) and issubclass(value, Design) and value.block == module.name:
                designs[value.block] = value
    return designs


# By name, in the order of the alphabet.
DESIGNS = _found()
