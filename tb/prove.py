"""``make prove``: with a scene, that its export computes its network for every frame.

Verilog is read by Yosys, VHDL by GHDL, whose netlist Yosys reads; neither proof rests on the other
(docs/every-frame.md). With a block, or with nothing, the properties of blocks are proved
(``tb.sign_off.prove``).
"""

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from golden.cli import run, would
from golden.folders import BUILD
from golden.hold import held
from golden.input_error import InputError
from golden.progress import stage
from golden.scene import Scene, load_scene
from hdl.export.exporter import compile_order
from hdl.synth.tools import run_tool
from tb.common.runner import export
from tb.common.tools import check_simulator
from tb.every_frame.counterexample import Evaluated, bench, differing_frame
from tb.every_frame.netlist import Netlist, NotReadableError, read_verilog
from tb.every_frame.sequences import DiffersError, RefusedError, Sequences
from tb.every_frame.specify import description
from tb.every_frame.sums import UnsupportedError
from tb.sign_off import prove as blocks
from tb.sign_off.equal_gates import dump, read_dump
from tb.sign_off.equal_netlist import list_lengths, to_verilog

# What begins the line about a netlist that is not proved.
UNKNOWN, WRONG = "NOT SHOWN", "DIFFERS"
# What begins the line of a claim.
PROVED, TRIED = "  proved", "  tried "


def yosys(arguments: list[str], folder: Path) -> str:
    return run_tool("yosys", arguments, folder)


def hardware(folder: Path, entity: str, language: str) -> Netlist:
    """The netlist of an entity of an export.

    Raises
    ------
    InputError
        Where Yosys or GHDL cannot read it, with what they say.
    """
    files = [folder / name for name in compile_order(folder)]
    try:
        if language == "verilog":
            return read_verilog(files, entity, yosys)
        with tempfile.TemporaryDirectory() as made:
            modules = read_dump(dump(files, entity, Path(made)))
            written = []
            for name, module in modules.items():
                source = folder / f"{name}.vhd"
                lists = list_lengths(source.read_text(encoding="utf-8")) if source.exists() else {}
                written.append(Path(made) / f"{name}.v")
                written[-1].write_text(to_verilog(module, lists), encoding="utf-8")
            return read_verilog(written, entity, yosys)
    except (NotReadableError, ValueError) as error:
        raise InputError(f"{folder}: {error}") from None


def prove_export(given: dict[str, Any], netlist: Netlist, folder: Path) -> bool:
    """Prove a netlist and print each claim; False where one fails."""
    begun = time.process_time()
    found = fault(given, netlist, folder, print)
    if found:
        print(f"  {found}")
        return False
    print(f"  {time.process_time() - begun:.1f} s of processor time", flush=True)
    return True


def fault(
    given: dict[str, Any], netlist: Netlist, folder: Path, tell: Callable[[str], None]
) -> str:
    """Why a netlist is not proved; empty if it is. `tell` gets a line for each claim."""
    proof = Sequences(netlist, given)
    try:
        for claim in proof.prove():
            tell(f"{PROVED if claim.shown else TRIED}  {claim.text}")
    except DiffersError as found:
        frame = differing_frame(proof.samples, found.got, found.expected)
        where = f"output {found.output}, {found.clock} clocks after the last sample"
        if frame is None:
            # Two forms of one value may look different; only a frame shows that they are.
            return f"{UNKNOWN}  {where}: no frame is found at which it differs"
        return f"{WRONG}  {where}, {frame}: {_played(given, frame, found, proof, folder)}"
    except (RefusedError, UnsupportedError) as reason:
        return f"{UNKNOWN}  {reason}"
    return ""


def _played(
    given: dict[str, Any], frame: list[int], found: DiffersError, proof: Sequences, folder: Path
) -> str:
    """What the hardware gives for a frame, and what the network gives; Icarus plays Verilog."""
    words = [w for v in proof.samples for w in v.terms]  # type: ignore[union-attr]
    now, output = Evaluated(words, np.array([frame])), found.output
    expected = int(now.value(found.expected)[0])
    if not compile_order(folder)[0].endswith(".v"):
        got = int(now.value(found.got)[0])
        return f"GHDL's netlist gives {got} for output {output}, the network {expected}"
    with tempfile.TemporaryDirectory() as made:
        test = Path(made) / "bench.v"
        test.write_text(bench(given, frame), encoding="ascii")
        files = [str(folder / name) for name in compile_order(folder)]
        subprocess.run(
            ["iverilog", "-g2001", "-o", f"{made}/run", str(test), *files],
            check=True,
            capture_output=True,
        )
        said = subprocess.run(
            ["vvp", f"{made}/run"], check=True, capture_output=True, text=True
        ).stdout
    rows = [line.split() for line in said.splitlines() if line.split()[0].isdigit()]
    values = [x for row in rows for x in row[1:]]
    shown = values[output] if output < len(values) else "nothing"
    return f"Icarus gives {shown} for output {output}, the network {expected}"


def prove_scene(scene: Scene, languages: tuple[str, ...] = ("verilog", "vhdl")) -> bool:
    """Export a scene and prove it in each language; whether all is shown."""
    given = description(scene)
    bits = given["bits"] * given["samples"]
    sound = True
    for language in languages:
        folder = BUILD / scene.name / language
        with stage(f"{scene.name}: exporting and reading {language}", quick=True):
            export(scene, language)
            netlist = hardware(folder, given["entity"], language)
        print(
            f"{scene.name}, {language}, {given['entity']}{given['around']}: every frame of "
            f"2^{bits}",
            flush=True,
        )
        sound = prove_export(given, netlist, folder) and sound
    return sound


def proof_line(scene: Scene) -> str:
    """A line about the exported Verilog of a scene, which stands below build."""
    folder, lines = BUILD / scene.name / "verilog", list[str]()
    try:
        given = description(scene)
        netlist = hardware(folder, given["entity"], "verilog")
    except InputError as reason:
        return f"not proved for every frame: {reason}"
    found = fault(given, netlist, folder, lines.append)
    frames = f"2^{given['bits'] * given['samples']}"
    gaps = "; gaps are tried" if any(line.startswith(TRIED) for line in lines) else ""
    return found or f"proved for every frame: {frames}, {given['entity']}{given['around']}{gaps}"


def main() -> int:
    """Run as ``python -m tb.prove``."""
    parser = argparse.ArgumentParser(prog="make prove", description=__doc__)
    parser.add_argument("--block")
    parser.add_argument("--scene")
    parser.add_argument("--record", action="store_true")
    arguments = parser.parse_args()
    if not arguments.scene:
        return blocks.run_blocks(arguments.block, arguments.record)
    if arguments.block or arguments.record:
        raise InputError("SCENE: got BLOCK or RECORD beside it, expected one of SCENE and BLOCK")
    for simulator in ("ghdl", "icarus"):
        check_simulator(simulator)
    scene = load_scene(arguments.scene)
    would(f"export {scene.name} and prove it for every frame")
    with held([BUILD / scene.name]):
        sound = prove_scene(scene)
    print("proved for every frame" if sound else "not proved")
    return 0 if sound else 1


if __name__ == "__main__":
    sys.exit(run(main))
