"""Proves, for every input, that nothing valid depends on an unknown register.

The netlist of ``tactus/verify/sign_off/unknown.py`` is given to Yosys' ``sat``, which treats
unknown bits as a simulator with four states does. After the first clock of reset, and for all
inputs, this is proved:

- every flag is known, and so is every register that has a reset;
- data that belong to a flag are known in each clock in which the flag is high.

The proof is an induction over as many clocks as it needs, from every state of the registers. Each
unknown bit is treated as independent of all others. So whatever is proved is true, but something
true may not be provable.
"""

import tempfile
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.synth.tools import run_tool
from tactus.verify.sign_off.unknown import Netlist, Register

# For each flag: how the names of the outputs begin that are its data.
VALID = {"out_valid": "out_", "m_axis_tvalid": "m_axis_t"}
# No pipeline has so many clocks. The bound is in clocks and not in seconds, so that it is the same
# on every machine.
MOST_CLOCKS = 16
# The most bits of registers. Larger blocks would take minutes, and their parts are proved anyway.
MOST_BITS = 700
# The most bits that all cells give together. With more, as in the tables of bipartite_pair, Yosys'
# solver runs out of the memory that WebAssembly has.
MOST_GATE_BITS = 50_000
HELD = "what_reset_gives_a_value"


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
    large = len(netlist.flip_flops) > MOST_BITS or netlist.gate_bits > MOST_GATE_BITS
    if large or netlist.twin.latency > MOST_CLOCKS:
        return None
    left = [register for register in netlist.registers() if register.reset and register != unreset]
    if (unreset or not left) and not any(outputs(netlist)):
        # Nothing is proved of data without a flag, and registers that do not hang on the one whose
        # reset is left out are known all the same.
        return None
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        text = netlist.verilog(unreset, HELD) + watch(netlist, unreset)
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
    ports: dict[str, dict[str, Any]] = netlist.module["ports"]
    flags, data = outputs(netlist)
    lines = []
    for name, port in ports.items():
        kind = port["direction"] if port["direction"] == "input" else "wire"
        lines.append(f"  {kind} [{len(port['bits']) - 1}:0] {name};")
    lost = unreset.bits if unreset else ()
    held = sum(netlist.is_reset(bit) and bit not in lost for bit in netlist.flip_flops)
    unknown = [_unknown(name) for name in (*flags, HELD)]
    unknown += [f"({flag} & {_unknown(*found)})" for flag, found in data.items()]
    inputs = [name for name, port in ports.items() if port["direction"] == "input"]
    wires = ", ".join(f".{name}({name})" for name in (*ports, HELD))
    return "\n".join(
        [
            f"module watch({', '.join(inputs)}, wrong);",
            *lines,
            f"  wire [{max(held, 1) - 1}:0] {HELD};",
            "  output wrong;",
            f"  {netlist.top} entity({wires});",
            "  reg after = 0;",
            "  always @(posedge clk) after <= after | rst;",
            f"  assign wrong = after & ({' | '.join(unknown)});",
            "endmodule",
        ]
    )


def _unknown(*names: str) -> str:
    """An expression that is true if any bit of some nets is unknown: then their parity is, too."""
    return f"((^{{{', '.join(names)}}}) === 1'bx)"
