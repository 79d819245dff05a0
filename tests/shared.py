"""What the tests of one run make once and share between all workers."""

import fcntl
import os
import re
import shutil
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import replace
from io import StringIO
from pathlib import Path
from subprocess import CompletedProcess

import numpy as np
import pytest
from myhdl import Simulation, delay, instance

from golden.common.block import Block
from hdl.common.lookup import hardware
from tactus.core.fingerprint import ROOT
from tactus.core.store import VARIABLE
from tactus.export.command import BOTH, export_scene
from tactus.export.hierarchy import LANGUAGES, port_signals
from tactus.scene import Scene, load_scene
from tactus.verify.benches.collected import CASES, CASES_OF
from tactus.verify.benches.runner import Job, Outcome, compile_vhdl, export, jobs, library, run_jobs
from tactus.verify.benches.tools import language
from tactus.verify.benches.written import scene_of
from tactus.verify.sign_off.record import first

# If there are several workers, each does one thing at a time, because the others use the cores.
AT_ONCE = 1 if "PYTEST_XDIST_WORKER" in os.environ else os.cpu_count() or 1
# Before the name of a module with a command, and its words.
CALL = (sys.executable, "-m", "tactus.cli.call")


class Shared:
    """A folder of the run. The first test that needs a part of it makes the part."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.build = folder / "build"
        # A scene builds its twin once; hundreds of tests of a worker ask for the same few.
        self._scenes: dict[str, Scene] = {}
        self._jobs: dict[tuple[str, str], list[Job]] = {}

    @contextmanager
    def alone(self, name: str) -> Iterator[Path]:
        """Let one process at a time make a part.

        It touches the yielded file when the part is made.
        """
        made = self.folder / "made" / name.replace("/", "-")
        made.parent.mkdir(parents=True, exist_ok=True)
        with made.with_name(f"{made.name}.lock").open("w") as handle:
            fcntl.flock(handle, fcntl.LOCK_EX)
            yield made

    def once(self, name: str, make: Callable[[], object]) -> None:
        """Make a part, unless another test of this run has made it."""
        with self.alone(name) as made:
            if not made.exists():
                make()
                made.touch()

    def scene(self, name: str) -> Scene:
        """The scene of a case, by its name, or a shipped scene. Tests must not change it."""
        if name not in self._scenes:
            self._scenes[name] = load_scene(self._path(name))
        return self._scenes[name]

    def _path(self, name: str) -> str:
        if name not in CASES:
            return name
        folder = self.folder / "scenes"
        folder.mkdir(parents=True, exist_ok=True)
        self.once(f"scene {name}", lambda: scene_of(CASES[name], folder, name))
        return str(folder / f"{name}.toml")

    def export(self, name: str, tongue: str) -> Path:
        """The folder with the VHDL or Verilog of a scene. Tests must not change it."""
        scene = self.scene(name)
        # A case is simulated in both languages. Most tests of a shipped scene need only one.
        wanted = BOTH if name in CASES else tongue
        self.once(f"{name} {wanted}", lambda: self._export(scene, wanted))
        return self.build / scene.name / tongue

    def _export(self, scene: Scene, tongue: str) -> None:
        """Export here, if this process began with the hash seed that MyHDL needs.

        Its facts and warnings are no output of the test that happens to run.
        """
        if sys.flags.hash_randomization:
            export(scene, tongue, self.build)
            return
        with redirect_stdout(StringIO()), redirect_stderr(StringIO()), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            for one in LANGUAGES if tongue == BOTH else [tongue]:
                export_scene(scene, one, self.build / scene.name / one)

    def jobs(self, name: str, simulator: str) -> list[Job]:
        """The benches of a scene in a simulator, on the shared exports, for ``run``."""
        if (name, simulator) not in self._jobs:
            self.export(name, language(simulator))
            self._jobs[name, simulator] = jobs(self.scene(name), simulator, build=self.build)
        return self._jobs[name, simulator]

    def library(self, name: str) -> Path:
        """The folder into which GHDL compiled the VHDL of a scene. Tests must not change it."""
        self.export(name, "vhdl")
        return self._library(self.scene(name))

    def _library(self, scene: Scene) -> Path:
        self.once(f"{scene.name} library", lambda: compile_vhdl(scene, self.build))
        return library(scene, self.build)

    def subject(self, block: str, case: str | None = None, simulator: str = "icarus") -> Job:
        """The entity that represents a block (``tactus.verify.sign_off.record``), on the shared
        exports."""
        return first(self.jobs(case or CASES_OF[block][0], simulator), block)

    @contextmanager
    def own_store(self) -> Iterator[None]:
        """Use a store of this run, which holds nothing of an earlier run."""
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv(VARIABLE, str(self.folder / "store"))
            yield

    def run(self, planned: list[Job]) -> list[Outcome]:
        """Run jobs, side by side if no other worker uses the cores."""
        for job in planned:
            if job.simulator == "ghdl":
                self._library(job.scene)
        return run_jobs(planned, AT_ONCE)


def run(*words: str | Path, folder: Path = ROOT, **variables: str) -> CompletedProcess[str]:
    """What a program prints and how it ends, with more variables in its environment."""
    environment = os.environ | variables
    return subprocess.run(
        words, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


def browse(page: str, folder: Path, *options: str) -> str:
    """What a browser prints of a page, by default its elements after two seconds of its clock."""
    command = ["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"]
    # No host name resolves, so that nothing can be loaded from a network.
    command += ["--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"]
    command += [f"--user-data-dir={folder / 'browser'}", "--virtual-time-budget=2000"]
    done = run("timeout", "120", "chromium", *command, *(options or ["--dump-dom"]), page)
    assert done.returncode == 0, done.stderr
    return done.stdout


def copied_job(job: Job, folder: Path) -> Job:
    """The same bench on a copy of its files, which may be changed."""
    copied = replace(job, build=folder)
    for name in job.files:
        (copied.hdl_folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(job.hdl_folder / name, copied.hdl_folder / name)
    return copied


def printed(folder: Path, text: str) -> list[str]:
    """The words that some Verilog prints."""
    (folder / "text.v").write_text(text)
    run("iverilog", "-g2012", "-o", "text", "text.v", folder=folder)
    return run("vvp", "-n", "text", folder=folder).stdout.split()


# What Python writes while it compiles a module: it may be gone before it is copied.
UNFINISHED = shutil.ignore_patterns("*.pyc.*")


def copy_room(room: str, folder: Path) -> None:
    """Copy a room into a folder with what Python has compiled of it already."""
    shutil.copytree(ROOT / room, folder / room, ignore=UNFINISHED)


def movable(path: Path) -> str:
    """The text of a scene, which names its data and its weights wherever it is written to."""
    return re.sub(
        r'"([^"\n]+\.(?:csv|npz)(?:/\w+)?)"',
        lambda found: f'"{(path.parent / found[1]).resolve()}"',
        path.read_text(),
    )


def in_myhdl(
    spec: Block, inputs: Sequence[str], outputs: Sequence[str], rows: Iterable[Sequence[int]]
) -> np.ndarray:
    """The outputs of MyHDL itself, which checks the bounds of every signal.

    rows: The inputs in each clock. The outputs are those that belong to them.
    """
    arguments, seen = port_signals(spec), []
    ports = {
        f"{name.rstrip('_')}_{field}": one
        for name, group in arguments.items()
        for field, one in getattr(group, "__dict__", {}).items()
    }
    ports |= arguments

    @instance
    def drive():
        for row in rows:
            for name, value in zip(inputs, row, strict=True):
                ports[name].next = value
            yield delay(1)
            seen.append([int(ports[name]) for name in outputs])
            ports["clk"].next = True
            yield delay(1)
            ports["clk"].next = False

    Simulation(drive, hardware(spec)(**arguments, spec=spec)).run(quiet=1)
    return np.array(seen)
