"""``NETLIST=unknown``: run benches with registers that are unknown until a known value is written.

The exported Verilog of an entity becomes a netlist in which a gate gives a definite bit only if
that bit is the same for every value of the unknown ones. So an ``if`` with an unknown condition
gives those bits in which both branches agree. Every register begins unknown. In each clock of reset
it takes its reset value or, if it has none, is unknown again, and so is every word of a memory. The
registers behind ports ``held_*`` keep their values through a reset, and are unknown only at first.
The bench is the block's own. It refuses a flag that is not 0 or 1 after the first reset, and data
that is not known while its flag says that it is valid. So if the bench passes, nothing valid
depends on a register that was not written since the last reset, whatever that register held.

``clocks_to_prove`` proves the same for every input. The netlist is given to Yosys' ``sat``, which
treats unknown bits as a simulator with four states does. After the first clock of reset, and for
all inputs, this is proved:

- every flag is known, and so is every register that has a reset;
- data that belong to a flag are known in each clock in which the flag is high.

The proof is an induction over as many clocks as it needs, from every state of the registers. Each
unknown bit is treated as independent of all others. So whatever is proved is true, but something
true may not be provable.
"""

import json
import shutil
import tempfile
from copy import deepcopy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.core.files import replace_file
from tactus.core.templates import environment
from tactus.synth.tools import run_tool
from tactus.verify.benches.runner import Job

UNKNOWN = "unknown"
REGISTER = "$dff"
RESET = "rst"
# Ports whose names begin so have registers that keep their values through a reset: docs/streams.md.
HELD = "held_"
# These passes do not choose a convenient value for an unknown bit. A memory becomes registers, so
# that a write to an unknown address makes all of them unknown.
PREPARE = (
    "proc -noopt; flatten; opt_expr -keepdc; pmuxtree; memory_collect; memory_map; "
    "opt_expr -keepdc; opt_clean; dffunmap; opt_clean; delete t:$scopeinfo"
)

Bit = int | str
Cell = dict[str, Any]


@dataclass(frozen=True)
class Register:
    """One register, or those of its bits that reset treats alike.

    name: Its name in the Verilog, behind those of the instances around it.
    bits: The nets of its bits.
    reset: Whether reset gives it a value.
    """

    name: str
    bits: tuple[Bit, ...]
    reset: bool


class Netlist:
    """An entity as one module of gates and registers, all of which begin unknown."""

    def __init__(self, job: Job) -> None:
        self.top = job.entity
        self.twin = job.twin
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for file in job.files:
                shutil.copy(job.hdl_folder / file, folder)
            script = f"read_verilog *.v; hierarchy -top {self.top}; {PREPARE}; write_json n.json"
            run_tool("yosys", ["-q", "-p", script], folder)
            self.netlist = json.loads((folder / "n.json").read_text(encoding="utf-8"))
        self.module = self.netlist["modules"][self.top]
        cells: dict[str, Cell] = self.module["cells"]
        others = {c["type"] for c in cells.values() if "CLK" in c["connections"]} - {REGISTER}
        if others:
            raise InputError(
                f"{self.top}: got cells {', '.join(others)} with a clock, expected only {REGISTER}"
            )
        reset = self.module["ports"].get(RESET)
        self.rst: Bit | None = reset["bits"][0] if reset else None
        self.held = {
            bit
            for name, port in self.module["ports"].items()
            for bit in port["bits"]
            if name.startswith(HELD)
        }
        self.drivers: dict[Bit, tuple[Cell, int]] = {
            bit: (cell, n)
            for cell in cells.values()
            if cell["type"] == "$mux"
            for n, bit in enumerate(cell["connections"]["Y"])
        }
        # For the net of each bit of a register: the cell, and the place of the bit in it.
        self.flip_flops: dict[Bit, tuple[str, int]] = {
            bit: (name, n)
            for name, cell in cells.items()
            if cell["type"] == REGISTER
            for n, bit in enumerate(cell["connections"]["Q"])
        }

    def in_reset(self, bit: Bit) -> str:
        """The value of a net in a clock of reset: "0", "1", or "x" if it depends on registers."""
        if bit == self.rst:
            return "1"
        if isinstance(bit, str) or bit not in self.drivers:
            return bit if isinstance(bit, str) else "x"
        cell, n = self.drivers[bit]
        wires = cell["connections"]
        select = self.in_reset(wires["S"][0])
        low, high = (self.in_reset(wires[port][n]) for port in "AB")
        return {"0": low, "1": high}.get(select, low if low == high else "x")

    def is_reset(self, bit: Bit) -> bool:
        """Whether a clock of reset gives a register a value; a constant one counts, too."""
        if self.rst is None:
            return False
        name, n = self.flip_flops[bit]
        return self.in_reset(self.module["cells"][name]["connections"]["D"][n]) in ("0", "1")

    def registers(self) -> list[Register]:
        nets = sorted(self.module["netnames"].items(), key=lambda net: (net[1]["hide_name"], net))
        names = {bit: name for name, net in reversed(nets) for bit in net["bits"]}
        found: dict[tuple[str, bool], list[Bit]] = {}
        for bit in self.flip_flops:
            found.setdefault((names[bit], self.is_reset(bit)), []).append(bit)
        return [Register(name, tuple(bits), reset) for (name, reset), bits in sorted(found.items())]

    def verilog(self, unreset: Register | None = None, held: str = "") -> str:
        """The module, in which registers without a reset become unknown in each clock of reset.

        ``unreset`` is a register whose reset is left out. ``held`` names one more output, which
        shows all other registers that have a reset.
        """
        netlist = deepcopy(self.netlist)
        module = netlist["modules"][self.top]
        lost = unreset.bits if unreset else ()
        clocked = [cell for cell in module["cells"].values() if cell["type"] == REGISTER]
        for cell in clocked if self.rst is not None else []:
            wires = cell["connections"]
            if not self.held.issuperset(wires["Q"]):
                pairs = zip(wires["Q"], wires["D"], strict=True)
                values = ["x" if bit in lost else self.in_reset(data) for bit, data in pairs]
                cell["type"], cell["port_directions"]["SRST"] = "$sdff", "input"
                cell["parameters"] |= {"SRST_POLARITY": "1", "SRST_VALUE": "".join(values[::-1])}
                wires["SRST"] = [self.rst]
        if held:
            bits = [bit for bit in self.flip_flops if self.is_reset(bit) and bit not in lost]
            module["ports"][held] = {"direction": "output", "bits": bits or ["0"]}
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "n.json").write_text(json.dumps(netlist), encoding="utf-8")
            run_tool("yosys", ["-q", "-p", "read_json n.json; write_verilog -noattr n.v"], folder)
            return (folder / "n.v").read_text(encoding="utf-8")

    def bench(self, job: Job, unreset: Register | None = None) -> Job:
        """The job's bench on this netlist, which is written beside the exported files."""
        changed = replace(job, form=UNKNOWN, files=(f"{self.top}.v",))
        changed.hdl_folder.mkdir(parents=True, exist_ok=True)
        with replace_file(changed.hdl_folder / f"{self.top}.v") as temporary:
            temporary.write_text(self.verilog(unreset), encoding="utf-8")
        return changed


# For each flag: how the names of the outputs begin that are its data.
VALID = {"out_valid": "out_", "m_axis_tvalid": "m_axis_t"}
# No pipeline has so many clocks. The bound is in clocks and not in seconds, so that it is the same
# on every machine.
MOST_CLOCKS = 16
# The most bits of registers. Larger blocks would take minutes, and their parts are proved anyway.
MOST_BITS = 700
# The most bits that all cells give together. With more, as in the tables of bipartite, Yosys'
# solver runs out of the memory that WebAssembly has.
MOST_GATE_BITS = 50_000
SHOWN = "what_reset_gives_a_value"


def outputs(netlist: Netlist) -> tuple[list[str], dict[str, list[str]]]:
    """The flags, and the data of each flag; nothing is proved of other outputs."""
    ports = [port for port in netlist.twin.ports if port.direction == "out"]
    data = {
        flag: [port.name for port in ports if port.name.startswith(prefix) and port.name != flag]
        for flag, prefix in VALID.items()
        if flag in {port.name for port in ports}
    }
    behind = {name for found in data.values() for name in found}
    flags = [port.name for port in ports if not port.width and port.name not in behind]
    return flags, {flag: found for flag, found in data.items() if found}


def clocks_to_prove(netlist: Netlist, unreset: Register | None = None) -> int | None:
    """The number of clocks of the induction; None where it does not close or is not tried.

    ``unreset`` is a register whose reset is left out.
    """
    cells = netlist.module["cells"].values()
    gate_bits = sum(len(cell["connections"].get("Y", "")) for cell in cells)
    large = len(netlist.flip_flops) > MOST_BITS or gate_bits > MOST_GATE_BITS
    if large or netlist.twin.latency > MOST_CLOCKS:
        return None
    left = [register for register in netlist.registers() if register.reset and register != unreset]
    if (unreset or not left) and not any(outputs(netlist)):
        # Nothing is proved of data without a flag, and registers that do not hang on the one whose
        # reset is left out are known all the same.
        return None
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        text = netlist.verilog(unreset, SHOWN) + watch(netlist, unreset)
        (folder / "watch.v").write_text(text, encoding="utf-8")
        script = (
            "read_verilog watch.v; hierarchy -top watch; proc -noopt; flatten; opt_clean; "
            f"sat -verify -tempinduct -maxsteps {MOST_CLOCKS} -set-init-undef -set-def-inputs "
            "-enable_undef -prove wrong 0 watch"
        )
        try:
            said = run_tool("yosys", ["-p", script], folder)
        except InputError as error:
            if "proof did fail" in str(error):
                return None
            raise
    return said.count("[induction step ")


def watch(netlist: Netlist, unreset: Register | None = None) -> str:
    """A module around the netlist whose output is 1 if something is unknown that must not be."""
    flags, data = outputs(netlist)
    lost = unreset.bits if unreset else ()
    return (
        environment("tactus.verify.sign_off")
        .get_template("watch.v.jinja")
        .render(
            top=netlist.top,
            ports=netlist.module["ports"],
            held=sum(netlist.is_reset(bit) and bit not in lost for bit in netlist.flip_flops),
            shown=SHOWN,
            flags=flags,
            data=data,
        )
    )
