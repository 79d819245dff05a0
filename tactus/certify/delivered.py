"""Writes what a certificate delivers: design, inputs, frames, proofs, script and digests; runs the
script, and the library's bench of each entity.

A bench fails where it leaves out a border, a state or a value of a port that the twin does not
declare unreachable. So one that passes has reached all of them on this very entity. Where a record
of the library is of the same bytes, it stands for the run.
"""

import hashlib
import os
import random
import shutil
import signal
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from golden.networks.network import Network
from tactus.certify.proofs import write_equality, write_every_frame, write_formulas
from tactus.certify.recordings import PlayedFrames, frames_of, write_recordings
from tactus.export.exporter import compile_order
from tactus.scene import Scene
from tactus.verify.benches.kept_results import run_kept
from tactus.verify.benches.results import chosen
from tactus.verify.benches.runner import Job, Outcome, jobs, run_jobs
from tactus.verify.every_frame.netlist import READ
from tactus.verify.sign_off import netlist
from tactus.verify.sign_off.cell_models import models_for
from tactus.verify.sign_off.record import recorded, short, verilog
from tactus.verify.sign_off.subject import recorded_cases
from tb.common.properties import Property

# What the script writes. Not "run": Yosys as WebAssembly takes that for /run.
OUTPUT = "output"
SCRIPT = "check.sh"
DIGESTS = "SHA256SUMS"
# The only step that need not be delivered.
CELLS = "cells"
EVERY_FRAME = "every_frame"
BENCHES = "benches"
STEPS = (
    "digests",
    "vhdl",
    "verilog",
    "netlist",
    "equality",
    "properties",
    EVERY_FRAME,
    CELLS,
)
LANGUAGES = ("vhdl", "verilog")


@dataclass(frozen=True)
class CertifyOptions:
    """What a user may ask of a certificate.

    frames: The number of random frames; None for the usual one.
    seed: The seed of random frames, and of the entities that are drawn.
    families: The families on whose cells the frames are played.
    recorded: The number of recorded frames; None for all.
    parts: The number of entities whose benches run, drawn by ``seed``; None for all.
    """

    frames: int | None
    seed: int
    families: tuple[str, ...] = ()
    recorded: int | None = None
    parts: int | None = None


@dataclass(frozen=True)
class StepResult:
    """The result of one step.

    colour: "green", "amber" or "red".
    figure: What was found, in words.
    """

    colour: str
    step: str
    figure: str


@dataclass(frozen=True)
class BenchResult:
    """What is known of the bench of one entity.

    job: Of an entity around networks it has recorded frames alone, and then no border is asked for.
    recorded: Whether the library has a record of the same bytes, so that the bench did not run.
    compared: How many values the bench compared, if it ran.
    complaint: Why the bench failed; empty if it passed.
    """

    job: Job
    recorded: bool
    compared: int = 0
    complaint: str = ""

    @property
    def whole(self) -> bool:
        """Whether every border was asked for."""
        return self.recorded or not self.job.test


@dataclass(frozen=True)
class Certificate:
    """What was written, beside the files.

    jobs: The entities.
    families: Those on whose cells the frames are played.
    """

    scene: Scene
    design: Network
    jobs: list[Job]
    frames: PlayedFrames
    properties: list[tuple[Job, Property]]
    benches: list[BenchResult]
    families: tuple[str, ...]


def deliver(
    scene: Scene, build: Path, folder: Path, wanted: CertifyOptions, tell: Callable[[str], None]
) -> Certificate:
    """Write everything but the page into an empty folder.

    scene: It is exported into ``build`` in both languages.
    tell: Is called with the name of each part before it is made.
    """
    design = scene.twin()
    for language in LANGUAGES:
        shutil.copytree(build / scene.name / language, folder / "design" / language)
    _write_inputs(scene, design, folder)
    frames = frames_of(scene, design, wanted.frames, wanted.seed, wanted.recorded)
    tell("frames")
    write_recordings(scene, design, frames, folder)
    tell("netlists of both languages")
    write_equality(folder, design.entity)
    entities = jobs(scene, "icarus", build=build)
    tell("properties")
    properties = write_formulas(entities, folder)
    write_every_frame(scene, folder)
    count = len(entities) if wanted.parts is None else min(wanted.parts, len(entities))
    drawn = sorted(random.Random(wanted.seed).sample(range(len(entities)), count))
    benches = run_benches(entities, [entities[place] for place in drawn], tell)
    for family in wanted.families:
        tell(f"cells of {family}")
        write_cells(entities[0], family, folder)
    _write_script(scene, design, frames, {job.entity for job, _ in properties}, folder)
    return Certificate(scene, design, entities, frames, properties, benches, wanted.families)


def _write_inputs(scene: Scene, design: Network, folder: Path) -> None:
    """Copy what was exported: the scene, its networks and its data; and write the image."""
    place = folder / "inputs"
    place.mkdir()
    stories = filter(Path.is_file, scene.provenance_paths)
    for file in dict.fromkeys([*scene.files, *stories]):
        shutil.copy(file, place)
    if design.image:
        (place / "image.bin").write_bytes(design.image)


def _write_script(
    scene: Scene, design: Network, frames: PlayedFrames, proved: set[str], folder: Path
) -> None:
    environment = Environment(
        loader=PackageLoader("tactus.certify", "."), undefined=StrictUndefined, autoescape=False
    )
    orders = {language: compile_order(folder / "design" / language) for language in LANGUAGES}
    text = environment.get_template(f"{SCRIPT}.jinja").render(
        scene=scene.name,
        top=design.entity,
        steps=STEPS,
        read=READ.format(top=design.core.entity),
        given=given_text(frames, design.past),
        left=frames.left,
        entities=len(proved),
        **orders,
    )
    script = folder / SCRIPT
    script.write_text(text + "\n", encoding="utf-8")
    script.chmod(0o755)


def given_text(frames: PlayedFrames, past: int) -> str:
    """What the frames are that were compared, for a line of the script."""
    kinds = f"{len(frames.recorded)} recorded and {len(frames.random)} random"
    if not past:
        return f"{kinds}, equal the model"
    return (
        f"equal the model; {kinds} frames were played, and the first {past} of each recording give "
        "no output"
    )


def check(folder: Path, *steps: str, quiet: bool = False, **environment: str) -> int:
    """Run the script of a certificate with the tools of this environment; its exit code.

    *steps: The steps to run; all without any.
    quiet: Whether nothing is printed.
    **environment: Variables of the script.
    """
    path = f"{os.environ.get('PATH', '')}{os.pathsep}{sysconfig.get_path('scripts')}"
    command = ["sh", str(folder / SCRIPT), *steps]
    settings = {**os.environ, "PATH": path, "PYTHON": sys.executable, **environment}
    printed = subprocess.DEVNULL if quiet else None
    # In a session of its own the script can be ended together with the tools that it runs.
    with subprocess.Popen(command, env=settings, stdout=printed, start_new_session=True) as script:
        try:
            return script.wait()
        except BaseException:
            with suppress(ProcessLookupError):
                os.killpg(script.pid, signal.SIGKILL)
            raise


def write_digests(folder: Path) -> dict[str, str]:
    """Write ``SHA256SUMS`` of every delivered file; the digests by name."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    found = {
        file.relative_to(folder).as_posix(): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in files
        if file.relative_to(folder).parts[0] != OUTPUT and file.name != DIGESTS
    }
    text = "".join(f"{digest}  {name}\n" for name, digest in found.items())
    (folder / DIGESTS).write_text(text, encoding="utf-8")
    return found


def write_cells(top: Job, family: str, folder: Path) -> None:
    """Write ``cells/<family>`` below a folder: the top's netlist and the models of its cells."""
    place = folder / "cells" / family
    place.mkdir(parents=True)
    found = netlist.cells_of(top, family)
    for entity, text in found.items():
        (place / f"{entity}.v").write_text(text, encoding="utf-8")
    models = models_for(netlist.CELLS[family], "".join(found.values()))
    (place / netlist.MODELS).write_text(models, encoding="utf-8")


def run_benches(
    entities: Sequence[Job], drawn: Sequence[Job], tell: Callable[[str], None]
) -> list[BenchResult]:
    """Run the benches of the drawn ones among all entities, but for those that have a record."""
    # An instrument or a cascade takes minutes, and its networks have benches of their own.
    around = {job.entity for job in chosen(list(entities)) if job.test}

    def bench(job: Job) -> Outcome:
        tell(f"bench of {job.entity}")
        return run_kept(job)

    jobs = [replace(job, test="recorded") if job.entity in around else job for job in drawn]
    known = {job.entity: BenchResult(job, True) for job in jobs if same_bytes(job, "coverage")}
    new = [job for job in jobs if job.entity not in known]
    for outcome in run_jobs(new, lambda _: None, work=bench):
        complaint = "" if outcome.passed else outcome.complaint()
        known[outcome.job.entity] = BenchResult(outcome.job, False, outcome.compared, complaint)
    return [known[job.entity] for job in jobs]


def same_bytes(job: Job, kind: str) -> dict[str, Any] | None:
    """The record of a kind that was made of the same Verilog as an entity; None without one."""
    digest = short(verilog(job))
    for record in (recorded(kind, name) for name in recorded_cases(job.block)):
        for found in record.get("runs", [record]):
            if found.get("verilog") == digest:
                return dict(found)
    return None


def read_results(folder: Path) -> list[StepResult]:
    """The results of a certificate's script, of its last run or so far; none before the first."""
    file = folder / OUTPUT / "results.txt"
    text = file.read_text(encoding="utf-8") if file.exists() else ""
    return [StepResult(*line.split("\t")) for line in text.splitlines()]
