"""Tests make check: it finds every fault at once, and no search begins with a fault."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from refused import Desk

from tactus.core.finding import FAULT, OK, WARNING, Finding, faults
from tactus.core.table import read_table, write_table
from tactus.rig.check import everything
from tactus.scene import load_scene, scene_names
from tactus.verify.benches.written import write_scene
from tactus.verify.check import check
from tb.common.cases import random_mlp

NAMES = ["x0", "x1", "x2", "y0", "y1"]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A trained cascade of two networks on the engine, without faults."""
    mlps = [random_mlp((3 + i, 4, 1), 0.5, i + 1) for i in range(2)]
    path = write_scene(
        tmp_path, "rig", "exact", mlps, "cascade", "precise", "{}", rows=60, design="engine"
    )
    table = read_table(path.with_suffix(".csv"), NAMES)
    table[:, 3] = 0.5 + table[:, :3] @ [0.2, -0.1, 0.05]
    table[:, 4] = 0.5 + table[:, :3] @ [-0.05, 0.1, 0.2]
    write_table(path.with_suffix(".csv"), NAMES, table, 4)
    return path


def findings_of(path: Path) -> list[Finding]:
    return check(str(path), path.parent / "build")


def change(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert re.search(old, text)
    path.write_text(re.sub(old, new, text, count=1))


@pytest.mark.parametrize("name", [n for n in scene_names() if not n.startswith("swing")])
def test_the_shipped_scenes_have_no_faults(name: str, tmp_path: Path) -> None:
    assert not faults(everything(load_scene(name), tmp_path))


def column(path: Path, name: str, values: Callable) -> None:
    """Change a column of the readings."""
    file = path.with_suffix(".csv")
    names = file.read_text().partition("\n")[0].split(",")
    table = read_table(file, names)
    table[:, names.index(name)] = values(table[:, names.index(name)])
    write_table(file, names, table, 6)


def semicolons(path: Path) -> None:
    file = path.with_suffix(".csv")
    file.write_text(file.read_text().replace(",", ";"))


def keep(rows: int) -> Callable[[Path], None]:
    def cut(path: Path) -> None:
        file = path.with_suffix(".csv")
        file.write_text("".join(file.read_text().splitlines(True)[: rows + 1]))

    return cut


def folder_for_a_file(path: Path) -> None:
    path.with_name("rig-1.npz").unlink()
    path.with_name("rig-1.npz").mkdir()


def file_for_a_folder(path: Path) -> None:
    (path.parent / "build").write_text("mine")


def other_shape(path: Path) -> None:
    change(path, r"hidden = \[4, 4\]", "hidden = [4, 5]")


def no_network(path: Path) -> None:
    path.with_name("rig.npz").write_text("mine")


def larger(path: Path) -> None:
    """Make a fifth of the readings larger than the codes."""
    column(path, "x1", lambda x: np.where(np.arange(len(x)) % 5 == 0, 2.0, x))


FAULTS = {
    "csv gone": (lambda p: p.with_suffix(".csv").unlink(), r"rig\.csv: no such file"),
    "separator": (semicolons, "got a semicolon between the cells"),
    "column": (lambda p: change(p, "'x1'|\"x1\"", '"x9"'), "no column 'x9'"),
    "rows": (keep(7), "got 7 rows, expected at least 8"),
    "blocks": (
        lambda p: change(p, r"\[training\]", '[training]\nsplit = "blocks"\nblock_rows = 50'),
        "got 1 blocks of about 50 rows, expected at least 4",
    ),
    "sensor": (lambda p: column(p, "x1", lambda x: 0 * x), "column 'x1': got 0 in every row"),
    "output": (lambda p: column(p, "y1", lambda y: 0 * y + 0.5), "take it out of data.outputs"),
    "codes": (larger, "got 12 of 60 readings outside -1 to 1"),
    "target": (lambda p: column(p, "y1", lambda y: 3 * y), "got a target of"),
    "zero": (lambda p: column(p, "y1", lambda y: y - y[0]), "holds a target of 0"),
    "ending": (lambda p: change(p, r"rig-1\.npz", "rig-1.txt"), "got the ending '.txt'"),
    "folder": (folder_for_a_file, r"rig-1\.npz: cannot be written: got a folder, expected a file"),
    "long": (lambda p: change(p, "rig-1", "n" * 250), "cannot be written: File name too long"),
    "nul": (lambda p: change(p, "rig-1", r"rig\\u0000"), "expected the name of a file"),
    "no folder": (lambda p: change(p, "rig-1", "rig.csv/rig"), r"rig\.npz: cannot be written"),
    "build": (file_for_a_folder, r"build/store/.*: cannot be written: .*Not a dir|File exists"),
    "shape": (other_shape, r"rig-1\.npz: w1: got shape \(4, 4\), expected \(5, 4\)"),
    "no network": (no_network, r"rig\.npz: not an NPZ of numbers"),
    "scene": (lambda p: change(p, "hidden =", "hiden ="), "key 'hiden' is not known"),
    "clocks": (
        lambda p: change(p, "interface", "clocks = 3\ninterface"),
        "clocks: got 3, expected",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_seen(path: Path, name: str) -> None:
    spoil, message = FAULTS[name]
    spoil(path)
    found = faults(findings_of(path))
    assert any(re.search(message, text) for text in found), found


def test_all_faults_are_told_at_once(path: Path) -> None:
    for name in ("sensor", "ending", "build", "no network"):
        FAULTS[name][0](path)
    found = faults(findings_of(path))
    assert len(found) >= 4
    for name in ("sensor", "ending", "build", "no network"):
        assert any(re.search(FAULTS[name][1], text) for text in found)


WARNINGS = {
    "few rows": (keep(30), "30 rows: 15 train"),
    "few codes": (lambda p: column(p, "x1", lambda x: x / 1000), "x1: moves over"),
    "end": (lambda p: column(p, "x1", lambda x: np.clip(x, -1, 0.4)), "x1: .* exactly 0.4"),
    "outside": (lambda p: column(p, "x1", lambda x: x * 1.02), "readings outside -1 to 1"),
    "same": (
        lambda p: column(p, "x1", lambda _: read_table(p.with_suffix(".csv"), ["x0"])[:, 0]),
        "'x1' repeats 'x0'",
    ),
    "told": (
        lambda p: column(p, "x2", lambda _: read_table(p.with_suffix(".csv"), ["y1"])[:, 0]),
        "'y1' repeats 'x2'",
    ),
}


@pytest.mark.parametrize("name", WARNINGS)
def test_what_makes_a_result_worse_is_warned_of(path: Path, name: str) -> None:
    spoil, message = WARNINGS[name]
    spoil(path)
    assert not faults(findings_of(path))
    lines = [str(finding) for finding in findings_of(path) if finding.verdict == WARNING]
    assert any(re.search(message, line) for line in lines), lines


def untrained(path: Path) -> None:
    for network in path.parent.glob("*.npz"):
        network.unlink()


def test_the_design_is_tried_with_the_least_and_the_largest_networks(path: Path) -> None:
    """The memories of a reloadable engine have a fixed size, whatever training finds."""
    untrained(path)
    change(path, r"hidden = \[4, 4\]", "hidden = 0")
    change(path, "interface", "reload = true\noperand_words = 32\ninterface")
    sizes = {"[2, 3]": OK, "[2, 25]": WARNING, "[24, 25]": FAULT}
    change(path, r"\[training\]", "[training]\nhidden = [4, 25]")
    for span, verdict in sizes.items():
        change(path, r"hidden = \[\d+, \d+\]", f"hidden = {span}")
        found = [f for f in findings_of(path) if "hidden nodes" in f.text or "operand" in f.text]
        assert [f.verdict for f in found] == [verdict], (span, found)


def test_raw_units_are_looked_at_with_their_scale(path: Path) -> None:
    untrained(path)
    column(path, "x1", lambda x: 4000 * x)
    column(path, "y1", lambda y: 200 * y)
    change(path, "outputs =", 'scale = "auto"\noutputs =')
    found = findings_of(path)
    assert not faults(found)
    line = next(f for f in found if f.subject == "x1")
    codes = [int(word) for word in re.findall(r"codes (-?\d+) to (-?\d+)", line.text)[0]]
    assert -8192 <= codes[0] < -4000 < 4000 < codes[1] <= 8191


def test_the_command_ends_with_2_where_there_is_a_fault(desk: Desk, path: Path) -> None:
    assert desk.call("check", str(path)) == (0, "")
    no_network(path)
    folder_for_a_file(path)
    count = len(faults(findings_of(path)))
    assert desk.call("check", str(path)) == (2, f"error: {path}: {count} faults, listed above\n")
