"""The benches of ``tb``, and the cases that they name."""

from importlib import import_module
from pathlib import Path

from tactus.core.fingerprint import ROOT
from tactus.core.folders import BUILD
from tactus.scene import Scene
from tactus.verify.benches.written import scene_of
from tb.common.cases import Case

BENCHES = {
    path.stem.removeprefix("tb_"): import_module(f"tb.{path.parent.name}.{path.stem}")
    for path in sorted((ROOT / "tb").glob("*/tb_*.py"))
}
# For each block: the names of its cases.
CASES_OF: dict[str, list[str]] = {
    block: list(getattr(bench, "CASES", {})) for block, bench in BENCHES.items()
}


def every_case() -> dict[str, Case]:
    """All cases by name. If two benches use a name, it must be for the same case."""
    found: dict[str, Case] = {}
    for block, bench in BENCHES.items():
        for name, case in getattr(bench, "CASES", {}).items():
            if found.setdefault(name, case) != case:
                raise ValueError(f"tb_{block}.py: CASES: {name} is another case elsewhere")
    return found


CASES = every_case()


def blocks_of(case: str) -> set[str]:
    """The blocks whose benches name a case."""
    return {block for block, names in CASES_OF.items() if case in names}


def case_scene(name: str, build: Path = BUILD) -> Scene:
    """The scene of a case, written below ``build``."""
    folder = build / "cases"
    folder.mkdir(parents=True, exist_ok=True)
    return scene_of(CASES[name], folder, name)
