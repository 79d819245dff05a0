"""Writes a scene as VHDL or Verilog: a file for each entity, and what users start from."""

import json
import warnings
from pathlib import Path

import numpy as np
from myhdl import ToVerilogWarning, ToVHDLWarning

from golden.networks.network import Network
from tactus.core.files import replace_folder
from tactus.export.handover.ports import SUFFIX, read_ports
from tactus.export.handover.texts import (
    CLOCKS,
    FRAMES,
    constraints,
    core,
    example,
    plain_name,
    test_bench,
    vectors,
    winners_of,
)
from tactus.export.hierarchy import convert_hierarchy, elaborate
from tactus.scene import Scene

# This package declares functions that MyHDL's VHDL calls (stdl, bool). MyHDL writes it beside its
# output.
VHDL_PACKAGE = "pck_myhdl_011"
ORDER = "compile_order.txt"
MANIFEST = "manifest.json"


def compile_order(folder: Path) -> list[str]:
    """The names of the files of an export, in compile order."""
    return (folder / ORDER).read_text(encoding="utf-8").split()


def export(scene: Scene, language: str, folder: Path) -> list[str]:
    """Write the scene's network into ``folder``, replacing it as a whole.

    language: "vhdl" or "verilog".
    folder: Beside the entities it gets three things: ``compile_order.txt``, which lists the files
        in compile order; ``manifest.json``, which names block, file and latency of every entity;
        and the files that ``write_handover`` writes.

    Returns: File names in compile order.
    """
    design = scene.twin()
    with replace_folder(folder) as temporary, warnings.catch_warnings():
        # A warning means that MyHDL is not sure of a conversion. That is a fault here.
        warnings.simplefilter("error", ToVHDLWarning)
        warnings.simplefilter("error", ToVerilogWarning)
        # Where an image is loaded, the image makes the scene, and the hardware serves any scene.
        origin = None if design.image else f"scene {plain_name(scene.name)}"
        specs = convert_hierarchy(elaborate(design), temporary, language, origin)
        suffix = SUFFIX[language]
        files = [f"{spec.entity}{suffix}" for spec in specs]
        if language == "vhdl":
            files.insert(0, f"{VHDL_PACKAGE}{suffix}")
        (temporary / ORDER).write_text("".join(f"{name}\n" for name in files))
        manifest = [
            {
                "entity": spec.entity,
                "block": spec.block,
                "area": spec.area,
                "file": f"{spec.entity}{suffix}",
                "latency": spec.latency,
            }
            for spec in specs
        ]
        (temporary / MANIFEST).write_text(json.dumps(manifest, indent=1) + "\n")
        write_handover(scene, design, temporary, ORDER, files, language)
    return files


def write_handover(
    scene: Scene, design: Network, folder: Path, order: str, files: list[str], language: str
) -> None:
    """Write core file, example, constraints and, for VHDL, the test bench into the export's folder.

    scene, design: The scene and its design.
    folder: The folder that holds ``files``, which stand in compile order; the last one is the top.
    order: The name of the file with that order.
    """
    name, top, suffix = plain_name(scene.name), design.entity, SUFFIX[language]
    ports = read_ports(design, (folder / files[-1]).read_text(encoding="utf-8"), language)
    texts = constraints(name, top, scene.clock_mhz)
    texts[f"{top}_example{suffix}"] = example(name, top, ports, language)
    benches = []
    if language == "vhdl":
        most = max(design.past + 1, min(FRAMES, CLOCKS // design.interval))
        samples = np.concatenate(scene.vectors().recordings)[:most]
        benches = [f"{top}_vectors{suffix}", f"{top}_tb{suffix}"]
        results = design.process(samples)
        winners = winners_of(design, results)
        texts[benches[0]] = vectors(name, top, samples, results, design.past, design.image, winners)
        texts[benches[1]] = test_bench(name, design, ports)
    description = (
        f"{scene.describe()} {scene.arrangement} network, {', '.join(scene.sensors)} to "
        f"{', '.join(scene.outputs)}"
    )
    texts[f"{name}.core"] = core(name, description, order, files, benches, language)
    for file, text in texts.items():
        (folder / file).write_text(text, encoding="utf-8")
