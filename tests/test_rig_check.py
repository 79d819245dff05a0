"""Tests make check, which finds every fault at once, and make predict, which marks readings."""

import csv
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from refused import Desk
from shared import CALL, run

from golden.numbers.precision import SIGNAL
from golden.trained.dense import DenseNetwork, packed, unpacked
from tactus.core.finding import FAULT, OK, WARNING, Finding, faults
from tactus.core.table import read_csv_file, read_table, write_table
from tactus.export.command import export_scene
from tactus.network_files.network_file import save_network
from tactus.rig.check import everything
from tactus.rig.predict import (
    UNLIKE,
    TrainedOn,
    learnt,
    predict,
    readings_of,
    trained_on,
    write_prediction,
)
from tactus.scene import Scene, load_scene
from tactus.train.split import split_story
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


def column(path: Path, name: str, values: Callable) -> None:
    """Change a column of the readings."""
    file = path.with_suffix(".csv")
    names = file.read_text().partition("\n")[0].split(",")
    table = read_table(file, names)
    table[:, names.index(name)] = values(table[:, names.index(name)])
    write_table(file, names, table, 6)


def no_network(path: Path) -> None:
    path.with_name("rig.npz").write_text("mine")


def larger(path: Path) -> None:
    """Make a fifth of the readings larger than the codes."""
    column(path, "x1", lambda x: np.where(np.arange(len(x)) % 5 == 0, 2.0, x))


FAULTS = {
    "sensor": (lambda p: column(p, "x1", lambda x: 0 * x), "column 'x1': got 0 in every row"),
    "codes": (larger, "got 12 of 60 readings outside -1 to 1"),
    "ending": (lambda p: change(p, r"rig-1\.npz", "rig-1.txt"), "got the ending '.txt'"),
    "build": (
        lambda p: (p.parent / "build").write_text("mine"),
        r"build/store/.*: cannot be written: .*Not a dir|File exists",
    ),
    "shape": (
        lambda p: change(p, r"hidden = \[4, 4\]", "hidden = [4, 5]"),
        r"rig-1\.npz: w1: got shape \(4, 4\), expected \(5, 4\)",
    ),
    "no network": (no_network, r"rig\.npz: not an NPZ of numbers"),
    "clocks": (
        lambda p: change(p, "interface", "clocks = 3\ninterface"),
        "clocks: got 3, expected",
    ),
}


@pytest.mark.parametrize(
    "names", ["sensor, ending, build, no network", "codes", "build, shape", "clocks"]
)
def test_all_faults_are_told_at_once(path: Path, names: str) -> None:
    for name in names.split(", "):
        FAULTS[name][0](path)
    found = faults(findings_of(path))
    for name in names.split(", "):
        assert any(re.search(FAULTS[name][1], text) for text in found), found


WARNINGS = {
    "few rows": (
        lambda p: change(p.with_suffix(".csv"), r"\A((?:.*\n){31})(?s:.*)", r"\1"),
        "30 rows: 15 train",
    ),
    "few codes": (lambda p: column(p, "x1", lambda x: x / 1000), "x1: moves over"),
    "few codes of an output": (lambda p: column(p, "y1", lambda y: y / 1000), "y1: moves over"),
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
    "rate": (
        lambda p: (
            change(p, r"\[network\]", "window = { x2 = [1] }\n[network]"),
            change(p, r"\[training\]", '[front_end]\n[training]\nsplit = "blocks"'),
        ),
        "front_end.rate_hz: got none",
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
    path.with_name("rig-1.npz").unlink()
    path.with_name("rig-1.npz").mkdir()
    count = len(faults(findings_of(path)))
    assert desk.call("check", str(path)) == (2, f"error: {path}: {count} faults, listed above\n")


@pytest.fixture
def scene(tmp_path: Path) -> Scene:
    """A cascade whose networks were trained on its readings, according to their provenance."""
    mlps = [random_mlp((3 + i, 4, 1), 0.5, i) for i in range(2)]
    path = write_scene(
        tmp_path, "rig", "exact", mlps, "cascade", "precise", "{}", rows=60, design="engine"
    )
    scene = load_scene(str(path))
    for member, mlp in zip(scene.members, mlps, strict=True):
        shape = ":".join(str(n) for n in mlp.shape)
        save_network(member.weights_path, mlp, {**split_story(scene), "network": shape})
    return load_scene(str(path))


def new_csv(folder: Path, text: str) -> Path:
    path = folder / "new.csv"
    path.write_text(text, encoding="utf-8")
    return path


def done(scene: Scene, source: Path) -> list[dict[str, str]]:
    """The rows of the file that is written."""
    recording = read_csv_file(source)
    found = predict(scene, readings_of(scene, recording), trained_on(scene)[0])
    out = source.with_name("out.csv")
    write_prediction(scene, recording, found, out)
    with out.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_outputs_are_those_of_the_twin(scene: Scene) -> None:
    rows = done(scene, scene.data_path)
    wanted = SIGNAL.to_real(scene.twin().process(scene.vectors().codes))
    got = np.array([[float(row["y0_predicted"]), float(row["y1_predicted"])] for row in rows])
    # Four decimals distinguish two codes.
    assert np.array_equal(np.rint(got * 8192), wanted * 8192)
    assert "." in rows[0]["y0_predicted"]


def test_every_column_stays_as_it_stands(scene: Scene) -> None:
    source = new_csv(scene.path.parent, 'when,x2,x0,"a, b",x1\n08:15,0.10,-0,"x ""y""",1e-1\n')
    rows = done(scene, source)
    assert list(rows[0])[:5] == ["when", "x2", "x0", "a, b", "x1"]
    assert list(rows[0].values())[:5] == ["08:15", "0.10", "-0", 'x "y"', "1e-1"]
    sensors = np.array([[0, 0.1, 0.1]])
    results = scene.outputs_in_units(scene.twin().process(scene.codes_of(sensors)))
    assert float(rows[0]["y1_predicted"]) == pytest.approx(results[0, 1], abs=1e-4)
    assert list(rows[0])[5:] == ["y0_predicted", "y1_predicted", "distance", "outside", "reason"]


SIDES = np.array([-1.0, 0.0, 1.0, 2.0])


def touch(states: np.ndarray, seed: int = 0) -> np.ndarray:
    """The readings of four sensors for forces and places, with a little noise."""
    plain = states[:, :1] * np.exp(-((states[:, 1:] - SIDES) ** 2))
    return plain + np.random.default_rng(seed).normal(0, 0.002, plain.shape)


def drawn(count: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform([1.0, -0.5], [2.0, 1.5], (count, 2))


def estimates(readings: np.ndarray, seed: int = 3) -> np.ndarray:
    """The outputs of a good network: the recorded state with the nearest readings."""
    states = drawn(4000, seed)
    far = ((touch(states)[:, np.newaxis] - readings) ** 2).sum(axis=2)
    return states[far.argmin(axis=0)]


def learnt_from(states: np.ndarray, held: np.ndarray, known: int) -> TrainedOn:
    names, outputs = ("force", "place"), estimates(held)
    ends = states.min(axis=0), states.max(axis=0)
    return learnt(names, touch(states, 1), states, held, outputs, np.full(4, 1e-4), ends, known)


@pytest.fixture(scope="module")
def known() -> TrainedOn:
    return learnt_from(drawn(120, 1), touch(drawn(120, 2), 2), 120)


def reasons(known: TrainedOn, readings: np.ndarray, outputs: np.ndarray) -> list[str]:
    return known.reasons(outputs, known.distances(readings, outputs))


def test_swapped_columns_are_outside(known: TrainedOn) -> None:
    fresh = touch(drawn(500, 7), 7)
    for order in ([1, 0, 2, 3], [0, 2, 1, 3], [3, 1, 2, 0]):
        swapped = fresh[:, order]
        # The swap has no effect if both readings are equal.
        differ = np.abs(swapped - fresh).max(axis=1) > 0.1
        said = reasons(known, swapped[differ], estimates(swapped[differ]))
        assert np.mean([UNLIKE in text for text in said]) > 0.95


def test_an_output_beyond_its_range_is_outside(known: TrainedOn) -> None:
    low, high = known.low, known.high
    middle, span = (low + high) / 2, high - low
    beyond = high + span * np.array([0.11, 0])
    outputs = np.array([middle, high + 0.09 * span, beyond, low - 0.11 * span])
    below = f"force below {low[0]:g}; place below {low[1]:g}"
    assert known.reasons(outputs, np.zeros(4)) == ["", "", f"force above {high[0]:g}", below]
    for distance in (1.01, np.inf, np.nan):
        assert known.reasons(outputs[:1], np.array([distance])) == [UNLIKE]


def test_the_limit_is_that_of_the_held_out_rows() -> None:
    """Of 250 held-out rows one is farther away, and of 20 rows none is."""
    held = touch(drawn(250, 2), 2)
    many = learnt_from(drawn(120, 1), held, 250)
    assert (many.distances(held, estimates(held)) > 1).sum() == 1
    assert many.one_in == 100
    few = learnt_from(drawn(40, 1), held[:20], 3)
    assert few.distances(held[:20], estimates(held[:20])).max() == pytest.approx(1)
    assert few.one_in == 4


def test_the_command(scene: Scene) -> None:
    source = new_csv(scene.path.parent, "x0,x1,x2\n0,0,0\n0.999,0.1,-5\n")
    out = scene.path.parent / "out.csv"
    out.write_text("an older one")
    command = [*CALL, "tactus.cli.predict"]
    result = run(*command, scene.path, source, out, "--force")
    assert result.returncode == 0, result.stderr
    assert "2 of 2 rows are outside the 30 rows that trained" in result.stdout
    assert "about 1 in 31 rows like the recorded ones is called outside, too" in result.stdout
    # These networks are random, so their outputs for the first row are unlike any target.
    rows = out.read_text().splitlines()
    assert "y1 below" in rows[1]
    assert UNLIKE not in rows[1]
    assert rows[2].endswith(UNLIKE)


def test_what_is_like_the_rows_that_trained_is_inside(known: TrainedOn) -> None:
    fresh = touch(drawn(1000, 7), 7)
    assert sum(map(bool, reasons(known, fresh, estimates(fresh)))) <= 30


RIGHT = random_mlp((3, 5, 2), 1.0, 2)


def changed(**outputs: np.ndarray) -> DenseNetwork:
    """The network with another output layer."""
    first, second = RIGHT.layers
    return DenseNetwork((first, replace(second, **outputs)))


# Networks that fit the formats, and their outputs that always saturate.
WRONG = {
    "weights of 100": (changed(weights=np.full((2, 5), 100.0)), ["y0", "y1"]),
    "all weights of 100": (unpacked(np.full_like(packed(RIGHT), 100.0), RIGHT), ["y0", "y1"]),
    "a bias of 50,000": (changed(biases=np.array([50_000.0, 0.1])), ["y0"]),
    "a bias of -50,000": (changed(biases=np.array([0.1, -50_000.0])), ["y1"]),
}


def saturating_scene(
    folder: Path, mlp: DenseNetwork, design: str = "hybrid", activation: str = "gradient"
) -> Scene:
    path = write_scene(folder, "rig", "exact", [RIGHT], design=design, activation=activation)
    save_network(path.with_suffix(".npz"), mlp, {})
    return load_scene(str(path))


@pytest.mark.parametrize("name", WRONG)
@pytest.mark.parametrize(("design", "activation"), [("hybrid", "gradient"), ("engine", "precise")])
def test_outputs_that_saturate_are_named(
    tmp_path: Path, name: str, design: str, activation: str
) -> None:
    mlp, names = WRONG[name]
    scene = saturating_scene(tmp_path, mlp, design, activation)
    found = everything(scene, tmp_path / "build")
    lines = [f.text for f in found if f.verdict == WARNING and "saturates" in f.text]
    results = scene.twin().core.process(scene.vectors().codes)
    for line, output in zip(lines, names, strict=True):
        column = results[:, scene.outputs.index(output)]
        count = int(((column == SIGNAL.low) | (column == SIGNAL.high)).sum())
        assert count > 0.9 * len(column)
        text = "all" if count == len(column) else f"{count} of"
        assert line.startswith(f"output {output!r} saturates in {text} 12 recorded frames: ")


def test_an_export_warns_of_them(tmp_path: Path) -> None:
    scene = saturating_scene(tmp_path, WRONG["a bias of 50,000"][0])
    with pytest.warns(UserWarning, match=r"rig\.toml: output 'y0' saturates in all 12 recorded"):
        export_scene(scene, "verilog", tmp_path / "verilog")
