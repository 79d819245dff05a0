"""Tests what the monitor shows, reports and records, from a pseudo-terminal to the browser."""

from __future__ import annotations

import csv
import json
import os
import re
import threading
import time
import tty
import urllib.error
import urllib.request
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from queue import SimpleQueue
from typing import Any

import numpy as np
import pytest
from refused import call
from shared import browse

from golden.input_error import InputError
from golden.link.packets import FRAME, SYNC, Frame, FrameLayout, check_of
from golden.numbers.precision import SIGNAL
from tactus.monitor.board import Board
from tactus.monitor.csv_file import GrowingCsv
from tactus.monitor.line import Line, SerialLine
from tactus.monitor.monitor import HEAD, PAUSE, Monitor, csv_columns
from tactus.monitor.server import Server, page_of
from tactus.monitor.twin_board import TwinBoard
from tactus.scene import Scene, load_scene

BAUD = 1_000_000
LONGEST = 30.0


@pytest.fixture(scope="module")
def scene() -> Scene:
    """A scene with a cascade and a profile, and with its program in the hardware."""
    return replace(load_scene("digit-board"), design_options={})


def listen(monitor: Monitor, line: Line, until: Callable[[], bool]) -> None:
    """Listen until a condition holds. Only a fault ends it without, and not a slow machine."""
    line.silence, ends = LONGEST, time.monotonic() + LONGEST

    def over() -> bool:
        assert time.monotonic() < ends
        return until()

    monitor.listen(line, over)


class Cable:
    """A serial port at which a board of twins sits; the cable can be cut, and carry noise."""

    def __init__(self, board: TwinBoard, folder: Path) -> None:
        self.board, self.port = board, str(folder / "port")
        self.noise: SimpleQueue[bytes] = SimpleQueue()
        self._ends: list[int] = []
        self._lock, self._done = threading.Lock(), threading.Event()
        self._thread = threading.Thread(target=self._carry)

    def __enter__(self) -> Cable:
        self.mend()
        self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._done.set()
        self._thread.join()
        self.cut()

    def mend(self) -> None:
        with self._lock:
            self._ends += os.openpty()
            tty.setraw(self._ends[0])
            os.set_blocking(self._ends[0], False)
            Path(self.port).symlink_to(os.ttyname(self._ends[1]))

    def cut(self) -> None:
        with self._lock:
            for end in self._ends:
                os.close(end)
            self._ends.clear()
            Path(self.port).unlink(missing_ok=True)

    def _carry(self) -> None:
        waiting = b""
        while not self._done.is_set():
            if not waiting:
                waiting = self.board.read()
                if not self.noise.empty():
                    waiting += self.noise.get()
            # While nobody reads, bytes wait.
            with self._lock, suppress(BlockingIOError):
                waiting = waiting[os.write(self._ends[0], waiting) :] if self._ends else b""
            if waiting:
                time.sleep(0.001)


def test_what_a_board_sends_is_shown_and_recorded(scene: Scene, tmp_path: Path) -> None:
    board, path, said = Board(scene, scene), tmp_path / "all.csv", []
    with GrowingCsv(path, [*HEAD, *board.columns]) as file:
        monitor = Monitor(board, said.append, file)
        listen(monitor, TwinBoard(scene), lambda: monitor.decoder.tally["frames"] >= 300)
        state = monitor.state()
    tally = monitor.decoder.tally
    assert (tally["missed"], tally["failed"], tally["skipped"], said) == (0, 0, 0, [])
    with path.open(newline="") as handle:
        rows = list(csv.DictReader(handle))
    assert len(rows) == file.rows == tally["frames"]
    codes = scene.vectors().codes
    outputs = scene.twin().core.process(codes)
    first = int(rows[0]["computed"])
    for number, row in enumerate(rows):
        at = (first + number) % len(codes)
        samples = [float(row[name]) for name in scene.sensors]
        assert np.array_equal(np.round(np.array(samples) * 8192), codes[at])
        results = np.array([float(row[name]) for name in scene.outputs])
        assert np.array_equal(np.round(results * 8192), outputs[at])
    newest = rows[-1]
    for shown in (*state["sensors"], *state["outputs"]):
        assert shown["text"] == newest[shown["name"]]
    position = next(o for o in state["outputs"] if o["name"] == "position")
    assert float(position["mm"]) == pytest.approx(float(position["text"]) / 0.9 * 127, abs=0.06)
    assert [x for x, _ in state["profile"]] == list(
        SIGNAL.to_real(scene.visualisation.load_profile.ramp.process())
    )
    assert state["line"] == "packets"


def test_a_cut_cable_and_noise_are_told_and_it_goes_on(scene: Scene, tmp_path: Path) -> None:
    said: list[str] = []
    with Cable(TwinBoard(scene, 500.0), tmp_path) as cable, SerialLine(cable.port, BAUD) as line:
        monitor = Monitor(Board(scene, scene), said.append)
        tally = monitor.decoder.tally
        listen(monitor, line, lambda: tally["frames"] > 20)
        cable.noise.put(b"noise" * 9)
        listen(monitor, line, lambda: any("are part of no packet" in text for text in said))
        cable.cut()
        listen(monitor, line, lambda: monitor.state()["line"] == "cut")
        before = tally["frames"]
        cable.mend()
        listen(monitor, line, lambda: tally["frames"] > before + 20)
        # On a busy machine the line may pause for a moment.
        listen(monitor, line, lambda: monitor.state()["line"] == "packets")
    assert tally["missed"] == 0
    assert tally["skipped"] >= 45
    texts = [text.partition(" ")[2] for text in said]
    assert texts == [
        "45 bytes are part of no packet: garbage on the line, or another baud rate",
        f"the line was cut: the device is gone; waiting for {cable.port}",
        f"{cable.port} is back",
    ]


class Wire:
    """A line that delivers the bytes that a test gives it."""

    label, cut, silence = "wire", "", 2.0

    def __init__(self) -> None:
        self.data = b""

    def read(self) -> bytes:
        data, self.data = self.data, b""
        return data


class Still:
    """A monitor on such a line, with a clock that stands still."""

    def __init__(self, scene: Scene) -> None:
        self.now, self.said, self.wire = 100.0, [], Wire()
        self.board = Board(scene, scene)
        self.monitor = Monitor(self.board, self.said.append, clock=lambda: self.now)

    def bring(self, data: bytes) -> list[str]:
        """Deliver bytes, and return the reported lines."""
        self.wire.data, before = data, len(self.said)
        ends = iter((False, True))
        self.monitor.listen(self.wire, lambda: next(ends))
        return [text.partition(" ")[2] for text in self.said[before:]]

    def packet(
        self,
        number: int,
        *flags: str,
        count: int = 0,
        point: int = 0,
        winner: tuple[int, int] = (0, 0),
        theta: tuple[int, int] = (0, 0),
    ) -> bytes:
        layout = self.board.layout
        zeros = (0,) * layout.inputs, (0,) * layout.outputs
        shown = (point, 0, 0), winner, theta
        return layout.to_bytes(Frame(number, flags, count, *zeros, *shown))


def test_a_fault_is_told_once_and_again_after_a_while(scene: Scene) -> None:
    still = Still(scene)
    other = bytes([0x20 | FRAME, 3, 0, 0, 0, 0])
    other = bytes([SYNC]) + other + check_of(other).to_bytes(2, "big")
    (line,) = still.bring(other * 2)
    assert line.startswith("packets are of version 2 of the protocol, expected 1")
    assert still.bring(other * 50) == []
    (line,) = still.bring(still.packet(0) + still.packet(3))
    assert line == "2 packets are missing: the numbers jump"
    assert still.bring(still.packet(6)) == []
    still.now += PAUSE
    assert set(still.bring(other + still.packet(9))) == {
        "4 packets are missing: the numbers jump",
        "packets are of version 2 of the protocol, expected 1: the board and tactus are of "
        "different versions",
    }
    state = still.monitor.state()
    assert state["missed"] == 6
    assert state["messages"] == still.said[::-1]


def test_flags_silence_and_a_point_too_many_are_told(scene: Scene) -> None:
    still = Still(scene)
    assert still.bring(still.packet(0, "converter_error")) == [
        "the converter is missing or stuck: no frame is made of what it sends"
    ]
    flag = still.monitor.state()["flags"][0]
    assert flag == {"name": "converter_error", "lit": True, "count": 1}
    (line,) = still.bring(still.packet(1, point=99))
    assert line.startswith("the profile has a point 99, expected 0 to 16: the board runs")
    still.now += 5
    assert still.bring(b"") == ["no packet for 2 s"]
    assert still.bring(b"") == []
    assert still.monitor.state()["line"] == "silent"
    assert not still.monitor.state()["flags"][0]["lit"]
    assert still.bring(still.packet(2, count=1)) == ["packets come again"]
    assert still.monitor.state()["line"] == "packets"


def test_the_largest_output_is_told_by_name(scene: Scene, tmp_path: Path) -> None:
    """A scene without classes names its output."""
    still = Still(replace(scene, argmax=True))
    assert csv_columns(still.board)[-2:] == ["largest", "margin"]
    assert still.monitor.state()["decision"] == [
        {"name": "largest", "text": ""},
        {"name": "margin", "text": ""},
    ]
    still.bring(still.packet(0, count=1, winner=(2, 16383)))
    assert [d["text"] for d in still.monitor.state()["decision"]] == ["width", "16383"]
    assert ", largest width, margin 16383, load 0" in still.monitor.line()
    (line,) = still.bring(still.packet(1, count=2, winner=(4, 1)))
    assert line.startswith("the largest output is number 4, expected 0 to 3: the board runs")
    assert [d["text"] for d in still.monitor.state()["decision"]] == ["", "1"]
    assert Still(scene).monitor.state()["decision"] == []


def test_a_recording_replaces_nothing_and_holds_whole_rows(tmp_path: Path, monkeypatch) -> None:
    path = tmp_path / "there.csv"
    path.write_text("mine")
    with pytest.raises(InputError, match="is there already; choose another name with TO="):
        GrowingCsv(path, ["a"])
    assert path.read_text() == "mine"
    with pytest.raises(InputError, match="column 'a' would stand twice"):
        GrowingCsv(tmp_path / "new.csv", ["a", "a"])
    with GrowingCsv(tmp_path / "new.csv", ["a, b", "c"]) as file:
        file.append([[1, "x y"], [2, ""]])
        write = os.write

        def full(handle: int, data: bytes) -> int:
            if len(data) < 6:
                raise OSError(28, "No space left on device")
            return write(handle, data[:5])

        monkeypatch.setattr(os, "write", full)
        with pytest.raises(InputError, match=r"new.csv: cannot be written: No space left"):
            file.append([[3, "three"]])
        monkeypatch.undo()
        assert file.rows == 2
        file.append([[4, ""]])
    assert (tmp_path / "new.csv").read_text() == '"a, b",c\n1,x y\n2,\n4,\n'


def test_only_this_machine_is_served() -> None:
    with Server("a <b>", lambda: {"x": 1}) as server:
        page = urllib.request.urlopen(server.address)
        assert "a &lt;b&gt;" in page.read().decode()
        assert "default-src 'none'" in page.headers["Content-Security-Policy"]
        assert json.load(urllib.request.urlopen(server.address + "state")) == {"x": 1}
        assert server._server.server_address[0] == "127.0.0.1"
        for path, host, code in (
            ("secret", "localhost:1", 404),
            ("state", "evil.example:80", 403),
            ("state", "", 403),
        ):
            request = urllib.request.Request(server.address + path)
            request.add_header("Host", host)
            with pytest.raises(urllib.error.HTTPError) as refused:
                urllib.request.urlopen(request)
            assert refused.value.code == code


def plain(page: str, name: str) -> str:
    """The text of an element."""
    found = re.search(rf'<(\w+) [^>]*id="{name}".*?</\1>', page, re.S)
    assert found, name
    return re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", found[0])).strip()


def test_the_browser_shows_numbers_profile_and_faults(scene: Scene, tmp_path: Path) -> None:
    simulated = TwinBoard(scene)
    with (
        Cable(simulated, tmp_path) as cable,
        SerialLine(cable.port, BAUD) as line,
        Server("t", (monitor := Monitor(Board(scene, scene), print)).state) as server,
    ):
        simulated.place({"load": 0.9, "position": 0.45, "width": 0.9, "shape": 0.45})
        listen(monitor, line, lambda: monitor.decoder.tally["frames"] > 300)
        page = browse(server.address, tmp_path)
        state = monitor.state()
        assert "packets come" in plain(page, "line")
        for shown in state["outputs"]:
            # The board stays where it was placed.
            assert f"{shown['name']} {shown['text']}" in plain(page, "outputs")
        assert f"{state['outputs'][1]['mm']} mm" in plain(page, "outputs")
        for shown in state["sensors"]:
            assert f"{shown['text']} code {shown['code']}" in plain(page, "sensors")
        assert page.count("<circle") == 17
        assert page.count('class="course"') == 4
        assert "nothing yet" in plain(page, "messages")
        cable.noise.put(b"noise")
        cable.cut()
        listen(monitor, line, lambda: monitor.state()["line"] == "cut")
        page = browse(server.address, tmp_path)
        assert "the line is cut" in plain(page, "line")
        assert "the line was cut: the device is gone" in plain(page, "messages")
        cable.mend()
        listen(monitor, line, lambda: monitor.state()["line"] == "packets")
        page = browse(server.address, tmp_path)
        assert "packets come" in plain(page, "line")
        assert "is back" in plain(page, "messages")
        # Nothing is drawn without data.
        assert page.count('class="course"') == 8


LOOK = """<script>
setTimeout(() => {{
  const beyond = [...document.querySelectorAll("body *")].filter(e => !e.closest(".scroll")
    && !e.closest("svg") && e.getBoundingClientRect().right > {width} + 1).map(e => e.outerHTML);
  document.title = JSON.stringify({{inner: innerWidth, wide: document.documentElement.scrollWidth,
    beyond, letters: [...document.querySelectorAll("svg text")].map(t => t.getScreenCTM().a)}});
}}, 1000);
</script>"""


@pytest.mark.parametrize("width", [390, 1280])
def test_the_page_fits_and_takes_names_as_text(scene: Scene, tmp_path: Path, width: int) -> None:
    still = Still(scene)
    for number in range(17):
        still.bring(still.packet(number, "line_error", count=number, point=number))
    state: dict[str, Any] = still.monitor.state()
    state["outputs"][0]["name"] = "<b>" + "a very long name " * 9
    state["sensors"][0] |= {"name": "<img src=x>" + "long" * 30, "unit": "micrometres per metre"}
    state |= {"recording": "/a/very/long/path" * 9, "messages": ["08:00:00 " + "word" * 90]}
    shown = {"number": 1, "known": ["-0.1234"] * 4, "errors": ["+0.1234"] * 4}
    state["learning"] = {"on": True, "shown": 1, "places": 31, "tour": True, "there": True}
    errors = [[-2.0, *[0.1] * 4], [0.0, *[0.2] * 4]]
    state["learning"] |= {"errors": errors, "placements": [shown]}
    page = page_of("t" * 60)
    stub = f"<script>window.fetch = async () => ({{json: async () => ({json.dumps(state)})}});"
    page = page.replace("<body>", f"<body>{stub}</script>{LOOK.format(width=width)}")
    # The window of a browser is at least 500 wide, so the page is shown in a frame.
    (tmp_path / "page.html").write_text(page)
    (tmp_path / "frame.html").write_text(
        f'<body style="margin:0"><iframe id="f" src="page.html" width="{width}" height="2000" '
        'style="border:0"></iframe><pre id="said"></pre><script>setTimeout(() => { said.textContent'
        ' = f.contentDocument.title + f.contentDocument.getElementById("sensors").innerText },'
        " 1500);</script>"
    )
    shown = browse(
        (tmp_path / "frame.html").as_uri(), tmp_path, "--allow-file-access-from-files", "--dump-dom"
    )
    said = re.search(r'<pre id="said">(.*?)</pre>', shown, re.S)
    text = said[1].replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")
    seen, rest = json.JSONDecoder().raw_decode(text)
    assert seen["beyond"] == []
    assert (seen["inner"], seen["wide"]) == (width, width)
    assert min(seen["letters"]) >= 0.8, "letters too small to read"
    assert text[rest:].startswith("<img src=x>long")


def test_the_command_ends_with_what_it_saw(scene: Scene, tmp_path: Path, capfd) -> None:
    to = f"--to={tmp_path}/a.csv"
    with Cable(TwinBoard(scene, 200.0), tmp_path) as cable:
        with (
            SerialLine(cable.port, BAUD),
            pytest.raises(InputError, match="another program has it open"),
        ):
            SerialLine(cable.port, BAUD)
        assert not call("monitor", "digit-board", cable.port, "--seconds=0.5", to)
    first, *_, counted, wrote = capfd.readouterr().out.splitlines()
    assert first.startswith(f"{cable.port}, 1000000 baud: look at http://127.0.0.1:")
    assert re.fullmatch(r"\d+ packets, 0 missed, 0 damaged", counted)
    rows = len((tmp_path / "a.csv").read_text().splitlines()) - 1
    assert wrote == f"wrote {tmp_path}/a.csv, {rows} rows"
    assert counted.startswith(f"{rows} ")
    assert not call("predict", "digit-board", tmp_path / "a.csv", tmp_path / "out.csv")
    assert f"of {rows} rows are outside" in capfd.readouterr().out


@pytest.mark.parametrize(
    ("name", "first"),
    [("digit-board", "the simulated board is being loaded"), ("digit-learning", "twin, 1000000 b")],
)
def test_the_command_needs_no_board(name: str, first: str, capfd) -> None:
    words = (name, "twin", "--seconds=0.1", "--drift=0.03,0.02", "--seed=4")
    assert not call("monitor", *words)
    begun, *_, counted = capfd.readouterr().out.splitlines()
    assert begun.startswith(first)
    assert re.fullmatch(r"[1-9]\d* packets, 0 missed, 0 damaged", counted)


def test_the_layout_is_that_of_the_hardware(scene: Scene) -> None:
    assert Board(scene, scene).layout == FrameLayout(4, 4, drawn=True)
    with pytest.raises(
        InputError, match=r"data.outputs: got 5, expected 4 at most, as the packets"
    ):
        Board(replace(scene, outputs=(*scene.outputs, "more")), scene)
