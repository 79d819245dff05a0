"""What the tests of one run make once and share, whichever worker makes it."""

from __future__ import annotations

import fcntl
import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from golden.files import read_kept, write_kept
from golden.scene import Scene, load_scene
from golden.store import VARIABLE
from tb.common.collected import CASES, CASES_OF
from tb.common.runner import Job, Outcome, compile_vhdl, export, jobs, run_jobs
from tb.common.tools import language
from tb.report.measure import recorded, store
from tb.report.measure.registry import TABLES
from tb.report.measure.steps import measured
from tb.report.measure.table import Table
from tb.sign_off.subject import first

# A worker of several does one thing at a time: the others have the other cores.
AT_ONCE = 1 if "PYTEST_XDIST_WORKER" in os.environ else os.cpu_count() or 1


class Shared:
    """A folder of the run; each part is made by the first test that asks for it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.build = folder / "build"

    @contextmanager
    def alone(self, name: str) -> Iterator[Path]:
        """One process at a time is in here; yields what to touch when the part is made."""
        made = self.folder / "made" / name.replace("/", "-")
        made.parent.mkdir(parents=True, exist_ok=True)
        with made.with_name(f"{made.name}.lock").open("w") as handle:
            fcntl.flock(handle, fcntl.LOCK_EX)
            yield made

    def once(self, name: str, make: Callable[[], object]) -> None:
        """Make a part, unless another test of this run has."""
        with self.alone(name) as made:
            if not made.exists():
                make()
                made.touch()

    def scene(self, name: str) -> Scene:
        """A case's scene by the case's name, or a shipped scene."""
        if name not in CASES:
            return load_scene(name)
        folder = self.folder / "scenes"
        folder.mkdir(parents=True, exist_ok=True)
        self.once(f"scene {name}", lambda: CASES[name].scene(folder, name))
        return load_scene(str(folder / f"{name}.toml"))

    def export(self, name: str, tongue: str) -> Path:
        """The folder with a scene's VHDL or Verilog, not to be changed."""
        scene = self.scene(name)
        self.once(f"{name} {tongue}", lambda: export(scene, tongue, self.build))
        return self.build / scene.name / tongue

    def jobs(self, name: str, simulator: str) -> list[Job]:
        """A scene's benches in a simulator, on those exports."""
        self.export(name, language(simulator))
        scene = self.scene(name)
        if simulator == "ghdl":
            self.once(f"{name} library", lambda: compile_vhdl(scene, self.build))
        return jobs(scene, simulator, build=self.build)

    def subject(self, block: str, simulator: str = "icarus", case: str | None = None) -> Job:
        """The entity that stands for a block, as in ``tb.sign_off.subject``, on those exports."""
        return first(self.jobs(case or CASES_OF[block][0], simulator), block)

    def recorded(self, name: str, anew: bool) -> Table:
        """A table that reports take as recorded, or as it is measured now."""
        if not anew:
            return recorded.read(name)
        path = self.folder / f"{name}.json"
        self.once(
            f"measured {name}",
            lambda: write_kept(path, store.packed(TABLES[name](recorded.SEED))),
        )
        return store.unpacked(read_kept(path))

    def tables(self) -> dict[str, Table]:
        """Every table of the report, measured once in the run and in no earlier one."""
        with self.alone("tables"), self.own_store():
            return measured(lambda *_: None)

    @contextmanager
    def own_store(self) -> Iterator[None]:
        """In here the store is one of the run, in which nothing of an earlier run stands."""
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv(VARIABLE, str(self.folder / "store"))
            yield

    def run(self, planned: list[Job]) -> list[Outcome]:
        """Run jobs, side by side where no other worker has the cores."""
        return run_jobs(planned, lambda _: None, AT_ONCE)


def copied_job(job: Job, folder: Path) -> Job:
    """The same bench on files of its own, which may be changed."""
    copied = replace(job, build=folder)
    for name in job.files:
        (copied.hdl_folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(job.hdl_folder / name, copied.hdl_folder / name)
    return copied
