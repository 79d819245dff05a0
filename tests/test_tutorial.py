"""Types in what docs/tutorial, docs/new-design.md and docs/new-block.md show."""

import os
import re
import shutil
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest
from conftest import random_mlp, tiered, write_scene
from shared import CALL, ROOT, copy_room, run

from tactus.core.folders import ROOMS

FOLDER = ROOT / "docs" / "tutorial"
MONITOR = re.compile(r"^make monitor .*$", re.M)


def shell(text: str, copy: Path) -> subprocess.CompletedProcess[str]:
    # pyproject.toml looks newer than the environment, and a copy sets nothing up.
    given = f'make() {{ command make --no-print-directory -o ready "$@"; }}\n{text}'
    path = f"{sys.prefix}/bin:{os.environ['PATH']}"
    return run("bash", "-ec", given, folder=copy, VENV=sys.prefix, TERM="dumb", PATH=path)


def python(copy: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return run(sys.executable, *words, folder=copy)


def look(line: str, copy: Path) -> str:
    """What the browser is given by a monitor, which is then ended."""
    monitor = [sys.executable, "-m", "tactus.cli.commands", "monitor"]
    given = dict(word.split("=", 1) for word in line.split()[2:])
    with subprocess.Popen(
        monitor, cwd=copy, env=os.environ | given, stdout=subprocess.PIPE, text=True
    ) as running:
        try:
            address = re.search(r"http://\S+/", running.stdout.readline())
            with urllib.request.urlopen(address[0]) as page:
                return str(page.read(), "utf-8")
        finally:
            running.terminate()


@pytest.mark.parametrize("reader", tiered(["student"], ["researcher", "engineer"]))
def test_a_tutorial_does_what_it_shows(reader: str, tmp_path: Path) -> None:
    page = (FOLDER / f"{reader}.md").read_text(encoding="utf-8")
    for room in (*ROOMS, "docs/tutorial"):
        copy_room(room, tmp_path)
    for name in ("Makefile", "pyproject.toml"):
        (tmp_path / name).write_text((ROOT / name).read_text())
    for name, text in re.findall(r"^`([\w/.-]+)`:\n\n```\w+\n(.*?)```", page, re.M | re.S):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    typed = "".join(re.findall(r"^```sh\n(.*?)```", page, re.M | re.S)).replace(
        "mkdir ", "mkdir -p "
    )
    done = shell(MONITOR.sub("", typed), tmp_path)
    assert done.returncode == 0, f"{done.stdout[-3000:]}{done.stderr[-3000:]}"
    for block in re.findall(r"^```text\n(.*?)```", page, re.M | re.S):
        for line in block.splitlines():
            assert line.strip() in done.stdout, line
    for line in MONITOR.findall(typed):
        assert "place" in look(line, tmp_path)


def test_make_scene_drafts_the_scene_of_the_rail(tmp_path: Path) -> None:
    readings, written = FOLDER / "readings.csv", tmp_path / "rig.toml"
    (tmp_path / "readings.csv").write_text(readings.read_text())
    command = ["tactus.cli.scene", str(tmp_path / "readings.csv"), "force,place"]
    done = run(*CALL, *command, "--to", written)
    assert done.returncode == 0, done.stderr
    text = written.read_text().replace(os.path.relpath(ROOT, tmp_path), "../tactus", 1)
    assert text == (FOLDER / "rig.toml").read_text()


PAGE = (ROOT / "docs" / "new-design.md").read_text()
SHAPES = {"single": [(2, 5, 2)], "cascade": [(1, 1, 1), (2, 2, 1)]}
NAMED = r"^`([\w/.-]+)`[^\n]*(?:\n[^\n]+)*\n\n```(?:python|markdown)\n(.*?)```"
# Compares the design with hybrid, runs the cases of stability, and checks words of its picture.
ASKED = """
import sys
from xml.etree import ElementTree
import numpy as np
from tactus.scene import load_scene
from tactus.report.draw.datapath import datapath
from studies.stability.networks import huge_weights
scene, other = (load_scene(path).twin() for path in sys.argv[1:])
frames = np.random.default_rng(1).integers(-8192, 8192, (2000, scene.inputs))
assert np.array_equal(scene.process(frames), other.process(frames))
assert scene.interval == 5
rows = [row for row in huge_weights() if row.model == "rowwise"]
assert len(rows) == 6 and all(row.holds for row in rows)
drawn = ElementTree.fromstring(datapath(load_scene(sys.argv[1])))
shown = {element.text for element in drawn.iter()}
assert {"2 x", "5 q", "5 r", "2 y"} <= shown, shown
"""


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the project with the four files."""
    folder = tmp_path_factory.mktemp("design") / "tactus"
    for room in ("golden", "hdl", "scenes", "tactus", "tb", "docs", "studies", "tests"):
        copy_room(room, folder)
    for name in ("Makefile", "pyproject.toml"):
        shutil.copy(ROOT / name, folder)
    files = re.findall(NAMED, PAGE, re.M | re.S)
    assert [name for name, _ in files] == [
        "golden/networks/rowwise.py",
        "hdl/networks/rowwise.py",
        "tb/networks/tb_rowwise.py",
        "docs/blocks/rowwise.md",
    ]
    for name, text in files:
        assert not (folder / name).exists()
        (folder / name).write_text(text)
    return folder


def scene(folder: Path, arrangement: str, design: str = "rowwise") -> str:
    mlps = [random_mlp(shape, 1.0, i) for i, shape in enumerate(SHAPES[arrangement])]
    name = f"{design}-{arrangement}"
    return str(write_scene(folder, name, "exact", mlps, arrangement, design=design))


@pytest.mark.all_only
def test_the_rooms_are_complete(copy: Path) -> None:
    found = python(copy, "-m", "pytest", "-q", "tests/test_census.py")
    assert found.returncode == 0, found.stdout
    linted = python(copy, "-m", "ruff", "check", "golden", "hdl", "tb")
    assert linted.returncode == 0, linted.stdout


@pytest.mark.all_only
def test_everybody_asks_the_twin(copy: Path, tmp_path: Path) -> None:
    scenes = (scene(tmp_path, "single", design) for design in ("rowwise", "hybrid"))
    asked = python(copy, "-c", ASKED, *scenes)
    assert asked.returncode == 0, asked.stderr


@pytest.mark.all_only
@pytest.mark.parametrize(("arrangement", "block"), [("single", "rowwise"), ("cascade", "cascade")])
def test_its_benches_pass(copy: Path, tmp_path: Path, arrangement: str, block: str) -> None:
    words = (*CALL[1:], "tactus.verify.sim", scene(tmp_path, arrangement), "--block", block)
    simulated = python(copy, *words)
    assert simulated.returncode == 0, simulated.stdout + simulated.stderr
    assert "2 benches, 0 failed" in simulated.stdout


@pytest.mark.all_only
def test_the_worked_example_works(tmp_path: Path) -> None:
    """docs/new-block.md, typed in as it stands: the block trains, simulates and is found out."""
    page = (ROOT / "docs" / "new-block.md").read_text()
    copy = tmp_path / "tactus"
    for room in ("golden", "hdl", "scenes", "tactus", "tb", "docs"):
        copy_room(room, copy)
    named = r"^`([\w/.-]+\.(?:py|toml))`[^\n]*(?:\n[^\n]+)*:\n\n```(?:python|toml)\n(.*?)```"
    files = re.findall(named, page, re.M | re.S)
    assert len(files) >= 4
    for name, text in files:
        (copy / name).parent.mkdir(exist_ok=True)
        (copy / name).write_text(text)
    sheet = re.search(r"^`(docs/blocks/\w+\.md)`.*?\n````markdown\n(.*?)````$", page, re.M | re.S)
    (copy / sheet[1]).write_text(sheet[2])
    scene = next(name for name, _ in files if name.endswith(".toml"))

    trained = python(copy, *CALL[1:], "tactus.cli.train", scene)
    assert trained.returncode == 0, trained.stderr
    simulated = python(copy, *CALL[1:], "tactus.verify.sim", scene, "--block", "relu")
    assert simulated.returncode == 0, simulated.stdout + simulated.stderr
    assert "2 benches, 0 failed" in simulated.stdout
    hardware = copy / "hdl" / "activation" / "relu.py"
    hardware.write_text(hardware.read_text().replace("Rounding.ROUND", "Rounding.TRUNCATE"))
    broken = python(copy, *CALL[1:], "tactus.verify.sim", scene, "--block=relu", "--sim=icarus")
    assert broken.returncode == 1
    assert "results differ" in broken.stdout
