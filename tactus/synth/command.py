"""``make synth``: finds the cells of every block and the clock, beside the thesis.

``build/<scene>/synth`` gets ``cells.csv`` with every entity, and ``synth.json`` with every figure
and the versions of the tools. It is an error if an entity does not cost what the recorded budget
says, even if it costs less.
"""

from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from golden.networks.network import Network
from tactus.core.cli import stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.files import replace_folder, write_json
from tactus.core.progress import Progress
from tactus.core.table import write_csv_file
from tactus.export.exporter import export
from tactus.scene import Scene, load_scene
from tactus.synth.budget import (
    CELLS,
    COLUMNS,
    TIMING,
    Cells,
    by_block,
    differences,
    is_recorded,
    read_budget,
    rows,
    shares,
    table_of,
    write_budget,
)
from tactus.synth.cells import (
    FAMILIES,
    FLAT,
    FLAT_FAMILY,
    KINDS,
    flat_name,
    synthesise,
    synthesise_flat,
)
from tactus.synth.timing import DEVICE_NAME, PINS, TOOLS, Timing, route, write_timing
from tactus.synth.tools import digest


def speed(scene: Scene, design: Network, timing: Timing) -> dict[str, Any]:
    """The timing, with latency and frames per second at the clock that was reached."""
    return {
        **asdict(timing),
        "needed_mhz": scene.clock_mhz,
        "latency_us": design.output_clocks[-1] / timing.clock_mhz,
        "frames_per_second": timing.clock_mhz * 1e6 / design.interval,
    }


def tell(scene: Scene, design: Network, cells: Cells, share: dict[str, Any]) -> None:
    for family, meaning in FAMILIES.items():
        print(f"\n{meaning} (synth_xilinx -family {family}); of each block the largest entity")
        print(f"{'':28}{'entities':>10}" + "".join(f"{name:>12}" for name in KINDS))
        for name, count, found in by_block(design, cells, family):
            print(f"{name:28}{count:10}" + "".join(f"{found[c]:12}" for c in KINDS))
        flat = cells[family].get(flat_name(design.entity))
        if flat:
            print(f"{f'{design.entity}, {FLAT}':38}" + "".join(f"{flat[c]:12}" for c in KINDS))
    text = f"{share['luts_percent']:.0f} % of the LUTs, {share['mult18x18_percent']:.0f} % of the"
    print(f"\n{scene.name} in an {share['device']}: {text} multipliers")
    printed = share.get("thesis", {})
    if "luts_percent" in printed:
        print(
            f"thesis, {printed['table']}: {printed['luts_percent']} % of the LUTs, "
            f"{printed['mult18x18_percent']} % of the multipliers"
        )


def work(scene: Scene, design: Network, verilog: Path) -> tuple[Cells, Timing]:
    """Run the tools side by side, and return cells and timing."""
    top = design.entity
    with (
        ThreadPoolExecutor() as pool,
        Progress(f"{scene.name}: synthesising, placing and routing", 4, "runs") as progress,
    ):
        # The run that takes longest starts first.
        routed = pool.submit(route, verilog, top, scene.clock_mhz)
        jobs = {family: pool.submit(synthesise, verilog, top, family) for family in FAMILIES}
        flat = pool.submit(synthesise_flat, verilog, top)
        named: dict[Future[Any], str] = {routed: DEVICE_NAME, flat: FLAT}
        named |= {job: name for name, job in jobs.items()}
        for ended in as_completed(named):
            ended.result()
            progress.step(named[ended])
    cells = {family: job.result() for family, job in jobs.items()}
    cells[FLAT_FAMILY][flat_name(top)] = flat.result()
    return cells, routed.result()


def main() -> None:
    arguments = arguments_of("synth", __doc__)
    scene = load_scene(arguments.scene)
    design = scene.twin()
    stop_if_dry_run(f"synthesise, place and route scene {scene.name}")
    with replace_folder(arguments.build / scene.name / "synth") as folder:
        verilog = folder / "verilog"
        export(scene, "verilog", verilog)
        cells, timing = work(scene, design, verilog)
        share = shares(scene, design, cells)
        tell(scene, design, cells, share)
        reached = speed(scene, design, timing)
        ports = sum(port.width for port in design.ports)
        apart = f", without pins for {ports} bits of ports" if ports > PINS else ""
        print(
            f"\n{DEVICE_NAME}, placed and routed{apart}\n"
            f"{timing.luts} LUTs, {timing.flip_flops} flip-flops, {timing.multipliers} "
            f"multipliers, {timing.block_rams} block RAMs\n"
            f"{timing.clock_mhz} MHz reached, {scene.clock_mhz:g} MHz needed: "
            f"{reached['latency_us']:.2f} us from the last sample to the last output, "
            f"{reached['frames_per_second']:,.0f} frames a second\n"
            f"slowest path: {timing.slowest}"
        )
        tools = {name: version(name) for name in TOOLS}
        everything = {"versions": tools, "cells": cells, "share": share, "timing": reached}
        write_json(folder / "synth.json", everything)
        write_csv_file(folder / "cells.csv", [COLUMNS, *rows(cells)])
        if arguments.record:
            write_budget(scene.path, cells)
            write_timing(scene.path, timing, digest(verilog))
            paths = (str(table_of(scene.path, kind)[0]) for kind in (CELLS, TIMING))
            print(f"wrote {' and '.join(paths)}")
    _compare(scene, cells)
    if timing.clock_mhz < scene.clock_mhz:
        raise InputError(
            f"{scene.path}: hardware.clock_mhz: got {scene.clock_mhz:g}, expected at most "
            f"{timing.clock_mhz}, the clock that was reached"
        )


def _compare(scene: Scene, cells: Cells) -> None:
    path, _ = table_of(scene.path, CELLS)
    if not is_recorded(scene.path, CELLS):
        print(f"nothing recorded; RECORD=1 writes {path}")
        return
    lines = differences(cells, read_budget(scene.path))
    if lines:
        raise InputError(
            f"{path}: {len(lines)} figures differ; RECORD=1 records them\n" + "\n".join(lines)
        )
    print(f"as recorded in {path}")
