"""The files beside the entities of an export: each is the text of a template in this folder.

A FuseSoC core, examples of constraints, an entity that holds the network, so that users can copy
signals and instance, and self-checking test benches with their vectors. A test bench needs nothing
but a simulator. The Verilog one reads samples and expected outputs from files, so that one compiled
bench serves any number of recordings.
"""

import json
import re
from collections.abc import Iterable, Sequence
from functools import cache
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined, Template

from golden.common.port import Port
from golden.instruments.converter_instrument import ConverterInstrument
from golden.instruments.uart_instrument import UartInstrument
from golden.link.uart_transmitter import BYTE_BITS
from golden.networks.axis_network import TUSER_HALF
from golden.networks.network import Network
from golden.numbers.fixed import Codes
from golden.sensing.converter_parts import TWOS
from tactus.export.handover.ports import SUFFIX, verilog_type, vhdl_type

# Longer recordings are cut to these lengths: any simulator elaborates so many constants in a
# second, and plays scans of so many clocks in a minute.
FRAMES = 4096
CLOCKS = 48_000
KIND = {"vhdl": "vhdlSource-93", "verilog": "verilogSource-2005"}
# All frames are sent twice: how, by the stream of the network.
GAPS = ("as close as the design takes them", "with gaps")
PASSES = {
    "converter": (
        "with a settled converter",
        "with codes that are right in the clock that takes them alone",
    ),
    "spi": ("with bits that come when sclk falls", "with bits that come as late as it rises"),
}


def plain_name(scene: str) -> str:
    """The scene's name, with ``_`` for characters that FuseSoC or a VHDL-93 comment forbids."""
    return re.sub(r"[^A-Za-z0-9_.-]", "_", scene)


@cache
def _template(name: str) -> Template:
    environment = Environment(
        loader=PackageLoader("tactus.export.handover", "."),
        undefined=StrictUndefined,
        autoescape=False,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {"vhdl_type": vhdl_type, "verilog_type": verilog_type}
    environment.globals |= {"zero": _zero, "table": _table}
    return environment.get_template(f"{name}.jinja")


def _zero(port: Port) -> str:
    """The start of an input in VHDL: 0."""
    if port.direction == "out":
        return ""
    return " := (others => '0')" if port.width else " := '0'"


def _table(codes: Iterable[int], width: int) -> str:
    """So many codes a line, each with its place: without, a list of one value is no aggregate."""
    cells = [f"{place} => {code}" for place, code in enumerate(codes)]
    lines = (", ".join(cells[at : at + width]) for at in range(0, len(cells), width))
    return ",\n".join(f"        {line}" for line in lines)


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
    return _template("core").render(
        scene=scene,
        description=json.dumps(description),
        order=order,
        sets=sets,
        kind=KIND[language],
    )


def constraints(scene: str, top: str, clock_mhz: float) -> dict[str, str]:
    """The texts of the constraint files, by file name."""
    facts = {"mhz": f"{clock_mhz:g}", "period": f"{1000 / clock_mhz:.3f}"}
    return {
        name: _template(name).render(scene=scene, top=top, **facts)
        for name in ("arty_a7_35.xdc", "ise.ucf")
    }


def example(scene: str, top: str, ports: list[Port], language: str) -> str:
    """An entity or module that only holds the network."""
    return _template(f"example{SUFFIX[language]}").render(scene=scene, top=top, ports=ports)


def test_bench(scene: str, design: Network, ports: list[Port]) -> str:
    """The text of the entity ``<top>_tb`` in VHDL-93."""
    return _template("test_bench.vhd").render(_facts(scene, design, ports))


def verilog_bench(scene: str, design: Network, ports: list[Port], most: int) -> str:
    """The text of the module ``<top>_tb`` in Verilog-2001.

    scene: A ``plain_name``.
    most: The most frames of a recording.
    """
    return _template("test_bench.v").render(_facts(scene, design, ports), most=most)


def _facts(scene: str, design: Network, ports: Sequence[Port]) -> dict[str, Any]:
    """What both test benches say of a design."""
    first, second = PASSES.get(design.stream, GAPS)
    # The held outputs are on the stream, too. Neither the profile nor a line is recorded.
    aside = ("held_", "profile_", "dac_", "tx")
    # Clocks from a frame's last element until all outputs have left slowly, and some more. Where
    # frames overlap in a loop, one that comes late waits for the next turn of the loop.
    clocks = design.output_clocks[-1]
    settle = clocks + design.interval + 3 * design.outputs * (clocks // design.interval + 2)
    line = None
    if design.image and isinstance(design, UartInstrument):
        # Scans go on while the packet comes, so that it takes a whole number of them with the rest.
        packet = len(design.image) * BYTE_BITS * design.divisor
        line = {"last": BYTE_BITS - 1, "rest": -packet % design.interval}
    return {
        "scene": scene,
        "design": design,
        "ports": ports,
        "used": [port for port in ports if not port.name.startswith(aside)],
        "names": {port.name for port in ports},
        "first": first,
        "second": second,
        "settle": settle,
        "half": TUSER_HALF,
        "line": line,
        "spi": _spi(design) if isinstance(design, ConverterInstrument) else None,
    }


def _spi(design: ConverterInstrument) -> dict[str, Any]:
    """What answers the transfers of a design: its commands, and how a code becomes bits."""
    reader = design.converter_reader
    part = reader.part
    step = 1 << max(0, -reader.shift)
    return {
        "final": reader.scan_clocks - 1,
        "asking": len(part.commands[0]),
        "commands": [int(part.commands[n], 2) for n in range(reader.inputs)],
        "middle": (1 << (reader.fmt.width - 1)) + step // 2,
        "step": step,
        "times": 1 << max(0, reader.shift),
        "most": (1 << part.bits) - 1,
        # A part that gives numbers with a sign.
        "turned": part.coding == TWOS,
        "half": 1 << (part.bits - 1),
        "span": 1 << part.bits,
        "before": part.first - 1,
        "last": part.last,
        # A part that repeats its bits.
        "again": part.mirrored,
        "zeros": [clock - 1 for clock in part.zeros],
    }


def winners_of(design: Network, results: Codes) -> Codes | None:
    """Index and margin of the largest output of each frame, where the hardware gives them."""
    return np.stack(design.argmax.process(results), axis=1) if design.argmax else None


def vectors(
    scene: str,
    top: str,
    samples: Codes,
    results: Codes,
    past: int = 0,
    image: bytes = b"",
    winners: Codes | None = None,
) -> str:
    """The text of the package ``<top>_vectors``: recorded frames and what the hardware gives.

    samples, results: shape (frames, inputs), (frames - past, outputs).
    image: The image that is loaded before the first frame; empty where none is.
    winners, shape (frames - past, 2): See ``winners_of``.
    """
    return _template("vectors.vhd").render(
        scene=scene,
        top=top,
        samples=samples,
        results=results,
        past=past,
        image=image,
        winners=winners,
    )


def hex_files(
    samples: Codes, results: Codes, image: bytes = b"", winners: Codes | None = None
) -> dict[str, str]:
    """The files that the Verilog test bench reads; codes in 32 bits, one line a frame.

    The arguments are those of ``vectors``.
    """
    files = {
        "frames.hex": f"{len(samples):08x}\n",
        "samples.hex": _words(samples),
        "results.hex": _words(results),
    }
    if image:
        files["image.hex"] = "".join(f"{byte:02x}\n" for byte in image)
    if winners is not None:
        files["winners.hex"] = _words(winners)
    return files


def _words(codes: Codes) -> str:
    words = np.asarray(codes) & 0xFFFFFFFF
    return "".join(" ".join(f"{word:08x}" for word in row) + "\n" for row in words.tolist())
