"""docs/tutorial.md, done as it stands, in a folder of a user's own."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from pages import TRAINED, cells, shows
from shared import Shared

from golden.errors import scene_errors
from golden.network_files.network_file import provenance_path
from golden.scene import load_scene

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "tutorial.md").read_text()
FILES = ROOT / "docs" / "tutorial"


def run(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", *words]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def scene(shared: Shared) -> Path:
    """The trained scene."""
    folder = shared.folder / "own" / "rig"

    def train() -> None:
        shutil.copytree(FILES, folder)
        trained = run("golden.training", str(folder / "rig.toml"))
        assert trained.returncode == 0, trained.stderr

    shared.once("rig", train)
    return folder / "rig.toml"


def test_the_page_shows_the_files() -> None:
    assert f"```toml\n{(FILES / 'rig.toml').read_text()}```" in PAGE
    assert "".join((FILES / "readings.csv").read_text().splitlines(True)[:3]) in PAGE


def test_the_errors_are_about_those_shown(scene: Path) -> None:
    """A last bit turns a training to another minimum: within a factor of two of one machine's."""
    rig = load_scene(str(scene))
    for name, error in zip(rig.outputs, scene_errors(rig)["bit-true"], strict=True):
        shown = re.search(rf"^{name} +(?:[\d.]+ +){{3}}([\d.]+) ", PAGE, re.M)
        assert shown
        assert 0.5 * float(shown[1]) < error.mean < 2 * float(shown[1])


def test_the_networks_are_as_good_as_on_other_machines(scene: Path) -> None:
    page = "".join(PAGE.partition("### On another machine")[1:]).partition("\n## ")[0]
    for member in load_scene(str(scene)).members:
        story = tomllib.loads(provenance_path(member.weights_path).read_text())
        found = (
            np.abs(member.load().w1).sum(),
            story["validation_rms_percent"],
            story["test_rms_percent"],
        )
        for text, figure in zip(cells(page, *member.outputs), found, strict=True):
            assert shows(text, figure, TRAINED), member.outputs


def test_a_misspelt_key_is_refused_as_shown(scene: Path) -> None:
    odd = scene.with_name("odd.toml")
    odd.write_text(scene.read_text().replace("precision =", "precison ="))
    refused = run("tb.sim", str(odd))
    assert refused.returncode == 2
    shown = re.search(r"^error: rig.toml: (.*)$", PAGE, re.M)
    assert shown
    assert refused.stderr.strip() == f"error: {odd}: {shown[1]}"


def test_it_simulates(scene: Path) -> None:
    simulated = run("tb.sim", str(scene), "--block", "engine", "--sim", "icarus")
    assert simulated.returncode == 0, simulated.stdout + simulated.stderr
    assert "1 benches, 0 failed" in simulated.stdout


def test_it_exports(scene: Path, tmp_path: Path) -> None:
    exported = run("hdl.export", str(scene), "vhdl", "--build", str(tmp_path))
    assert exported.returncode == 0, exported.stderr
    assert (tmp_path / "rig" / "vhdl" / "engine.vhd").is_file()
    assert (tmp_path / "rig" / "vhdl" / "engine_tb.vhd").is_file()


def test_two_lines_make_it_an_instrument(scene: Path) -> None:
    whole = scene.with_name("whole.toml")
    whole.write_text(scene.read_text() + "\n[front_end]\n")
    design = load_scene(str(whole)).twin()
    assert design.entity == "instrument"
    assert design.scan_sequencer.slots == 5
