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
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np

from golden.input_error import InputError
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
from tb.common.properties import Property

# Random frames, where no number is given; fewer where a frame takes thousands of clocks.
RANDOM = 200
LEAST_RANDOM = 5


class Frames(NamedTuple):
    """Codes of the samples that are played, shape (frames, inputs): recorded frames, and random
    ones, drawn from all codes with equal probability; and how many recorded ones are left out."""

    recorded: Codes
    random: Codes
    left: int


def frames_of(scene: Scene, random: int | None, seed: int, recorded: int | None = None) -> Frames:
    """The frames for a scene.

    Without a number of ``random`` frames there are as many as usual, and without one of
    ``recorded`` frames there are all; fewer are taken in equal distances from the whole recording.
    """
    design = scene.twin()
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
    return Frames(played, drawn, len(every) - len(played))


def write_recordings(scene: Scene, frames: Frames, folder: Path) -> None:
    """Write ``bench/vhdl`` and ``bench/verilog`` below a folder that holds ``design``.

    The frames come in lengths that every simulator elaborates. Of the first ``past`` frames of a
    part no outputs come, so they are the last ones of the part before.
    """
    design, name = scene.twin(), plain_name(scene.name)
    top, past = design.entity, design.past
    played, step = np.concatenate([frames.recorded, frames.random]), FRAMES - past
    for number, start in enumerate(range(0, max(1, len(played) - past), step), start=1):
        samples = played[start : start + step + past]
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
EVERY_FRAME = "every_frame"
STEPS = ("digests", "vhdl", "verilog", "netlist", "equality", "properties", EVERY_FRAME)
LANGUAGES = ("vhdl", "verilog")


class StepResult(NamedTuple):
    """The result of one step: "green", "amber" or "red", and what was found, in words."""

    colour: str
    step: str
    figure: str


def deliver(scene: Scene, build: Path, folder: Path, frames: Frames) -> list[tuple[Job, Property]]:
    """Write everything but the page into an empty folder; the properties that are proved.

    scene: It is exported into ``build`` in both languages.
    """
    design = scene.twin()
    for language in LANGUAGES:
        shutil.copytree(build / scene.name / language, folder / "design" / language)
    inputs = folder / "inputs"
    inputs.mkdir()
    stories = filter(Path.is_file, scene.provenance_paths)
    for file in dict.fromkeys([*scene.files, *stories]):
        shutil.copy(file, inputs)
    if design.image:
        (inputs / "image.bin").write_bytes(design.image)
    write_recordings(scene, frames, folder)
    write_equality(folder, design.entity)
    properties = write_formulas(jobs(scene, "icarus", build=build), folder)
    write_every_frame(scene, folder)
    _write_script(scene, frames, {job.entity for job, _ in properties}, folder)
    return properties


def _write_script(scene: Scene, frames: Frames, proved: set[str], folder: Path) -> None:
    design = scene.twin()
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
            **{language: compile_order(folder / "design" / language) for language in LANGUAGES},
        )
    )
    script = folder / SCRIPT
    script.write_text(text, encoding="utf-8")
    script.chmod(0o755)


def given_text(frames: Frames, past: int) -> str:
    """What the frames are that were compared, for a line of the script."""
    kinds = f"{len(frames.recorded)} recorded and {len(frames.random)} random"
    if not past:
        return f"{kinds}, equal the model"
    return (
        f"equal the model; {kinds} frames were played, and the first {past} of each recording give "
        "no output"
    )


def check(folder: Path, *steps: str, **environment: str) -> int:
    """Run the script of a certificate with the tools of this environment; its exit code.

    *steps: The steps to run; all without any.
    **environment: Variables of the script.
    """
    path = f"{os.environ.get('PATH', '')}{os.pathsep}{sysconfig.get_path('scripts')}"
    command = ["sh", str(folder / SCRIPT), *steps]
    settings = {**os.environ, "PATH": path, "PYTHON": sys.executable, **environment}
    # In a session of its own the script can be ended together with the tools that it runs.
    with subprocess.Popen(command, env=settings, start_new_session=True) as script:
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


def read_results(folder: Path) -> list[StepResult]:
    """The results of a certificate's script, of its last run or so far; none before the first."""
    file = folder / OUTPUT / "results.txt"
    text = file.read_text(encoding="utf-8") if file.exists() else ""
    return [StepResult(*line.split("\t")) for line in text.splitlines()]
