"""Tests recording placements from a board, loading an image into it, and what it then sends."""

import csv
import io
import re
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from refused import Desk, call
from test_classes import write_hand
from test_monitor import BAUD, Cable

from golden.input_error import InputError
from golden.link.decoder import Decoder
from golden.networks.engine import Engine
from golden.trained.dense import Dense, network_of
from tactus.monitor import load as loading
from tactus.monitor import record as recording
from tactus.monitor.board import Board, board_of
from tactus.monitor.csv_file import GrowingCsv
from tactus.monitor.line import SerialLine, open_line
from tactus.monitor.monitor import Monitor, csv_columns
from tactus.monitor.record import typed
from tactus.monitor.twin_board import TwinBoard, nearest_row
from tactus.network_files.network_file import write_network
from tactus.scene import Scene, load_scene
from tactus.scene.image import scene_image
from tactus.scene.scale import Scale
from tb.common.cases import FRONT_END, random_network


@pytest.fixture(scope="module")
def hardware() -> Scene:
    return load_scene("digit-board")


@pytest.mark.parametrize("name", ["digit-board", "digit-single", "digit-load"])
def test_a_scene_that_is_loaded_runs(name: str, hardware: Scene) -> None:
    """Nothing is computed before."""
    scene, line = load_scene(name), TwinBoard(hardware)
    board = Board(scene, hardware)
    decoder = Decoder(board.layout)
    (frame,) = decoder.feed(line.read())
    assert (frame.flags, frame.count, set(frame.outputs)) == (("frame_error",), 0, {0})
    assert loading.load(line, board) > 1000
    core = Engine.of(scene.mlps(), arrangement=scene.arrangement)
    for _ in range(50):
        (frame,) = decoder.feed(line.read())
        expected = core.process(np.array([frame.samples]))[0].tolist()
        assert list(frame.outputs[: len(expected)]) == expected
        assert frame.flags == ()
        assert frame.point is not None


def test_a_board_that_refuses_an_image_is_told(hardware: Scene) -> None:
    larger = {**hardware.design_options, "program_words": 1024}
    with pytest.raises(InputError, match="PORT=twin: image_error: the board refused the image"):
        loading.load(TwinBoard(hardware), Board(hardware, replace(hardware, design_options=larger)))


def test_a_line_that_is_cut_is_told(hardware: Scene, tmp_path: Path) -> None:
    board = Board(hardware, hardware)
    with Cable(TwinBoard(hardware, 1000.0, 500), tmp_path) as cable:
        for ask in (loading.load, lambda line, board: recording.gather(line, board, 4)):
            with SerialLine(cable.port, BAUD) as line:
                cable.cut()
                with pytest.raises(InputError, match=f"PORT={cable.port}: the line was cut: the d"):
                    ask(line, board)
            cable.mend()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"read": lambda: b""}, "no packet for 0.01 s: is the bitstream loaded, and are TX and RX"),
        ({"read": lambda: b"x" * 99}, "no packet for 0.01 s: .*bytes are part of"),
        (
            {"write": lambda data: None},
            "the image was sent, but no new frame .* carry frame_error: is RX connected",
        ),
    ],
)
def test_a_board_that_is_not_heard_or_hears_nothing_is_told(
    hardware: Scene, monkeypatch, change: dict, said: str
) -> None:
    line = TwinBoard(hardware)
    for name, value in (change | {"patience": 0.01}).items():
        monkeypatch.setattr(line, name, value)
    with pytest.raises(InputError, match=f"PORT=twin: {said}"):
        loading.load(line, Board(hardware, hardware))


def test_a_board_of_twins_may_send_less_than_a_packet_a_second(hardware: Scene) -> None:
    slow = replace(hardware, uart=replace(hardware.uart, baud=300, divisor=83333))
    line = open_line("twin", None, Board(slow, slow))
    assert line.rate < 1
    assert len(line.read()) == line.layout.packet_bytes
    assert line.read() == b""


def test_a_converter_that_is_missing_is_told_at_once(hardware: Scene, monkeypatch) -> None:
    line = TwinBoard(hardware)
    packets = iter([line.layout.to_bytes(replace(line._frame(), flags=("converter_error",)))])
    monkeypatch.setattr(line, "read", lambda: next(packets))
    with pytest.raises(InputError, match="PORT=twin: converter_error: the converter is missing"):
        recording.gather(line, Board(hardware, hardware), 100_000)


def test_a_scene_of_other_sensors_is_not_loaded(hardware: Scene) -> None:
    other = replace(hardware, sensors=("sensor2", "sensor1", "sensor3", "sensor4"))
    with pytest.raises(InputError, match=r"data.sensors: got sensor2, sensor1.*expected sensor1,"):
        loading.check_readings(Board(other, hardware))
    # A scene without a converter may have any scale.
    other = replace(load_scene("digit"), scale={"sensor2": Scale(1.0, 2.0)})
    with pytest.raises(InputError, match=r"data.scale.sensor2: got offset 1, factor 2, expected o"):
        loading.check_readings(Board(other, hardware))


@pytest.fixture
def cable(hardware: Scene, tmp_path: Path) -> Iterator[Cable]:
    with Cable(TwinBoard(hardware, 1000.0, 500), tmp_path) as found:
        yield found


def test_placements_of_a_list_become_a_recording(
    hardware: Scene, cable: Cable, tmp_path: Path, monkeypatch, capfd
) -> None:
    """Each row is the mean of the readings at a placement, and the labels are copied."""
    labels, to = tmp_path / "labels.csv", tmp_path / "mine.csv"
    labels.write_text("position,load\n0.225,0.9\n0.450,0.90\n")
    words = ("record", "digit-board", cable.port, to, f"--labels={labels}", "--frames=4")
    asked = []

    def touch(text: str) -> str:
        """Answer a request: touch the board at the placement, and press Enter."""
        asked.append(text)
        told = re.findall(r"(position|load) ([\d.]+)", text)
        cable.board.place({name: float(value) for name, value in told})
        return ""

    monkeypatch.setattr("builtins.input", touch)
    assert not call(*words)
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
    with pytest.raises(InputError, match="is there already"):
        call(*words)


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
    cable: Cable, desk: Desk, monkeypatch, labels: str, typed: str, said: str, rows: int
) -> None:
    """The recorded rows are kept."""
    (desk.folder / "labels.csv").write_text("load,position\n0.9,0.225\n0.45,0.45\n")
    monkeypatch.setattr(sys, "stdin", io.StringIO(typed))
    words = ["digit-board", cable.port, "rows.csv", "--frames=1", f"--labels={labels}"]
    code, told = desk.call("record", *words)
    assert code == (2 if said else 0), told
    assert told.startswith(f"error: {said}" if said else "")
    assert told.count("\n") == bool(said)
    file = desk.folder / "rows.csv"
    assert (len(file.read_text().splitlines()) - 1 if rows else file.exists()) == rows


def test_means_and_noise_are_those_of_the_readings(hardware: Scene, tmp_path: Path) -> None:
    """The board plays its recording, four rows for each placement."""
    board = Board(hardware, hardware)
    with GrowingCsv(tmp_path / "a.csv", [*hardware.sensors, "load"]) as file:
        spread = recording.record(TwinBoard(hardware), board, iter([("1",)]), file, 143)
    codes = hardware.vectors().codes / 8192
    assert spread == pytest.approx(codes.std(axis=0))
    cells = (tmp_path / "a.csv").read_text().splitlines()[1].split(",")
    assert [float(c) for c in cells[:4]] == pytest.approx(codes.mean(axis=0), abs=1e-5)


HARDWARE = "digit-board"


def test_from_placements_to_a_network_on_the_board(tmp_path: Path, monkeypatch, capfd) -> None:
    """The loop runs on a board of twins, and only uses the port, files and commands."""
    hardware = load_scene(HARDWARE)
    core, recorded = hardware.twin().core, hardware.vectors()
    # Every fourth row of the recording is touched.
    listed = tmp_path / "placements.csv"
    rows = [f"{load:g},{position:g}" for load, position, *_ in recorded.targets[::4]]
    listed.write_text("\n".join(["load,position", *rows, ""]))
    names, placements = recording.labels_of(listed, hardware, simulated=True)
    readings, rig = tmp_path / "readings.csv", tmp_path / "mine.toml"
    line = TwinBoard(hardware)
    with GrowingCsv(readings, [*hardware.sensors, *names]) as file:
        source = recording.touched(names, placements, line)
        recording.record(line, Board(hardware, hardware), source, file, 2)
    assert file.rows == len(rows)
    # The load in grams, which is outside of the codes.
    head, *lines = readings.read_text().splitlines()
    cells = [line.split(",") for line in lines]
    grams = [",".join([*row[:4], f"{1000 * float(row[4]):g}", row[5]]) for row in cells]
    readings.write_text("\n".join([head.replace("load", "grams"), *grams, ""]))

    assert not call("scene", readings, "grams,position", "--to", rig, "--hardware", HARDWARE)
    text = rig.read_text()
    assert 'scale = { grams = "auto" }' in text
    text = re.sub(r"hidden = \[.*", "hidden = [4, 4]", text)
    rig.write_text(text.replace("restarts = 8", "restarts = 1"))

    assert not call("train", rig, "--build", tmp_path / "build", "--workers", 1)
    mine = Board(load_scene(str(rig)), hardware)
    assert loading.load(line, mine) == len(scene_image(mine.scene, core).to_bytes())

    line.place({"load": 0.9, "position": 0.45})
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


def test_a_recording_without_a_sensor_is_refused(tmp_path: Path) -> None:
    """A sensor that never moved is left out, and the board would read another in its place."""
    rows = ["sensor1,sensor2,sensor3,sensor4,load"]
    rows += [f"{n**0.5 / 6},{n * n / 1000},0.5,{(n % 7) / 9},{n}" for n in range(30)]
    (tmp_path / "a.csv").write_text("\n".join(rows) + "\n")
    said = "got the sensors sensor1, sensor2, sensor4, expected sensor1, sensor2, sensor3.*; "
    with pytest.raises(InputError, match=f"{said}sensor3 is left out: 0.5 in every row"):
        call("scene", tmp_path / "a.csv", "load", f"--hardware={HARDWARE}")
    assert not (tmp_path / "a.toml").exists()


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
    hidden, output = random_network((2, 4, 3), ("relu", "linear"), 1.0, 1).layers
    found = network_of((hidden, Dense(output.weights, 0 * output.biases, "linear")))
    write_network(path.with_suffix(".npz"), found)
    hardware = 'precision = "exact"\nclock_mhz = 25.0\nargmax = true'
    path.write_text(path.read_text().replace('precision = "exact"', hardware))
    return path


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("argmax", ["true", "false"])
def test_a_recording_has_the_words_of_a_prediction(path: Path, argmax: str) -> None:
    """Hardware that sends no winner sends the outputs from which it follows."""
    path.write_text(path.read_text().replace("argmax = true", f"argmax = {argmax}"))
    board = board_of(str(path))
    assert board.layout.decides == (argmax == "true")
    with GrowingCsv(Path("all.csv"), csv_columns(board)) as file:
        monitor = Monitor(board, print, file)
        monitor.listen(TwinBoard(board.scene), lambda: monitor.decoder.tally["frames"] >= ROWS)
    call("predict", path, "hand.csv", "out.csv")
    seen, known = rows_of(Path("all.csv")), rows_of(Path("out.csv"))
    assert len({row["gesture_predicted"] for row in known}) > 1
    assert len(seen) == ROWS
    for row in seen:
        predicted = known[int(row["computed"]) % ROWS]
        for column in ("gesture_predicted", "margin"):
            assert row[column] == predicted[column]


def test_labels_are_recorded(path: Path, capfd) -> None:
    Path("labels.csv").write_text("gesture\nlong wave\nfist\n")
    call("record", path, "twin", "new.csv", "--labels=labels.csv", "--frames=2")
    assert [row["gesture"] for row in rows_of(Path("new.csv"))] == ["long wave", "fist"]
    scene = board_of(str(path)).scene
    assert nearest_row(scene, {"gesture": "flat"}) == 1
    with pytest.raises(InputError, match=re.escape("got no row of 'nix', expected one of fist, f")):
        nearest_row(scene, {"gesture": "nix"})


@pytest.mark.parametrize(
    ("names", "lines", "found", "refused"),
    [
        (["gesture"], ["flat", "long wave"], [("flat",), ("long wave",)], ()),
        (["gesture"], ["a,b"], [], ["got 'a,b', expected one gesture, without a comma"]),
        (["u", "v"], ["1 2", "3, -4e1"], [("1", "2"), ("3", "-4e1")], ()),
        (["u", "v"], ["1"], [], ["got 1 values, expected 2: u, v"]),
        (
            ["u"],
            ["nan", "x"],
            [],
            ["u: got 'nan', expected a number", "u: got 'x', expected a number"],
        ),
    ],
)
def test_what_is_typed_is_a_placement(monkeypatch, capsys, names, lines, found, refused) -> None:
    typing = iter([*lines, ""])
    monkeypatch.setattr("builtins.input", lambda _: next(typing))
    assert list(typed(names, names == ["gesture"])) == found
    _, *said = capsys.readouterr().out.splitlines()
    assert said == list(refused)
