"""One recorded frame through the exported Verilog of a scene, for the report's timing diagram.

This is not a bench: nothing is compared here. Icarus plays the frame into the top entity and prints
the streams of the top and of the networks in it, clock by clock.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from golden.networks.multiple import Several
from golden.networks.network import Network
from golden.numbers.fixed import Fix
from golden.numbers.precision import SIGNAL
from tactus.core.folders import BUILD
from tactus.export.tidy import read_ports
from tactus.scene import Scene
from tactus.verify.benches.runner import export
from tactus.verify.benches.tools import check_simulator
from tactus.verify.prove import bench, printed

MEMBER = ("in_valid", "in_data", "in_last", "out_valid", "out_data")


@dataclass(frozen=True)
class Row:
    """What stood on one port of a design during a recording.

    owner: Whose port it is. Neighbouring ports with the same owner share this heading.
    values: The values just before the rising edge of each clock, None if undefined.
    fmt: The format of the codes, or None for a flag.
    valid: A flag of the same owner, which says in which clocks the codes count.
    """

    owner: str
    name: str
    values: tuple[int | None, ...]
    fmt: Fix | None = None
    valid: str = ""


# A recorded port: where it is in the simulation, and how the picture names its owner and itself.
Watched = tuple[str, str, str]


def simulate_frame(scene: Scene, frame: int = 0, build: Path = BUILD) -> list[Row]:
    """The streams of the scene's top, and of the networks of a cascade, during one frame.

    scene: One whose design takes a stream of samples, or all of them at once.
    frame: Row of the scene's recorded vectors. If there are several recordings, of the first.
    build: The folder of the export, which is made if it is not there.
    """
    check_simulator("icarus")
    design = scene.twin()
    codes, past = scene.vectors().recordings[0], design.past
    last = len(codes) - past - 1
    if not 0 <= frame <= last:
        raise InputError(f"{scene.path}: frame: got {frame}, expected 0 to {last}")
    export(scene, "verilog", build)
    folder = build / scene.name / "verilog"
    watched = list(_watched(scene, design, folder))
    paths = ", ".join(path for path, *_ in watched)
    # The frames before it fill the past, and are not shown.
    show = f'if (begun && f == {past}) $display("row{" %b" * len(watched)}", {paths});'
    frames = codes[frame : frame + past + 1] % (1 << SIGNAL.width)
    said = printed(bench(_played(design), past + 1, show), frames, folder)
    rows = [line.split() for line in said.splitlines()]
    columns = zip(*(bits for word, *bits in rows if word == "row"), strict=True)
    return [
        _port(owner, name, bits) for (_, owner, name), bits in zip(watched, columns, strict=True)
    ]


def _played(design: Network) -> dict[str, Any]:
    """What ``bench`` reads of a design; see ``tactus.verify.every_frame.specify``."""
    serial, own = design.stream == "serial", ("clk", "rst")
    others = [port for port in design.ports if port.direction == "in" and port.name not in own]
    return {
        "entity": design.entity,
        "stream": design.stream,
        "bits": SIGNAL.width,
        "samples": design.inputs,
        "elements": design.input_controller.inputs if serial else 1,
        "outputs": range(design.outputs),
        "output_clocks": design.output_clocks,
        "interval": design.interval,
        "before": [{"name": "load", "data": list(design.image), "clocks": 0}] * bool(design.image),
        "ports": {port.name: port.width for port in others if not port.name.startswith("in_")},
    }


def _watched(scene: Scene, design: Network, folder: Path) -> Iterator[Watched]:
    """The ports of the top's input, those of the networks in it, and those of its output."""
    names = [port.name for port in read_ports(design, _text(folder, design.entity), "verilog")]
    entering = f"{design.entity}, frame in: {', '.join(scene.sensors)}"
    leaving = f"{design.entity}, frame out: {', '.join(scene.outputs)}"
    for name in names:
        if name.startswith("in_"):
            yield (f"dut.{name}", entering, name)
    core, path = design.core, "dut"
    members = core.networks if isinstance(core, Several) else ()
    if core is not design:
        path = f"dut.{_instance(folder, design.entity, core.entity)}"
    for network, output in zip(members, scene.outputs, strict=False):
        place = f"{path}.{_instance(folder, core.entity, network.entity)}"
        for name in MEMBER:
            yield (f"{place}.{name}", f"{network.entity}: {output}", name)
    for name in names:
        if name.startswith("out_"):
            yield (f"dut.{name}", leaving, name)


def _text(folder: Path, entity: str) -> str:
    return (folder / f"{entity}.v").read_text(encoding="utf-8")


def _instance(folder: Path, parent: str, entity: str) -> str:
    found = re.search(rf"^{re.escape(entity)} (\w+) \(", _text(folder, parent), re.M)
    if found is None:
        raise InputError(f"{folder / parent}.v: expected an instance of {entity}, found none")
    return found[1]


def _port(owner: str, name: str, bits: Sequence[str]) -> Row:
    """A port of the picture; one whose name says that it holds data gets a format."""
    known = [int(word, 2) if set(word) <= {"0", "1"} else None for word in bits]
    if "_data" not in name:
        return Row(owner, name, tuple(known))
    sign = 1 << (SIGNAL.width - 1)
    codes = tuple(None if code is None else (code ^ sign) - sign for code in known)
    return Row(owner, name, codes, SIGNAL, f"{name.split('_', 1)[0]}_valid")
