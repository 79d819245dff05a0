"""The parts of a report, tables and plots as SVG, which are kept in the store or made.

The key of a part holds the code that makes it and all data that tactus ships. So nothing is
measured again when only a page of the report changes.
"""

import platform
import time
from collections.abc import Callable, Iterable
from functools import cache
from importlib.metadata import version
from typing import Any

from tactus.core import store
from tactus.core.closure import code
from tactus.core.fingerprint import ROOT, fingerprint
from tactus.report.measure.table import Table

# A function that is told the name of a part, the seconds that it took, and whether it was kept.
Progress = Callable[[str, float, bool], None]


def part_key(name: str, modules: Iterable[str], **parts: store.Part) -> store.Key:
    """The key of a part.

    modules: The modules with the functions and classes that make it.
    parts: Everything else on which the part depends.
    """
    tools = [f"{package} {version(package)}" for package in ("myhdl", "numpy", "scipy")]
    tools.append(f"python {platform.python_version()}")
    return store.key("report", name=name, code=code(modules), data=_data(), tools=tools, **parts)


@cache
def _data() -> str:
    """A digest of the data that tables read."""
    return fingerprint([ROOT / "scenes"])


def cached(asked: store.Key, tell: Progress, work: Callable[[], Any]) -> Any:
    """The result of ``work``, from the store if it is kept there."""
    name, started = asked.parts["name"], time.perf_counter()
    answer = store.read(asked)
    if answer is not None:
        tell(name, 0.0, True)
        return answer
    answer = store.write(asked, work())
    tell(name, time.perf_counter() - started, False)
    return answer


def packed(table: Table) -> dict[str, Any]:
    """A table as the store holds it: the arguments of ``Table``."""
    return {"name": table.name, **table.as_data()}
