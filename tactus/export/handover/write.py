"""Writes the files from which a user of an export starts, beside its entities."""

from pathlib import Path

import numpy as np

from golden.networks.network import Network
from tactus.export.handover.constraints import constraints
from tactus.export.handover.core import core, plain_name
from tactus.export.handover.example import example
from tactus.export.handover.ports import SUFFIX, read_ports
from tactus.export.handover.test_bench import test_bench
from tactus.export.handover.vectors import CLOCKS, FRAMES, vectors, winners_of
from tactus.scene import Scene


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
