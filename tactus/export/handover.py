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
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Template

from golden.common.port import Port
from golden.instruments.converter_instrument import ConverterInstrument
from golden.instruments.uart_instrument import UartInstrument
from golden.link.uart import BYTE_BITS
from golden.networks.axis_network import TUSER_HALF
from golden.networks.network import Network
from golden.numbers.fixed import Codes
from golden.sensing.converter_parts import TWOS
from tactus.core.templates import environment
from tactus.export.tidy import SUFFIX, read_ports, verilog_type, vhdl_type
from tactus.scene import Scene

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
    found = environment("tactus.export")
    found.filters |= {"vhdl_type": vhdl_type, "verilog_type": verilog_type}
    found.globals |= {"zero": _zero, "table": _table}
    return found.get_template(f"{name}.jinja")


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


def write_handover(
    scene: Scene, design: Network, folder: Path, order: str, files: list[str], language: str
) -> None:
    """Write core file, example, constraints and, for VHDL, the test bench into the export's folder.

    folder: The folder that holds ``files``, which stand in compile order; the last one is the top.
    order: The name of the file with that order.
    """
    name, top, suffix = plain_name(scene.name), design.entity, SUFFIX[language]
    ports = read_ports(design, (folder / files[-1]).read_text(encoding="utf-8"), language)
    named = {"scene": name, "top": top}
    clock = {"mhz": f"{scene.clock_mhz:g}", "period": f"{1000 / scene.clock_mhz:.3f}"}
    texts = {f: _template(f).render(named, **clock) for f in ("arty_a7_35.xdc", "ise.ucf")}
    # An entity or module that only holds the network.
    texts[f"{top}_example{suffix}"] = _template(f"example{suffix}").render(named, ports=ports)
    sets = {"rtl": files}
    if language == "vhdl":
        most = max(design.past + 1, min(FRAMES, CLOCKS // design.interval))
        samples = np.concatenate(scene.vectors().recordings)[:most]
        sets["tb"] = benches = [f"{top}_vectors{suffix}", f"{top}_tb{suffix}"]
        results = design.process(samples)
        winners = winners_of(design, results)
        texts[benches[0]] = vectors(name, design, samples, results, winners)
        texts[benches[1]] = _template("test_bench.vhd").render(_facts(name, design, ports))
    description = (
        f"{scene.describe()} {scene.arrangement} network, {', '.join(scene.sensors)} to "
        f"{', '.join(scene.outputs)}"
    )
    texts[f"{name}.core"] = _template("core").render(
        scene=name,
        description=json.dumps(description),
        order=order,
        sets=sets,
        kind=KIND[language],
    )
    for file, text in texts.items():
        (folder / file).write_text(text, encoding="utf-8")


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
    scene: str, design: Network, samples: Codes, results: Codes, winners: Codes | None
) -> str:
    """The text of the package ``<top>_vectors``: recorded frames and what the hardware gives.

    samples, results: shape (frames, inputs), (frames - past, outputs).
    winners, shape (frames - past, 2): See ``winners_of``.
    """
    return _template("vectors.vhd").render(
        scene=scene,
        top=design.entity,
        samples=samples,
        results=results,
        past=design.past,
        image=design.image,
        winners=winners,
    )


def hex_files(
    design: Network, samples: Codes, results: Codes, winners: Codes | None
) -> dict[str, str]:
    """The files that the Verilog test bench reads; codes in 32 bits, one line a frame.

    The arguments are those of ``vectors``.
    """
    files = {
        "frames.hex": f"{len(samples):08x}\n",
        "samples.hex": _words(samples),
        "results.hex": _words(results),
    }
    if design.image:
        files["image.hex"] = "".join(f"{byte:02x}\n" for byte in design.image)
    if winners is not None:
        files["winners.hex"] = _words(winners)
    return files


def _words(codes: Codes) -> str:
    words = np.asarray(codes) & 0xFFFFFFFF
    return "".join(" ".join(f"{word:08x}" for word in row) + "\n" for row in words.tolist())
