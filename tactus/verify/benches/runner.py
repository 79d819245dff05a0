"""Runs benches: exports the scene, builds, simulates, and counts what was compared.

Each bench runs on the exported files themselves, with the entity under test as top. It has a build
folder and a simulator process of its own.
"""

import json
import os
import pickle
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field, replace
from importlib import import_module
from pathlib import Path
from typing import Any

from golden.common.block import Block, parts_of, walk
from golden.input_error import InputError
from tactus.core.cli import HASH_SEED
from tactus.core.files import replace_folder, writing
from tactus.core.fingerprint import ROOT, fingerprint
from tactus.core.folders import BUILD
from tactus.core.progress import Progress
from tactus.export.exporter import MANIFEST, compile_order
from tactus.scene import FOLDER, Scene, load_scene, scene_path
from tactus.verify.benches.blocks import check_block
from tactus.verify.benches.simulate import analyse, simulate
from tactus.verify.benches.tools import SIMULATORS, check_simulator, language
from tb.common.bench import CONFIGURATION
from tb.common.bench_input import BenchInput
from tb.common.coverage import Counts, add, missing

STAND_IN = ROOT / "tb" / "common" / "stand_in"
SEED = 1
# How many random frames the bench of a network plays.
FRAMES = 100
# With fewer bytes left on a disk, tools may have failed for this reason, and do not always say so.
ROOM = 1 << 20


@dataclass(frozen=True)
class Job:
    """The bench of one entity under one simulator, with all of its tests or the one named ``test``.

    It runs on the exported files, or on the form of them that ``form`` names, such as the cells of
    a family. With ``trace`` the bench writes what it drove, what it recorded, and what it read.
    """

    scene: Scene
    entity: str
    block: str
    area: str
    files: tuple[str, ...]
    simulator: str
    seed: int = SEED
    waves: bool = False
    build: Path = BUILD
    frames: int = FRAMES
    test: str = ""
    form: str = ""
    trace: bool = False

    @property
    def folder(self) -> Path:
        """The folder of its build and its log."""
        return self.build / self.scene.name / "sim" / self.runs_on / self.entity

    @property
    def runs_on(self) -> str:
        """The form, or else the simulator whose exported files are used."""
        return self.form or self.simulator

    @property
    def hdl_folder(self) -> Path:
        return self.build / self.scene.name / (self.form or language(self.simulator))

    @property
    def result_file(self) -> Path:
        """The file in which each test of the bench notes what it compared."""
        return self.folder / "compared.jsonl"

    @property
    def trace_file(self) -> Path:
        return self.folder / "trace.jsonl"

    @property
    def twin(self) -> Block:
        return next(part for part in walk(self.scene.twin()) if part.entity == self.entity)


@dataclass(frozen=True)
class Outcome:
    job: Job
    passed: bool
    compared: int
    seconds: float
    facts: dict[str, Any] = field(default_factory=dict)

    @property
    def log(self) -> Path:
        return self.job.folder / "log.txt"

    def complaint(self) -> str:
        """The line of the log that says what went wrong."""
        text = self.log.read_text(encoding="utf-8", errors="replace") if self.log.exists() else ""
        marks = ("Error: ", "error: ", "FATAL: ")
        marked = [line for line in text.splitlines() if any(mark in line for mark in marks)]
        return marked[0].strip() if marked else "no message"


def ready_scene(name: str) -> Scene:
    """The scene of that name, after a check that simulators and recorded vectors exist."""
    scene = load_scene(name)
    for simulator in SIMULATORS:
        check_simulator(simulator)
    scene.vectors()
    return scene


def export(scene: Scene, tongue: str, build: Path = BUILD) -> None:
    """Export the scene in a fresh process that begins with the hash seed the exporter wants."""
    command = [sys.executable, "-m", "tactus.cli.call", "tactus.export.command"]
    command += [str(scene.path.resolve()), tongue, "--build", str(build.resolve())]
    # So it need not start itself a second time.
    environment = os.environ | HASH_SEED
    result = subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )
    if result.returncode == 2:
        # There may be warnings before the message.
        raise InputError(re.split("^error: ", result.stderr, maxsplit=1, flags=re.M)[-1].strip())
    if result.returncode:
        raise RuntimeError(f"{shlex.join(command)}\n{result.stderr}")


def library(scene: Scene, build: Path = BUILD) -> Path:
    """The folder into which the exported VHDL of a scene is compiled."""
    return build / scene.name / "sim" / "ghdl" / "library"


def compile_vhdl(scene: Scene, build: Path = BUILD) -> None:
    """Compile the exported VHDL of a scene, once for the benches of all its entities."""
    folder = build / scene.name / language("ghdl")
    with replace_folder(library(scene, build)) as temporary:
        analyse([folder / name for name in compile_order(folder)], temporary)


def prepare(scene: Scene, simulator: str, build: Path = BUILD) -> None:
    """Export the language that a simulator reads, and compile it if it is VHDL."""
    export(scene, language(simulator), build)
    if simulator == "ghdl":
        compile_vhdl(scene, build)


def plan(
    scene: Scene,
    simulators: Iterable[str],
    block: str | None = None,
    build: Path = BUILD,
) -> list[Job]:
    """Export what is needed, and list the jobs for every entity of ``block`` or of all blocks."""
    simulators = list(simulators)
    for simulator in simulators:
        check_simulator(simulator)
    check_block(scene, block)
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        list(pool.map(lambda name: prepare(scene, name, build), simulators))
    return [
        job
        for simulator in simulators
        for job in jobs(scene, simulator, build)
        if block in (None, job.block)
    ]


def jobs(scene: Scene, simulator: str, build: Path = BUILD) -> list[Job]:
    """The jobs of every entity of a scene that is exported into ``build``, the largest first.

    So the last job to finish is a short one. Parts of blocks have none.
    """
    parts = {part.entity: part for part in walk(scene.twin())}
    folder = build / scene.name / language(simulator)
    manifest = json.loads((folder / MANIFEST).read_text())
    order = compile_order(folder)
    return [
        Job(
            scene,
            entry["entity"],
            entry["block"],
            entry["area"],
            _needed(order, manifest, parts[entry["entity"]]),
            simulator,
            build=build,
        )
        for entry in reversed(manifest)
        if not parts[entry["entity"]].part_of
    ]


def _needed(order: list[str], manifest: list[dict[str, Any]], part: Block) -> tuple[str, ...]:
    """The files of ``part`` and of what it contains, in compile order, with the package."""
    entities = {block.entity for block in walk(part)}
    others = {entry["file"] for entry in manifest if entry["entity"] not in entities}
    return tuple(name for name in order if name not in others)


def with_parts(job: Job) -> list[Job]:
    """The job of a block, and one for each of the parts that are judged with it."""
    inside = {block.entity for block in walk(job.twin)}

    def of(part: Block) -> Job:
        others = inside - {block.entity for block in walk(part)}
        files = tuple(name for name in job.files if Path(name).stem not in others)
        return replace(job, entity=part.entity, block=part.block, area=part.area, files=files)

    return [job, *map(of, parts_of(job.twin))]


def shipped_for(job: Job) -> list[Scene]:
    """The shipped scenes that a bench plays besides the one that it runs in."""
    bench = import_module(f"tb.{job.area}.tb_{job.block}")
    return [load_scene(name) for name in getattr(bench, "SCENES", ())]


def bench_input(scene: Scene, shipped: Iterable[Scene] = ()) -> BenchInput:
    """What a bench is given of its scene and of shipped ones."""
    return BenchInput(
        scene.name,
        scene.twin(),
        scene.vectors().recordings,
        scene.window,
        tuple(scene.networks()),
        scene.arrangement,
        scene.settings().met,
        tuple(map(bench_input, shipped)),
    )


def run_job(job: Job) -> Outcome:
    shutil.rmtree(job.folder, ignore_errors=True)
    # The file from which the bench gets the twin and the recorded frames.
    given = job.folder / "given.pickle"
    with writing(job.folder):
        job.folder.mkdir(parents=True)
        given.write_bytes(pickle.dumps(bench_input(job.scene, shipped_for(job))))
    how = f"NETLIST={job.form}" if job.form else f"SIM={job.simulator}"
    rerun = f"make sim BLOCK={job.block} {how} {scene_variable(job.scene)}"
    if job.frames != FRAMES:
        rerun += f" FRAMES={job.frames}"
    configuration = {
        "scene": str(job.scene.path.resolve()),
        "given": str(given.resolve()),
        "entity": job.entity,
        "frames": job.frames,
        "result": str(job.result_file.resolve()),
        "trace": str(job.trace_file.resolve()) if job.trace else "",
        "rerun": f"{rerun} SEED={job.seed}",
    }
    # An inherited variable could change what the bench does.
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("COCOTB", "TACTUS"))}
    environment |= {
        CONFIGURATION: json.dumps(configuration),
        "COCOTB_RANDOM_SEED": str(job.seed),
        "COCOTB_TEST_FILTER": f"\\.{job.test}$" if job.test else "",
        "PYTHONPATH": os.pathsep.join([str(STAND_IN), str(ROOT)]),
        # One failed test decides the result.
        "COCOTB_MAX_FAILURES": "1",
        # numpy gets one thread, because as many simulations run as there are cores.
        "OPENBLAS_NUM_THREADS": "1",
    }
    started = time.perf_counter()
    sound = simulate(
        job.simulator,
        job.entity,
        f"tb.{job.area}.tb_{job.block}",
        [(job.hdl_folder / name).resolve() for name in job.files],
        library(job.scene, job.build).resolve(),
        (job.folder / "build").resolve(),
        job.waves,
        environment,
        job.folder / "log.txt",
    )
    # The recorded frames in it would fill the disk if there are many entities.
    given.unlink()
    outcome = read_outcome(job, sound, time.perf_counter() - started)
    # Such a failure must neither count against the hardware nor as the detection of a fault.
    for place in () if outcome.passed else (job.folder, Path(tempfile.gettempdir())):
        if shutil.disk_usage(place).free < ROOM:
            raise InputError(
                f"{place}: the disk is full, so nothing is known of {job.entity} in "
                f"{job.runs_on}; expected {ROOM >> 20} MB or more that are free"
            )
    if outcome.passed and not job.test:
        return replace(outcome, passed=_covered(job, outcome.facts["coverage"]))
    return outcome


def read_outcome(job: Job, sound: bool, seconds: float) -> Outcome:
    """The result that the tests of a bench have written; ``sound`` says that the simulator
    succeeded.

    A run that compared nothing has failed, whatever its tests say.
    """
    result = job.result_file
    written = result.read_text(encoding="utf-8") if result.exists() else ""
    lines = [json.loads(line) for line in written.splitlines()]
    compared = sum(line.pop("compared") for line in lines)
    coverage: Counts = {}
    # For each test: a digest of what it drove, what it read and how much it compared.
    played: dict[str, str] = {}
    for line in lines:
        add(coverage, line.pop("coverage"))
        for test, found in line.pop("played").items():
            played[test] = fingerprint([], played[test], found) if test in played else found
    facts = {key: value for line in lines for key, value in line.items()}
    facts |= {"coverage": coverage, "played": played}
    return Outcome(job, sound and compared > 0, compared, seconds, facts)


def _covered(job: Job, coverage: Counts) -> bool:
    """Whether the tests reached everything that the twin names; the log gets what they missed."""
    lacking = missing(job.twin, coverage)
    with (job.folder / "log.txt").open("a", encoding="utf-8") as log:
        log.writelines(f"Error: {job.entity}: not driven: {what}\n" for what in lacking)
    return not lacking


def scene_variable(scene: Scene) -> str:
    """SCENE= as a shell takes it: a shipped scene by its folder, any other by its file."""
    folder = scene.path.parent
    name = folder.relative_to(FOLDER).as_posix() if folder.is_relative_to(FOLDER) else ""
    shipped = name and scene.path == scene_path(name)
    return f"SCENE={shlex.quote(name if shipped else str(scene.path))}"


def run_jobs(
    jobs: list[Job],
    at_once: int | None = None,
    work: Callable[[Job], Outcome] = run_job,
    listen: Callable[[Outcome], None] = lambda _: None,
) -> list[Outcome]:
    """Run all jobs, as many at a time as there are cores, and return their outcomes in that order.

    ``listen`` is called for each outcome in the moment in which it is there, in whatever order.
    """
    with ThreadPoolExecutor(at_once or os.cpu_count() or 1) as pool:
        running = [pool.submit(work, job) for job in jobs]
        try:
            for future in as_completed(running):
                listen(future.result())
        finally:
            # After an error, or when the user stops the command, no other job begins.
            pool.shutdown(cancel_futures=True)
    return [future.result() for future in running]


def run_shown(
    title: str, jobs: list[Job], work: Callable[[Job], Outcome], every: bool = True
) -> list[Outcome]:
    """Run all jobs as ``run_jobs`` does, and print the progress, with a line for ``every`` outcome
    or for the failures alone."""
    with Progress(title, len(jobs), "benches") as progress:

        def listen(outcome: Outcome) -> None:
            job, verdict = outcome.job, "pass" if outcome.passed else "FAIL"
            if every or not outcome.passed:
                progress.say(
                    f"{verdict}  {job.runs_on:8}  {job.entity:28} "
                    f"{outcome.compared:8} compared  {outcome.seconds:6.1f} s"
                )
            if not outcome.passed:
                progress.say(f"      {outcome.complaint()}\n      log: {outcome.log}")
            progress.step()

        def named(job: Job) -> Outcome:
            with progress.running(f"{job.entity} on {job.runs_on}"):
                return work(job)

        return run_jobs(jobs, work=named, listen=listen)
