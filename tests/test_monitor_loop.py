"""Tests the steps of docs/monitor.md: record on a board, train, load, and run the network."""

import re
from pathlib import Path

import numpy as np
import pytest

from golden.networks.engine import Engine
from tactus.cli import scene as write_scene
from tactus.cli import train as training
from tactus.core.cli import run
from tactus.monitor import load as loading
from tactus.monitor import record as recording
from tactus.monitor.board import Board
from tactus.monitor.csv_file import GrowingCsv
from tactus.monitor.line import Line
from tactus.monitor.monitor import Monitor
from tactus.monitor.twin_board import TwinBoard
from tactus.scene import load_scene
from tactus.scene.image import scene_image

HARDWARE = "digit-board"


def test_from_placements_to_a_network_on_the_board(tmp_path: Path, monkeypatch, capfd) -> None:
    """The loop runs on a board of twins, and only uses the port, files and commands."""
    hardware = load_scene(HARDWARE)
    core, recorded = hardware.twin().core, hardware.vectors()
    assert isinstance(core, Engine)
    # Every fourth row of the recording is touched.
    listed = tmp_path / "placements.csv"
    rows = [f"{load:g},{position:g}" for load, position, *_ in recorded.targets[::4]]
    listed.write_text("\n".join(["load,position", *rows, ""]))
    names, placements = recording.labels_of(listed)
    readings, rig = tmp_path / "readings.csv", tmp_path / "mine.toml"
    with TwinBoard(hardware) as simulated, Line(simulated.port, 1_000_000) as line:
        ask = recording.simulated_ask(simulated, placements, names)
        with GrowingCsv(readings, [*hardware.sensors, *names]) as file:
            source = recording.listed(names, placements, ask)
            recording.record(line, Board(hardware, hardware), source, file, 2, print)
        assert file.rows == len(rows)
        # The load in grams, which is outside of the codes.
        head, *lines = readings.read_text().splitlines()
        cells = [line.split(",") for line in lines]
        grams = [",".join([*row[:4], f"{1000 * float(row[4]):g}", row[5]]) for row in cells]
        readings.write_text("\n".join([head.replace("load", "grams"), *grams, ""]))

        words = ["scene", str(readings), "grams,position", f"--to={rig}", f"--hardware={HARDWARE}"]
        monkeypatch.setattr("sys.argv", words)
        assert run(write_scene.main) == 0, capfd.readouterr().err
        text = rig.read_text()
        assert 'scale = { grams = "auto" }' in text
        text = re.sub(r"hidden = \[.*", "hidden = [4, 4]", text)
        rig.write_text(text.replace("restarts = 8", "restarts = 1"))

        words = ["train", str(rig), "--build", str(tmp_path / "build"), "--workers", "1"]
        monkeypatch.setattr("sys.argv", words)
        assert run(training.main) == 0, capfd.readouterr().err
        mine = Board(load_scene(str(rig)), hardware)
        assert loading.load(line, mine) == len(scene_image(mine.scene, core).to_bytes())

        simulated.place({"load": 0.9, "position": 0.45})
        line.drop()
        monitor = Monitor(mine, print)
        ends = iter([False] * 20 + [True])
        monitor.listen(line, lambda: next(ends))
        state = monitor.state()
    engine = Engine.of(mine.scene.mlps(), arrangement=mine.scene.arrangement)
    row = np.abs(recorded.targets[:, :2] - [0.9, 0.45]).sum(axis=1).argmin()
    expected = mine.scene.outputs_in_units(engine.process(recorded.codes[row : row + 1]))
    shown = [float(output["text"]) for output in state["outputs"]]
    assert [output["name"] for output in state["outputs"]] == ["grams", "position"]
    assert shown == pytest.approx(expected[0], abs=0.06)
    assert abs(shown[0] - 900) < 100


def test_a_recording_without_a_sensor_is_refused(tmp_path: Path, monkeypatch, capfd) -> None:
    """A sensor that never moved is left out, and the board would read another in its place."""
    rows = ["sensor1,sensor2,sensor3,sensor4,load"]
    rows += [f"{n**0.5 / 6},{n * n / 1000},0.5,{(n % 7) / 9},{n}" for n in range(30)]
    (tmp_path / "a.csv").write_text("\n".join(rows) + "\n")
    words = ["scene", str(tmp_path / "a.csv"), "load", f"--hardware={HARDWARE}"]
    monkeypatch.setattr("sys.argv", words)
    assert run(write_scene.main) == 2
    said = capfd.readouterr().err
    assert "got the sensors sensor1, sensor2, sensor4, expected sensor1, sensor2, sensor3" in said
    assert "; sensor3 is left out: 0.5 in every row" in said
    assert not (tmp_path / "a.toml").exists()
