"""Describes an export to the tools of others: a FuseSoC core, and examples of constraints."""

import json
import re
from string import Template

_TEXT = Template("""\
CAPI=2:
# One of the export's files; $order lists the same files.
name: $name
description: $description
filesets:
$filesets
targets:
$targets""")


_FILES = Template("""\
  $name:
    file_type: $kind
    files:
$files""")


_TARGET = Template("""\
  $name:
    filesets: [$filesets]
    toplevel: $top
""")


# Data is undefined until the first frame has passed, and numeric_std warns of each operation on
# undefined data.
_GHDL = """\
    default_tool: ghdl
    tools:
      ghdl:
        analyze_options: [--std=93]
        run_options: [--ieee-asserts=disable]
"""


_KIND = {"vhdl": "vhdlSource-93", "verilog": "verilogSource-2005"}


def plain_name(scene: str) -> str:
    """The scene's name, with ``_`` for characters that FuseSoC or a VHDL-93 comment forbids."""
    return re.sub(r"[^A-Za-z0-9_.-]", "_", scene)


def core(
    scene: str, description: str, order: str, files: list[str], benches: list[str], language: str
) -> str:
    """The text of the ``.core`` file.

    scene: A ``plain_name``.
    order: The name of the file with the compile order.
    files: The design in compile order; the last one is named after the top.
    benches: The test bench in compile order; empty where there is none.
    """
    sets = {"rtl": files} | ({"tb": benches} if benches else {})
    targets = _TARGET.substitute(name="default", filesets="rtl", top=_entity(files))
    if benches:
        targets += _TARGET.substitute(name="sim", filesets="rtl, tb", top=_entity(benches)) + _GHDL
    return _TEXT.substitute(
        order=order,
        name=f"tactus::{scene}:0",
        description=json.dumps(description),
        filesets="".join(
            _FILES.substitute(
                name=name, kind=_KIND[language], files="".join(f"      - {f}\n" for f in names)
            )
            for name, names in sets.items()
        ).rstrip(),
        targets=targets,
    )


def _entity(files: list[str]) -> str:
    return files[-1].rsplit(".", 1)[0]


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
