"""Tests the decisions of a scene with classes from its serial line to what a user sees."""

import csv
import re
from pathlib import Path

import pytest
from test_classes import write_hand

from golden.input_error import InputError
from golden.trained.dense import Dense, layers_of, network_of
from tactus.cli.predict import main as predict
from tactus.monitor.board import board_of
from tactus.monitor.csv_file import GrowingCsv
from tactus.monitor.line import Line
from tactus.monitor.monitor import Monitor, csv_columns
from tactus.monitor.placements import nearest_row
from tactus.monitor.record import main as record
from tactus.monitor.record import read_label, typed
from tactus.monitor.twin_board import TwinBoard
from tactus.network_files.network_file import write_network
from tb.common.cases import FRONT_END, random_network

ROWS = 30
LABELS = ("fist", "flat", "long wave")
INSTRUMENT = f"""
{FRONT_END}converter = "mcp3208"
[uart]
"""


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A scene whose network, which nobody has trained, decides for each label now and then."""
    monkeypatch.chdir(tmp_path)
    path = write_hand(tmp_path, ROWS, LABELS, INSTRUMENT)
    hidden, output = layers_of(random_network((2, 4, 3), ("relu", "linear"), 1.0, 1))
    found = network_of((hidden, Dense(output.weights, 0 * output.biases, "linear")))
    write_network(path.with_suffix(".npz"), found)
    hardware = 'precision = "exact"\nclock_mhz = 25.0\nargmax = true'
    path.write_text(path.read_text().replace('precision = "exact"', hardware))
    return path


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def call(monkeypatch: pytest.MonkeyPatch, job, *words: object) -> None:
    monkeypatch.setattr("sys.argv", ["", *map(str, words)])
    assert not job()


@pytest.mark.parametrize("argmax", ["true", "false"])
def test_a_recording_has_the_words_of_a_prediction(path: Path, monkeypatch, argmax: str) -> None:
    """Hardware that sends no winner sends the outputs from which it follows."""
    path.write_text(path.read_text().replace("argmax = true", f"argmax = {argmax}"))
    board = board_of(str(path))
    assert board.layout.decides == (argmax == "true")
    with (
        TwinBoard(board.scene) as simulated,
        Line(simulated.port, board.baud) as line,
        GrowingCsv(Path("all.csv"), csv_columns(board)) as file,
    ):
        monitor = Monitor(board, print, file)
        monitor.listen(line, lambda: monitor.decoder.tally.frames >= ROWS)
    call(monkeypatch, predict, path, "hand.csv", "out.csv")
    seen, known = rows_of(Path("all.csv"))[:ROWS], rows_of(Path("out.csv"))
    assert len({row["gesture_predicted"] for row in known}) > 1
    for column in ("gesture_predicted", "margin"):
        assert [row[column] for row in seen] == [row[column] for row in known]


def test_labels_are_recorded(path: Path, monkeypatch, capfd) -> None:
    Path("labels.csv").write_text("gesture\nlong wave\nfist\n")
    call(monkeypatch, record, path, "twin", "new.csv", "--labels=labels.csv", "--frames=2")
    assert [row["gesture"] for row in rows_of(Path("new.csv"))] == ["long wave", "fist"]
    scene = board_of(str(path)).scene
    assert nearest_row(scene, {"gesture": "flat"}) == 1
    with pytest.raises(InputError, match=re.escape("got no row of 'nix', expected one of fist, f")):
        nearest_row(scene, {"gesture": "nix"})


def test_what_is_typed_is_a_label() -> None:
    lines, said = iter(["flat", "a,b", "long wave", ""]), []
    found = list(typed(["gesture"], lambda _: next(lines), said.append, read_label))
    assert found == [("flat",), ("long wave",)]
    assert said[1] == "got 'a,b', expected one gesture, without a comma"
