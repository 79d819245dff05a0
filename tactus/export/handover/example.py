"""An entity or module that only holds the network, so that users can copy signals and instance."""

from string import Template

from golden.common.port import Port
from tactus.export.handover.ports import verilog_type, vhdl_type

_VHDL = Template("""\
-- $top of scene $scene in a design of your own: copy component, signals and instance.
-- See docs/streams.md of tactus for what the ports mean.

library ieee;
use ieee.std_logic_1164.all;
use ieee.numeric_std.all;

entity ${top}_example is
end entity ${top}_example;

architecture example of ${top}_example is

    component $top
        port (
$ports
        );
    end component;

$signals

begin

    u_$top: $top
        port map (
$map
        );

end architecture example;
""")

_VERILOG = Template("""\
`timescale 1ns/10ps

// $top of scene $scene in a design of your own: copy signals and instance.
// See docs/streams.md of tactus for what the ports mean.

module ${top}_example;

$signals

    $top u_$top (
$map
    );

endmodule
""")


def example(scene: str, top: str, ports: list[Port], language: str) -> str:
    """The text of the example."""
    if language == "vhdl":
        return _VHDL.substitute(
            scene=scene,
            top=top,
            ports=";\n".join(f"            {p.name}: {p.direction} {vhdl_type(p)}" for p in ports),
            signals=vhdl_signals(ports),
            map=vhdl_map(ports),
        )
    kind = {"in": "reg", "out": "wire"}
    return _VERILOG.substitute(
        scene=scene,
        top=top,
        signals="\n".join(f"    {kind[p.direction]} {verilog_type(p)}{p.name};" for p in ports),
        map=",\n".join(f"        .{p.name}({p.name})" for p in ports),
    )


def vhdl_signals(ports: list[Port]) -> str:
    """A signal for each port, with the port's name; inputs start at 0."""
    lines = []
    for port in ports:
        zero = "(others => '0')" if port.width else "'0'"
        start = f" := {zero}" if port.direction == "in" else ""
        lines.append(f"    signal {port.name}: {vhdl_type(port)}{start};")
    return "\n".join(lines)


def vhdl_map(ports: list[Port], left_open: tuple[str, ...] = ()) -> str:
    """Connect each port to the signal with its name; those in ``left_open`` stay open."""
    return ",\n".join(
        f"            {p.name} => {'open' if p.name in left_open else p.name}" for p in ports
    )
