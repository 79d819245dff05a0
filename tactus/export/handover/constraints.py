"""Examples of constraint files: they state the clock, and what a user must add."""

from string import Template

_XDC = Template("""\
# Digilent Arty A7-35 (xc7a35ticsg324-1L), Vivado: an example, with $top of scene $scene as top.
# Only clk is placed, on the board's 100 MHz oscillator. Synthesis, implementation and timing run
# with this file alone; for a bitstream every other port needs a PACKAGE_PIN and an IOSTANDARD, or
# $top becomes a part of a design that has pins.
# The scene is meant for $mhz MHz ($period ns). Where 10 ns are too short, put a clock manager
# between the oscillator and clk; it derives its own clock from this one.

set_property -dict { PACKAGE_PIN E3 IOSTANDARD LVCMOS33 } [get_ports { clk }]
create_clock -name clk -period 10.000 -waveform { 0.000 5.000 } [get_ports { clk }]

# rst is synchronous: drive it from a register on clk.
""")

_UCF = Template("""\
# Xilinx ISE (Virtex-II to Virtex-6, Spartan-3, Spartan-6), with $top of scene $scene as top.
# The clock that the scene is meant for: $mhz MHz. No pin is placed; give each port a LOC and an
# IOSTANDARD, or make $top a part of a design that has pins.

NET "clk" TNM_NET = "clk";
TIMESPEC "TS_clk" = PERIOD "clk" $period ns HIGH 50 %;

# NET "clk" LOC = "...";
""")


def constraints(scene: str, top: str, clock_mhz: float) -> dict[str, str]:
    """The texts of the constraint files, by file name."""
    facts = {
        "scene": scene,
        "top": top,
        "mhz": f"{clock_mhz:g}",
        "period": f"{1000 / clock_mhz:.3f}",
    }
    return {
        "arty_a7_35.xdc": _XDC.substitute(facts),
        "ise.ucf": _UCF.substitute(facts),
    }
