"""Tests recording known placements from a board, and loading an image into it."""

from __future__ import annotations

import csv
import io
import re
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from refused import Desk

from golden.input_error import InputError
from golden.link.decoder import Decoder
from golden.networks.engine import Engine
from tactus.core.cli import run
from tactus.monitor import load as loading
from tactus.monitor import record as recording
from tactus.monitor.board import Board
from tactus.monitor.csv_file import GrowingCsv
from tactus.monitor.line import Line
from tactus.monitor.ports import open_line
from tactus.monitor.twin_board import TwinBoard
from tactus.scene import Scene, load_scene
from tactus.scene.scale import Scale

ROOT = Path(__file__).parents[1]
BAUD = 1_000_000


@pytest.fixture(scope="module")
def hardware() -> Scene:
    return load_scene("digit-board")


@pytest.fixture
def simulated(hardware: Scene) -> Iterator[TwinBoard]:
    with TwinBoard(hardware, 1000.0) as board:
        yield board


@pytest.mark.parametrize("name", ["digit-board", "digit-single", "digit-load"])
def test_a_scene_that_is_loaded_runs(name: str, hardware: Scene, simulated: TwinBoard) -> None:
    scene = load_scene(name)
    board = Board(scene, hardware)
    with Line(simulated.port, BAUD) as line:
        count = loading.load(line, board)
        assert count > 1000
        line.drop()
        decoder = Decoder(board.layout)
        frames = []
        while len(frames) < 50:
            frames += decoder.feed(line.read())
    core = Engine.of(scene.mlps(), arrangement=scene.arrangement)
    for frame in frames:
        expected = core.process(np.array([frame.samples]))[0].tolist()
        assert list(frame.outputs[: len(expected)]) == expected
        assert frame.flags == ()
        assert frame.point is not None


def test_nothing_is_computed_before_an_image(simulated: TwinBoard) -> None:
    with Line(simulated.port, BAUD) as line:
        decoder, frames = Decoder(simulated.layout), []
        while len(frames) < 5:
            frames += decoder.feed(line.read())
    assert {frame.flags for frame in frames} == {("frame_error",)}
    assert {frame.count for frame in frames} == {0}


def other_sizes(hardware: Scene) -> Scene:
    """The same scene, for hardware with a larger memory."""
    return replace(hardware, design_options=hardware.design_options | {"program_words": 1024})


def test_a_board_that_refuses_an_image_is_told(hardware: Scene, simulated: TwinBoard) -> None:
    with (
        Line(simulated.port, BAUD, "there") as line,
        pytest.raises(InputError, match="PORT=there: image_error: the board refused the image"),
    ):
        loading.load(line, Board(hardware, other_sizes(hardware)))


def test_a_line_that_is_cut_is_told(hardware: Scene, simulated: TwinBoard) -> None:
    with Line(simulated.port, BAUD, "there") as line:
        simulated.cut()
        for ask in (
            lambda: loading.load(line, Board(hardware, hardware)),
            lambda: recording.gather(line, Board(hardware, hardware), 4),
        ):
            with pytest.raises(InputError, match="PORT=there: the line was cut: the device is"):
                ask()


def test_a_scene_of_other_sensors_is_not_loaded(hardware: Scene) -> None:
    other = replace(hardware, sensors=("sensor2", "sensor1", "sensor3", "sensor4"))
    with pytest.raises(InputError, match=r"data.sensors: got sensor2, sensor1.*expected sensor1,"):
        loading.check_readings(Board(other, hardware))
    # A scene without a converter may have any scale.
    other = replace(load_scene("digit"), scale={"sensor2": Scale(1.0, 2.0)})
    with pytest.raises(InputError, match=r"data.scale.sensor2: got offset 1, factor 2, expected o"):
        loading.check_readings(Board(other, hardware))


def test_placements_of_a_list_become_a_recording(
    hardware: Scene, simulated: TwinBoard, tmp_path: Path, monkeypatch, capfd
) -> None:
    """Each row is the mean of the readings at a placement, and the labels are copied."""
    labels, to = tmp_path / "labels.csv", tmp_path / "mine.csv"
    labels.write_text("position,load\n0.225,0.9\n0.450,0.90\n")
    words = ["record", "digit-board", simulated.port, str(to), f"--labels={labels}", "--frames=4"]
    monkeypatch.setattr("sys.argv", words)
    asked = []

    def touch(text: str) -> str:
        """Answer a request: touch the board at the placement, and press Enter."""
        asked.append(text)
        told = re.findall(r"(position|load) ([\d.]+)", text)
        simulated.place({name: float(value) for name, value in told})
        return ""

    monkeypatch.setattr("builtins.input", touch)
    assert run(recording.main) == 0, capfd.readouterr().err
    assert f"wrote {to}, 2 placements" in capfd.readouterr().out
    assert asked[1] == "2 of 2: position 0.450, load 0.90; Enter when it is there "
    with to.open(newline="") as handle:
        rows = list(csv.reader(handle))
    assert rows[0] == [*hardware.sensors, "position", "load"]
    assert [row[4:] for row in rows[1:]] == [["0.225", "0.9"], ["0.450", "0.90"]]
    recorded = hardware.vectors()
    for row in rows[1:]:
        readings = np.array([float(cell) for cell in row[:4]])
        assert np.abs(recorded.codes / 8192 - readings).max(axis=1).min() <= 0.5e-5
    assert run(recording.main) == 2
    assert "is there already" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("labels", "typed", "said", "rows"),
    [
        ("", "", "TO=rows.csv: not written: the input ended before the first placement", 0),
        ("", "\n", "TO=rows.csv: not written: the input ended before the first placement", 0),
        ("", "0.9 0.2 0.4 0.4\n", "", 1),
        ("labels.csv", "", "TO=rows.csv: not written: the input ended before the first placem", 0),
        ("labels.csv", "\n", "TO=rows.csv: got 1 placements, expected 2, those of LABELS=: the", 1),
        ("labels.csv", "\n\n", "", 2),
    ],
)
def test_an_input_that_ends_early_is_no_success(
    simulated: TwinBoard, desk: Desk, monkeypatch, labels: str, typed: str, said: str, rows: int
) -> None:
    """The recorded rows are kept."""
    (desk.folder / "labels.csv").write_text("load,position\n0.9,0.225\n0.45,0.45\n")
    monkeypatch.setattr(sys, "stdin", io.StringIO(typed))
    words = ["digit-board", simulated.port, "rows.csv", "--frames=1", f"--labels={labels}"]
    code, told = desk.call("record", *words)
    assert code == (2 if said else 0), told
    assert told.startswith(f"error: {said}" if said else "")
    assert told.count("\n") == bool(said)
    file = desk.folder / "rows.csv"
    assert (len(file.read_text().splitlines()) - 1 if rows else file.exists()) == rows


def test_means_and_noise_are_those_of_the_readings(hardware: Scene, tmp_path: Path) -> None:
    """The board plays its recording, four rows for each placement."""
    board, said = Board(hardware, hardware), []
    with (
        TwinBoard(hardware, 1000.0) as simulated,
        Line(simulated.port, BAUD) as line,
        GrowingCsv(tmp_path / "a.csv", [*hardware.sensors, "load"]) as file,
    ):
        spread = recording.record(line, board, iter([("1",)]), file, 143, said.append)
    codes = hardware.vectors().codes / 8192
    assert spread == pytest.approx(codes.std(axis=0))
    cells = (tmp_path / "a.csv").read_text().splitlines()[1].split(",")
    assert [float(c) for c in cells[:4]] == pytest.approx(codes.mean(axis=0), abs=1e-5)


def test_the_simulated_hardware_sends_what_its_converter_reads(hardware: Scene) -> None:
    """The first two packets come before any image.

    ALL=1 tests more (tests/test_monitor_loop.py).
    """
    board = Board(hardware, hardware)
    with open_line("sim", None, board) as line:
        values = recording.gather(line, board, 1)
    reader = board.instrument.converter_reader
    expected = reader.process(reader.converted(hardware.vectors().codes[:1]))
    assert np.array_equal(values * 8192, expected)
