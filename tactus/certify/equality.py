"""The proof that VHDL and Verilog are the same functions, as scripts that Yosys alone runs.

``make prove`` cuts netlists in Python; here Yosys does the same by itself. ``expose`` turns
registers of the same name into inputs and outputs, ``equiv_make`` joins signals, parts and memories
of the same name, and what is left are gates, of which ``equiv_simple`` proves that each named
signal, each next value and each input of a part gets the same value from both. An undefined bit may
be anything on each side. The assumptions are those of ``tactus.verify.sign_off.equal``.
"""

import re
import subprocess
import tempfile
from pathlib import Path

from tactus.export.exporter import compile_order
from tactus.verify.sign_off.equal_gates import dump, read_dump
from tactus.verify.sign_off.equal_netlist import list_lengths, to_verilog
from tactus.verify.sign_off.equal_proof import PLAIN

# A comment says from which line of VHDL a gate is.
_COMMENT = re.compile(r"^ *#.*\n", re.MULTILINE)
# Data and address do not count where nothing is written, so gates hide them then.
_PARAMETERS = (
    *("MEMID", "SIZE", "OFFSET", "ABITS", "WIDTH", "INIT", "RD_PORTS", "RD_CLK_ENABLE"),
    *("RD_CLK_POLARITY", "RD_TRANSPARENCY_MASK", "RD_COLLISION_X_MASK", "RD_WIDE_CONTINUATION"),
    *("RD_CE_OVER_SRST", "RD_INIT_VALUE", "RD_ARST_VALUE", "RD_SRST_VALUE", "WR_PORTS"),
    *("WR_CLK_ENABLE", "WR_CLK_POLARITY", "WR_PRIORITY_MASK", "WR_WIDE_CONTINUATION"),
)
NETLIST = "netlist.txt"
_WRITES = "writes.v"
_WRITES_TEXT = """\
// Hides data and address of a memory's write port while nothing is written.
(* techmap_celltype = "$mem_v2" *)
module writes (RD_CLK, RD_EN, RD_ARST, RD_SRST, RD_ADDR, RD_DATA, WR_CLK, WR_EN, WR_ADDR, WR_DATA);
{parameters}
    input [RD_PORTS-1:0] RD_CLK, RD_EN, RD_ARST, RD_SRST;
    input [RD_PORTS*ABITS-1:0] RD_ADDR;
    output [RD_PORTS*WIDTH-1:0] RD_DATA;
    input [WR_PORTS-1:0] WR_CLK;
    input [WR_PORTS*WIDTH-1:0] WR_EN, WR_DATA;
    input [WR_PORTS*ABITS-1:0] WR_ADDR;
    wire [WR_PORTS*WIDTH-1:0] data = WR_DATA & WR_EN;
    wire [WR_PORTS*ABITS-1:0] place;
    genvar n;
    generate for (n = 0; n < WR_PORTS; n = n + 1) begin: port
        wire written = |WR_EN[n*WIDTH +: WIDTH];
        assign place[n*ABITS +: ABITS] = WR_ADDR[n*ABITS +: ABITS] & {{ABITS{{written}}}};
    end endgenerate
    \\$mem_v2 #({passed}) _TECHMAP_REPLACE_ (
        .RD_CLK(RD_CLK), .RD_EN(RD_EN), .RD_ARST(RD_ARST), .RD_SRST(RD_SRST), .RD_ADDR(RD_ADDR),
        .RD_DATA(RD_DATA), .WR_CLK(WR_CLK), .WR_EN(WR_EN), .WR_ADDR(place), .WR_DATA(data));
endmodule
"""
_MEMORY = re.compile(r"^reg (?:.* )?(\w+) \[[^]]*\];", re.MULTILINE)
# The solver takes a choice of hundreds of words as a chain, for which it has no room.
_GATES = ("pmuxtree gold gate", f"techmap -max_iter 1 -map equal/{_WRITES} gold gate")
_COMPARE = (
    "setundef -undriven -anyseq gold gate",
    "setundef -anyseq gold gate",
    "expose -evert-dff -shared gold gate",
    "opt_clean gold gate",
    "select -assert-none gold/t:$dff gate/t:$dff",
    "equiv_make gold gate equal",
    "hierarchy -top equal",
    "opt_expr",
    "opt_merge",
    "opt_clean",
    "equiv_simple",
    "equiv_status -assert",
)


def ghdl_netlist(folder: Path, top: str) -> str:
    """The netlist that GHDL makes of the delivered VHDL, as it prints it without comments."""
    vhdl = folder / "design" / "vhdl"
    with tempfile.TemporaryDirectory() as work:
        text = dump([vhdl / name for name in compile_order(vhdl)], top, Path(work))
    return _COMMENT.sub("", text)


def write_equality(folder: Path, top: str) -> None:
    """Write ``equal`` below a folder that holds ``design``."""
    vhdl, verilog, equal = folder / "design/vhdl", folder / "design/verilog", folder / "equal"
    equal.mkdir()
    text = ghdl_netlist(folder, top)
    modules = read_dump(text)
    (equal / NETLIST).write_text(text, encoding="utf-8")
    said = subprocess.run(["ghdl", "--version"], capture_output=True, text=True, check=True)
    (equal / "ghdl.txt").write_text(said.stdout.splitlines()[0] + "\n", encoding="utf-8")
    for file in compile_order(verilog):
        entity = Path(file).stem
        source = (vhdl / f"{entity}.vhd").read_text(encoding="utf-8")
        netlist = to_verilog(modules[entity], list_lengths(source))
        (equal / file).write_text(netlist, encoding="utf-8")
        memories = _MEMORY.findall((verilog / file).read_text(encoding="utf-8"))
        proof = _proof(entity, sorted(modules[entity].children()), memories)
        (equal / f"{entity}.ys").write_text("\n".join([*proof, ""]), encoding="utf-8")
    parameters = "\n".join(f"    parameter {name} = 0;" for name in _PARAMETERS)
    passed = ", ".join(f".{name}({name})" for name in _PARAMETERS)
    text = _WRITES_TEXT.format(parameters=parameters, passed=passed)
    (equal / _WRITES).write_text(text, encoding="ascii")


def _proof(entity: str, parts: list[str], memories: list[str]) -> list[str]:
    """The commands that prove an entity; of its parts only the ports matter."""
    known = [f"read_verilog -lib design/verilog/{part}.v" for part in parts]
    lines = []
    for side, room in (("gold", "design/verilog"), ("gate", "equal")):
        lines += ["design -reset", *known, f"read_verilog {room}/{entity}.v"]
        # A comparison that never holds may keep registers alive on one side alone.
        lines += [f"hierarchy -check -top {entity}", *PLAIN.split("; "), "opt_expr", "opt_clean"]
        lines += [f"rename {entity} {side}", f"design -stash {side}"]
    lines += ["design -reset", *known]
    lines += [f"design -copy-from {side} {side}" for side in ("gold", "gate")]
    # techmap gives a memory another name in each module.
    named = [f'setparam -set MEMID "$kept.{name}" gold/{name} gate/{name}' for name in memories]
    return [*lines, *_GATES, *named, *_COMPARE, f"log -stderr EQUAL {entity}"]
