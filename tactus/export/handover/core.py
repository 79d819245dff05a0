"""Describes the export as a FuseSoC core."""

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
