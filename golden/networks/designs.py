"""The designs that a scene can name: all subclasses of ``Design`` in this package."""

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
            # The block of a design is its module's name. An imported design is found in its own
            # module. One without arrangements is built by another design.
            if not (isinstance(value, type) and issubclass(value, Design) and value.arrangements):
                continue
            if value.block == module.name:
                designs[value.block] = value
    return designs


# By name, in alphabetical order.
DESIGNS = _found()
