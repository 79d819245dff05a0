"""Writes what a certificate delivers: design, inputs, frames, proofs, script and digests; runs the
script.
"""

import hashlib
import os
import shutil
import signal
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from golden.input_error import InputError
from golden.networks.network import Network
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from tactus.certify.proofs import write_equality, write_every_frame, write_formulas
from tactus.core.templates import environment
from tactus.export.exporter import compile_order
from tactus.export.handover import (
    CLOCKS,
    FRAMES,
    hex_files,
    plain_name,
    vectors,
    verilog_bench,
    winners_of,
)
from tactus.export.tidy import read_ports
from tactus.rig.smooth_map import thinned
from tactus.scene import Scene
from tactus.verify.benches.runner import Job, jobs
from tactus.verify.every_frame.netlist import READ
from tactus.verify.sign_off import netlist
from tactus.verify.sign_off.cell_models import models_for
from tb.common.properties import Property

# Random frames, where no number is given; fewer where a frame takes thousands of clocks.
RANDOM = 200
LEAST_RANDOM = 5


@dataclass(frozen=True)
class PlayedFrames:
    """The frames that are played.

    recorded, random, shape (frames, inputs): Codes of samples: recorded frames, and frames drawn
        from all codes with equal probability.
    seed: The seed of the random frames.
    left: The number of recorded frames that are not played.
    """

    recorded: Codes
    random: Codes
    seed: int
    left: int = 0

    def parts(self, past: int) -> Iterator[Codes]:
        """The frames in lengths that every simulator elaborates.

        Of the first ``past`` frames of a part no outputs come, so they are the last ones of the
        part before.
        """
        frames = np.concatenate([self.recorded, self.random])
        step = FRAMES - past
        for start in range(0, max(1, len(frames) - past), step):
            yield frames[start : start + step + past]


def frames_of(
    scene: Scene, design: Network, random: int | None, seed: int, recorded: int | None = None
) -> PlayedFrames:
    """The frames for a scene.

    Without a number of ``random`` frames there are as many as usual, and without one of
    ``recorded`` frames there are all; fewer are taken in equal distances from the whole recording.
    """
    if random is None:
        random = max(LEAST_RANDOM, min(RANDOM, CLOCKS // design.interval))
    drawn = np.random.default_rng(seed).integers(
        SIGNAL.low, SIGNAL.high + 1, (random, design.inputs)
    )
    every = np.concatenate(scene.vectors().recordings)
    played = every if recorded is None else thinned(every, recorded)
    if len(played) + random <= design.past:
        raise InputError(
            f"RECORDED={len(played)} FRAMES={random}: got {len(played) + random} frames, expected "
            f"more than {design.past}, for which the window of {scene.name} waits"
        )
    return PlayedFrames(played, drawn, seed, len(every) - len(played))


def write_recordings(scene: Scene, design: Network, frames: PlayedFrames, folder: Path) -> None:
    """Write ``bench/vhdl`` and ``bench/verilog`` below a folder that holds ``design``."""
    name, top = plain_name(scene.name), design.entity
    for number, samples in enumerate(frames.parts(design.past), start=1):
        results = design.process(samples)
        winners = winners_of(design, results)
        verilog, vhdl = (
            folder / "bench" / language / str(number) for language in ("verilog", "vhdl")
        )
        verilog.mkdir(parents=True)
        vhdl.mkdir(parents=True)
        for file, text in hex_files(design, samples, results, winners).items():
            (verilog / file).write_text(text, encoding="ascii")
        (verilog / "due.txt").write_text(f"{len(results)}\n", encoding="ascii")
        text = vectors(name, design, samples, results, winners)
        (vhdl / f"{top}_vectors.vhd").write_text(text, encoding="utf-8")
    exported = folder / "design" / "verilog"
    last = compile_order(exported)[-1]
    ports = read_ports(design, (exported / last).read_text(encoding="utf-8"), "verilog")
    (folder / "bench" / "verilog" / f"{top}_tb.v").write_text(
        verilog_bench(name, design, ports, FRAMES), encoding="utf-8"
    )


# What the script writes. Not "run": Yosys as WebAssembly takes that for /run.
OUTPUT = "output"
SCRIPT = "check.sh"
DIGESTS = "SHA256SUMS"
# The only step that need not be delivered.
CELLS = "cells"
EVERY_FRAME = "every_frame"
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
    seed: The seed of random frames.
    families: The families on whose cells the frames are played.
    recorded: The number of recorded frames; None for all.
    """

    frames: int | None
    seed: int
    families: tuple[str, ...] = ()
    recorded: int | None = None


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
class Certificate:
    """What was written, beside the files.

    families: Those on whose cells the frames are played.
    """

    scene: Scene
    design: Network
    frames: PlayedFrames
    properties: list[tuple[Job, Property]]
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
    for family in wanted.families:
        tell(f"cells of {family}")
        write_cells(entities[0], family, folder)
    _write_script(scene, design, frames, {job.entity for job, _ in properties}, folder)
    return Certificate(scene, design, frames, properties, wanted.families)


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
    orders = {language: compile_order(folder / "design" / language) for language in LANGUAGES}
    text = (
        environment("tactus.certify")
        .get_template(f"{SCRIPT}.jinja")
        .render(
            scene=scene.name,
            top=design.entity,
            steps=STEPS,
            read=READ.format(top=design.core.entity),
            given=given_text(frames, design.past),
            left=frames.left,
            entities=len(proved),
            **orders,
        )
    )
    script = folder / SCRIPT
    script.write_text(text, encoding="utf-8")
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


def read_results(folder: Path) -> list[StepResult]:
    """The results of a certificate's script, of its last run or so far; none before the first."""
    file = folder / OUTPUT / "results.txt"
    text = file.read_text(encoding="utf-8") if file.exists() else ""
    return [StepResult(*line.split("\t")) for line in text.splitlines()]
