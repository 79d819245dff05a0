"""One recorded frame through the exported Verilog of a scene, for the report's timing diagram.

This is not a bench: nothing is compared here. Icarus plays the frame into the top entity and prints
the streams of the top and of the networks in it, clock by clock.
"""

import re
import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from golden.input_error import InputError
from golden.networks.network import Network
from golden.numbers.fixed import Fix
from golden.numbers.precision import SIGNAL
from tactus.core.folders import BUILD
from tactus.export.exporter import compile_order
from tactus.export.handover.ports import read_ports, verilog_type
from tactus.scene import Scene
from tactus.verify.benches.runner import export
from tactus.verify.benches.tools import check_simulator

# How many clocks are recorded before the first element and after the last output.
BEFORE, BEHIND = 1, 2
# Values of input ports, and for how many clocks they are held.
Held = tuple[dict[str, int], int]
MEMBER = ("in_valid", "in_data", "in_last", "out_valid", "out_data")


@dataclass(frozen=True)
class Row:
    """What stood on one port of a design during a recording.

    owner: Whose port it is. Neighbouring ports with the same owner share this heading.
    values: The values just before the rising edge of each clock, None if undefined.
    fmt: The format of the codes, or None for a flag.
    valid: A flag of the same owner, which says in which clocks the codes count.
    """

    owner: str
    name: str
    values: tuple[int | None, ...]
    fmt: Fix | None = None
    valid: str = ""


@dataclass(frozen=True)
class Watched:
    """A recorded port: where it is in the simulation, and how the picture names it."""

    path: str
    owner: str
    name: str


def simulate_frame(scene: Scene, frame: int = 0, build: Path = BUILD) -> list[Row]:
    """The streams of the scene's top, and of the networks of a cascade, during one frame.

    scene: One whose design takes a stream of samples, or all of them at once.
    frame: Row of the scene's recorded vectors. If there are several recordings, of the first.
    build: The folder of the export, which is made if it is not there.
    """
    check_simulator("icarus")
    design = scene.twin()
    if design.stream not in ("serial", "words"):
        raise InputError(
            f"{scene.path}: waveforms: got the design {design.entity}, whose frames have pauses "
            "of any length, expected a network or a readout"
        )
    codes, past = scene.vectors().recordings[0].tolist(), design.past
    last = len(codes) - past - 1
    if not 0 <= frame <= last:
        raise InputError(f"{scene.path}: frame: got {frame}, expected 0 to {last}")
    *before, shown = codes[frame : frame + past + 1]
    export(scene, "verilog", build)
    folder = build / scene.name / "verilog"
    watched = list(_watched(scene, design, folder))
    drive = _drive(design, shown)
    # Loading the image and playing the past frames are not shown.
    hidden = [*_loading(design.image), *(step for each in before for step in _passed(design, each))]
    paths = [port.path for port in watched]
    rows = _simulate(folder, design, hidden, drive, paths)
    columns = list(zip(*rows, strict=True))
    return [_port(port, bits) for port, bits in zip(watched, columns, strict=True)]


def _drive(design: Network, samples: list[int]) -> list[dict[str, int]]:
    """The values of the input ports in every clock, from the first clock after the reset."""
    if design.stream == "words":
        busy = [{"in_valid": 1} | {f"in_data_{k}": code for k, code in enumerate(samples)}]
    else:
        # In the slots of a cascade the thesis scans the first sensors again.
        length = design.input_controller.inputs
        elements = [samples[n % len(samples)] for n in range(length)]
        busy = [
            {"in_valid": 1, "in_data": code, "in_last": int(n == length - 1)}
            for n, code in enumerate(elements)
        ]
    idle = dict.fromkeys(busy[0], 0)
    return [idle] * BEFORE + busy + [idle] * (design.output_clocks[-1] + BEHIND)


def _loading(image: bytes) -> list[Held]:
    """The values of the input ports while an image is loaded."""
    busy = [
        {"load_valid": 1, "load_data": byte, "load_last": int(n == len(image))}
        for n, byte in enumerate(image, 1)
    ]
    return [(values, 1) for values in [*busy, *(dict.fromkeys(first, 0) for first in busy[:1])]]


def _passed(design: Network, samples: list[int]) -> list[Held]:
    """The values of the input ports during a past frame and up to the next frame."""
    busy = [values for values in _drive(design, samples) if values["in_valid"]]
    idle = dict.fromkeys(busy[0], 0)
    return [*((values, 1) for values in busy), (idle, design.interval)]


def _watched(scene: Scene, design: Network, folder: Path) -> Iterator[Watched]:
    """The ports of the top's input, those of the networks in it, and those of its output."""
    names = [port.name for port in read_ports(design, _text(folder, design.entity), "verilog")]
    entering = f"{design.entity}, frame in: {', '.join(scene.sensors)}"
    leaving = f"{design.entity}, frame out: {', '.join(scene.outputs)}"
    for name in names:
        if name.startswith("in_"):
            yield Watched(f"dut.{name}", entering, name)
    core, path = design.core, "dut"
    if core is not design:
        path = f"dut.{_instance(folder, design.entity, core.entity)}"
    for network, output in zip(core.members, scene.outputs, strict=False):
        place = f"{path}.{_instance(folder, core.entity, network.entity)}"
        for name in MEMBER:
            yield Watched(f"{place}.{name}", f"{network.entity}: {output}", name)
    for name in names:
        if name.startswith("out_"):
            yield Watched(f"dut.{name}", leaving, name)


def _text(folder: Path, entity: str) -> str:
    return (folder / f"{entity}.v").read_text(encoding="utf-8")


def _instance(folder: Path, parent: str, entity: str) -> str:
    """The name of an entity's instance in its parent."""
    found = re.search(rf"^{re.escape(entity)} (\w+) \(", _text(folder, parent), re.M)
    if found is None:
        raise InputError(f"{folder / parent}.v: expected an instance of {entity}, found none")
    return found[1]


def _simulate(
    folder: Path,
    design: Network,
    hidden: list[Held],
    drive: list[dict[str, int]],
    watched: list[str],
) -> list[list[str]]:
    """The bits of the watched signals before each rising edge: one row for each clock."""
    top = design.entity
    ports = {port.name: port for port in design.ports}
    given = [*(values for values, _ in hidden), drive[0]]
    inputs = dict.fromkeys(["clk", "rst", *(name for values in given for name in values)])
    regs = [f"    reg {verilog_type(ports[name])}{name} = 0;" for name in inputs]
    wires = ", ".join(f".{name}({name})" for name in inputs)
    show = f'$display("{" ".join(["row", *["%b"] * len(watched)])}", {", ".join(watched)});'
    tick = ["#5;", "clk = 1;", "#5;", "clk = 0;"]
    play = ["rst = 1;", *tick, *tick, "rst = 0;"]
    for values, clocks in hidden:
        play += [*_set(values), f"repeat ({clocks}) begin", *tick, "end"]
    for values in drive:
        play += [*_set(values), tick[0], show, *tick[1:]]
    lines = ["`timescale 1ns/1ps", "module recorder;", *regs, f"    {top} dut({wires});"]
    lines += ["    initial begin", *(f"        {words}" for words in play), "    end", "endmodule"]
    files = [str(folder / name) for name in compile_order(folder)]
    with tempfile.TemporaryDirectory() as work:
        source, program = Path(work) / "recorder.v", Path(work) / "recorder"
        source.write_text("\n".join([*lines, ""]), encoding="utf-8")
        compiled = ["iverilog", "-g2012", "-s", "recorder", "-o", str(program), *files, str(source)]
        _run(compiled)
        printed = _run(["vvp", "-n", str(program)])
    return [words.split()[1:] for words in printed.splitlines() if words.startswith("row ")]


def _set(values: dict[str, int]) -> list[str]:
    return [f"{name} = {value};" for name, value in values.items()]


def _run(command: list[str]) -> str:
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode:
        raise InputError(f"{command[0]}: {(result.stdout + result.stderr).strip()}")
    return result.stdout


def _port(watched: Watched, bits: tuple[str, ...]) -> Row:
    """A port of the picture; one whose name says that it holds data gets a format."""
    known = [int(word, 2) if set(word) <= {"0", "1"} else None for word in bits]
    if "_data" not in watched.name:
        return Row(watched.owner, watched.name, tuple(known))
    sign = 1 << (SIGNAL.width - 1)
    codes = tuple(None if code is None else (code ^ sign) - sign for code in known)
    direction = watched.name.split("_", 1)[0]
    return Row(watched.owner, watched.name, codes, SIGNAL, f"{direction}_valid")
