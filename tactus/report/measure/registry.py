"""The tables of ``make figures``: each function of this package that makes a table of a seed.

To add a table, write such a function; its name is that of the table.
"""

import inspect
import pkgutil
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType

from tactus.report.measure.table import Table

Measured = Callable[[int], Table]
# These modules import this one.
ASKING = ("__main__", "registry", "steps")


def _found() -> dict[str, Measured]:
    package = __name__.rpartition(".")[0]
    names = [module.name for module in pkgutil.iter_modules([str(Path(__file__).parent)])]
    modules = [import_module(f"{package}.{name}") for name in names if name not in ASKING]
    return {name: table for module in modules for name, table in _tables(module)}


def _tables(module: ModuleType) -> Iterator[tuple[str, Measured]]:
    """Those that are written in a module, or in the modules of a package that shows them."""
    for name, value in vars(module).items():
        if inspect.isfunction(value) and value.__module__.startswith(module.__name__):
            signature = inspect.signature(value)
            kinds = [parameter.annotation for parameter in signature.parameters.values()]
            # A module that postpones annotations has their names.
            names = [
                getattr(kind, "__name__", kind) for kind in (*kinds, signature.return_annotation)
            ]
            if names == ["int", "Table"]:
                yield name, value


# By name, in the order printed: of the modules by the alphabet, and in each as they are written.
TABLES = _found()
