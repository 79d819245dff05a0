"""Tests that make check and make vhdl warn of outputs that saturate."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from golden.numbers.precision import SIGNAL
from golden.trained.mlp import Mlp
from tactus.core.finding import WARNING
from tactus.export.__main__ import export_scene
from tactus.network_files.network_file import save_network
from tactus.rig.check import everything
from tactus.scene import Scene, load_scene, scene_names
from tactus.scene.codes import saturating
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

RIGHT = random_mlp((3, 5, 2), 1.0, 2)
# Networks that fit the formats, and their outputs that always saturate.
WRONG = {
    "weights of 100": (replace(RIGHT, w2=np.full((2, 5), 100.0)), ["y0", "y1"]),
    "all weights of 100": (Mlp(*(np.full(a.shape, 100.0) for a in vars(RIGHT).values())), "both"),
    "a bias of 50,000": (replace(RIGHT, b2=np.array([50_000.0, 0.1])), ["y0"]),
    "a bias of -50,000": (replace(RIGHT, b2=np.array([0.1, -50_000.0])), ["y1"]),
}


def scene_of(folder: Path, mlp: Mlp, design: str = "hybrid", activation: str = "gradient") -> Scene:
    path = write_scene(folder, "rig", "exact", [RIGHT], design=design, activation=activation)
    save_network(path.with_suffix(".npz"), mlp, {})
    return load_scene(str(path))


def warned(scene: Scene, build: Path) -> list[str]:
    found = everything(scene, build)
    return [f.text for f in found if f.verdict == WARNING and "saturates" in f.text]


@pytest.mark.parametrize("name", WRONG)
@pytest.mark.parametrize(("design", "activation"), [("hybrid", "gradient"), ("engine", "precise")])
def test_outputs_that_saturate_are_named(
    tmp_path: Path, name: str, design: str, activation: str
) -> None:
    mlp, outputs = WRONG[name]
    scene = scene_of(tmp_path, mlp, design, activation)
    names = ["y0", "y1"] if outputs == "both" else outputs
    lines = warned(scene, tmp_path / "build")
    assert len(lines) == len(names)
    results = scene.twin().core.process(scene.vectors().codes)
    for line, output in zip(lines, names, strict=True):
        column = results[:, scene.outputs.index(output)]
        count = int(((column == SIGNAL.low) | (column == SIGNAL.high)).sum())
        assert count > 0.9 * len(column)
        text = "all" if count == len(column) else f"{count} of"
        assert line.startswith(f"output {output!r} saturates in {text} 12 recorded frames: ")


def test_an_export_warns_of_them(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, WRONG["a bias of 50,000"][0])
    with pytest.warns(UserWarning, match=r"rig\.toml: output 'y0' saturates in all 12 recorded"):
        export_scene(scene, "verilog", tmp_path / "verilog")


def test_no_shipped_scene_saturates() -> None:
    assert not [text for name in scene_names() for text in saturating(load_scene(name))]
