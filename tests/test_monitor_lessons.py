"""Tests teaching a board that learns, from a request of the page to what the board then sends."""

import html
import http.client
import json
import re
from dataclasses import replace
from itertools import islice
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from shared import browse
from test_monitor import Still, listen

from golden.engine.formats import SAMPLE, SAMPLE_SHIFT
from golden.engine.integer_network import evaluate
from golden.engine.quantise import integer_networks
from golden.input_error import InputError
from golden.link.packets import lesson_packet
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from tactus.monitor.board import Board
from tactus.monitor.lessons import tour_of
from tactus.monitor.monitor import NOT_SENT, Monitor
from tactus.monitor.server import Server, page_of
from tactus.monitor.twin_board import TwinBoard, TwinLessons
from tactus.recalibration.fit import fit
from tactus.recalibration.folder import corrected
from tactus.recalibration.outlook import proposed
from tactus.recalibration.sensitivity import Placements, Sensitivity
from tactus.scene import Scene, load_scene
from tactus.scene.disturbance import Disturbance
from tactus.verify.benches.written import scene_of
from tb.common.case_library import CASE

DRIFT = Disturbance(gain=0.03, offset=0.02)
KNOWN = {"load": "0.9", "position": "0.45", "width": "0.9", "shape": "0.45"}


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load_scene("digit-learning")


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Scene:
    return scene_of(CASE["lesson"], tmp_path_factory.mktemp("lesson"), "lesson")


def lessons_of(scene: Scene) -> TwinLessons:
    return TwinLessons(scene.twin().core.program.pupil())


def texts(scene: Scene, row: int) -> dict[str, str]:
    """The known outputs of a row of the recording, as the page sends them."""
    values = scene.in_units(scene.vectors().targets[row])
    return {name: f"{value:g}" for name, value in zip(scene.outputs, values, strict=True)}


GOOD = lesson_packet(4, True, [-8192, 8191])
SOUND = {
    "whole": GOOD,
    "behind noise": b"\x00\xa5\xa5\x11\xa5" + GOOD,
    "behind one that does not learn": lesson_packet(4, learn=False) + GOOD,
}
DAMAGED = {
    "a bit": GOOD[:5] + bytes([GOOD[5] ^ 4]) + GOOD[6:],
    "the check": GOOD[:-1] + bytes([GOOD[-1] ^ 1]),
    "the length": GOOD[:2] + b"\x07" + GOOD[3:],
    "of more codes": lesson_packet(5, True, [1, 2, 3]),
    "the end": GOOD[:-1],
}


@pytest.mark.parametrize("name", [*SOUND, *DAMAGED])
def test_lessons_are_taken_whole_or_not_at_all(small: Scene, name: str) -> None:
    lessons, data = lessons_of(small), {**SOUND, **DAMAGED}[name]
    lessons.take(data)
    sound = name in SOUND
    lessons.read(np.array([5, -6]))
    assert lessons.flags() == (["learning"] if sound else ["lesson_error"])
    lessons.read(np.array([7, 8]))
    # An error is that of one packet.
    assert lessons.flags() == (["learning"] if sound else [])
    assert lessons.pupil.placements == sound
    if not sound:
        lessons.take(GOOD)
        assert lessons.flags() == ["learning"]


@pytest.mark.parametrize("later", [DAMAGED["the check"], lesson_packet(4, True)])
def test_a_packet_takes_the_place_of_one_that_waits(small: Scene, later: bytes) -> None:
    """Also if it is wrong. Whether to learn stays as the last right one says."""
    lessons = lessons_of(small)
    lessons.take(GOOD)
    lessons.take(later)
    lessons.read(np.array([5, -6]))
    assert lessons.flags()[-1] == "learning"
    assert lessons.pupil.placements == 0


@pytest.mark.parametrize("end", [SIGNAL.low, SIGNAL.high])
@pytest.mark.parametrize("packet", [GOOD, lesson_packet(4, True, [1, 2, 3, 4], "theta")])
def test_a_frame_with_a_reading_at_an_end_takes_no_lesson(
    small: Scene, packet: bytes, end: int
) -> None:
    lessons = lessons_of(small)
    lessons.read(np.array([end, 3]))
    assert lessons.flags() == []
    lessons.take(packet)
    lessons.read(np.array([3, end]))
    assert lessons.flags() == ["lesson_error", "learning"]
    assert (lessons.pupil.placements, lessons.pupil.changes) == (0, 0)
    lessons.read(np.array([3, 4]))
    assert (lessons.pupil.placements, lessons.pupil.changes) == (0, 0)


def test_a_step_that_is_refused_is_told(small: Scene) -> None:
    lessons, codes = lessons_of(small), small.vectors().codes[0]
    known = np.where(small.twin().process(codes[np.newaxis])[0] > 0, SIGNAL.low, SIGNAL.high)
    lessons.take(lesson_packet(4, True, known.tolist()))
    lessons.read(codes)
    assert lessons.flags() == ["learning"]
    while not lessons.pupil.refused:
        lessons.learn_for(0.01)
    assert lessons.flags() == ["learn_error", "learning"]


def teach(monitor: Monitor, simulated: TwinBoard, row: int, **more: bool) -> None:
    """Put the load where it was in a row of the recording, and show it."""
    known, count = texts(monitor.board.scene, row), simulated.lessons.pupil.placements
    simulated.place(known)
    samples = tuple(simulated.samples[row].tolist())
    listen(monitor, simulated, lambda: monitor._newest and monitor._newest.samples == samples)
    monitor.teach({"known": known, **more})
    listen(monitor, simulated, lambda: simulated.lessons.pupil.placements == count + 1)


def worst(scene: Scene, outputs: Codes, shown: list[int]) -> np.ndarray:
    """The worst error of each output over the rows that were not shown, in percent."""
    errors = scene.vectors().percent_errors(SIGNAL.to_real(outputs))
    return np.delete(errors, shown, axis=0).max(axis=0)


def test_a_board_with_drifted_sensors_is_taught(scene: Scene) -> None:
    """Twelve placements over the line, and 1200 steps.

    Then the errors of the other rows are at most a third of those before, and twice those of
    ``make recalibrate`` with the same placements.
    """
    board, said = Board(scene, scene), []
    recorded = Sensitivity.of(scene, np.zeros(4))
    rows = [one.row for one in islice(proposed(recorded), 12)]
    simulated, monitor = TwinBoard(scene, 0.0, 1, DRIFT, 4), Monitor(board, said.append)
    pupil = simulated.lessons.pupil
    before = worst(scene, pupil.process(simulated.samples), rows)
    for row in rows:
        teach(monitor, simulated, row)
    assert not pupil.steps
    monitor.teach({"learn": True})
    # A slow machine takes longer for all of them than one wait lasts.
    for steps in range(100, 1300, 100):
        listen(monitor, simulated, lambda steps=steps: pupil.steps >= steps)
    assert monitor.state()["learning"]["on"]
    monitor.teach({"learn": False})
    listen(monitor, simulated, lambda: not monitor.state()["learning"]["on"])
    state = monitor.state()
    # What it sends is what it has learned, and the load is where it was shown last.
    sample = simulated.samples[rows[-1]][np.newaxis]
    assert monitor._newest.outputs == tuple(pupil.process(sample)[0].tolist())
    after = worst(scene, pupil.process(simulated.samples), rows)
    computer = fit(recorded, placements_of(scene, simulated.samples, rows)).theta
    mlps = corrected(scene, recorded.correction(computer))
    outputs = evaluate(integer_networks("cascade", mlps), simulated.samples)
    theirs = worst(scene, outputs, rows)
    assert (after <= before / 3).all(), (before, after)
    assert after.mean() <= 2 * theirs.mean(), (after, theirs)
    assert said == []
    learning = state["learning"]
    assert (learning["shown"], learning["places"], learning["there"]) == (12, 31, True)
    first = [float(text) for text in learning["placements"][-1]["errors"]]
    last = [abs(value) for value in learning["errors"][-1][1:]]
    assert max(last) < max(map(abs, first)) / 2
    known = [float(text) for text in learning["placements"][-1]["known"]]
    assert known == pytest.approx(scene.in_units(scene.vectors().targets[rows[-1]]), abs=2e-4)


def placements_of(scene: Scene, samples: Codes, rows: list[int]) -> Placements:
    vectors = scene.vectors()
    return Placements(
        SIGNAL.to_real(samples[rows]),
        vectors.targets[rows],
        vectors.scale[rows],
        np.ones(len(rows)),
    )


def test_what_a_board_learned_is_put_into_another(scene: Scene) -> None:
    """Over the line, there and back; a reset in between is a board that was never taught."""
    board, simulated = Board(scene, scene), TwinBoard(scene, 0.0, 1, DRIFT, 4)
    monitor, pupil = Monitor(board, print), simulated.lessons.pupil
    for row in (75, 20):
        teach(monitor, simulated, row)
    monitor.teach({"learn": True})
    listen(monitor, simulated, lambda: pupil.steps >= 100)
    monitor.teach({"learn": False})
    listen(
        monitor,
        simulated,
        lambda: (
            monitor.state()["learning"]["theta"] == pupil.codes.tolist()
            and monitor.lessons._found[0] == 2
        ),
    )
    state = monitor.state()["learning"]
    samples = simulated.samples[:5]
    # Known outputs are sent as codes, and what is found hangs on their last bits.
    placements = placements_of(scene, simulated.samples, [75, 20])
    known = SIGNAL.to_real(SIGNAL.quantise(placements.targets)[0])
    placements = replace(placements, targets=known)
    factors = np.array([scale.factor for scale in scene.scales(scene.sensors)])
    noise = scene.training.disturbance.noise / factors
    best = fit(Sensitivity.of(scene, noise), placements).theta
    np.testing.assert_allclose(state["recalibrated"], 1024 * best, atol=3)
    beside = [one["gain_found"] for one in state["corrections"]]
    np.testing.assert_allclose([float(one) for one in beside], 5 * best[:4], atol=0.02)
    assert any(state["theta"])
    gain, offset = pupil.taught.corrections(np.array(state["theta"]))
    assert [one["gain"] for one in state["corrections"]] == [f"{100 * g:+.2f}" for g in gain]
    assert [one["name"] for one in state["corrections"]] == list(scene.sensors)
    x = SIGNAL.to_real(samples)
    words = pupil.theta[np.newaxis].repeat(5, axis=0)
    z = SAMPLE.to_real(pupil.taught.samples(words, samples << SAMPLE_SHIFT))
    np.testing.assert_allclose(x + x * gain + offset, z, atol=1e-4)
    simulated = TwinBoard(scene, 0.0, 1, DRIFT, 4)
    monitor, second = Monitor(board, print), simulated.lessons.pupil
    listen(monitor, simulated, lambda: monitor.state()["learning"]["theta"] == [0] * 8)
    monitor.teach({"theta": state["theta"]})
    listen(monitor, simulated, lambda: monitor.state()["learning"]["theta"] == state["theta"])
    shown = monitor.state()["learning"]
    outputs = second.process(samples)
    simulated.place(texts(scene, 75))
    (there,) = second.process(simulated.samples[75:76]).tolist()
    listen(monitor, simulated, lambda: monitor._newest.outputs == tuple(there))
    assert second.codes.tolist() == state["theta"]
    assert (shown["shown"], shown["on"], second.placements) == (0, False, 0)
    # What is read has not the lowest bits of the words.
    assert np.abs(outputs - pupil.process(samples)).max() <= 8


class Written:
    """Adds to a wire what is written to it; with ``broken`` nothing can be."""

    def __init__(self, still: Still) -> None:
        self.data, self.broken = b"", False
        still.wire.write = self.write

    def write(self, data: bytes) -> None:
        if self.broken:
            raise InputError("PORT=wire: the line was cut: the device is gone")
        self.data += data


def test_what_is_sent_and_what_is_noted(scene: Scene) -> None:
    still = Still(scene)
    written, monitor = Written(still), still.monitor
    with pytest.raises(InputError, match="a lesson is not sent: no frames come from the board"):
        monitor.teach({"known": KNOWN})
    still.bring(still.packet(0, count=1))
    monitor.teach({"known": KNOWN})
    codes = [round(0.9 * 8192), round(0.45 * 8192)] * 2
    assert still.bring(b"") == []
    assert written.data == lesson_packet(8, False, codes)
    state = monitor.state()["learning"]
    (placement,) = state["placements"]
    assert placement == {
        "number": 1,
        "known": ["0.9000", "0.4500", "0.9000", "0.4500"],
        "errors": ["-0.9000", "-0.4500", "-0.9000", "-0.4500"],
    }
    still.now += 1
    still.bring(still.packet(1, "learning", count=2))
    state = monitor.state()["learning"]
    assert [t for t, *_ in state["errors"]] == [-1.0, 0.0]
    assert state["errors"][-1][1:] == pytest.approx([-0.9, -0.45, -0.9, -0.45], abs=1e-4)
    # The board learns, whoever said so. The last wish counts from then on.
    for wish, learn in ((None, False), (True, True), (None, True), (False, False), (None, False)):
        written.data = b""
        monitor.teach({"known": KNOWN} if wish is None else {"learn": wish})
        still.bring(still.packet(2, "learning", count=3))
        sent = codes if wish is None else ()
        assert written.data == lesson_packet(8, learn, sent)
    assert monitor.state()["learning"]["shown"] == 4
    monitor.actions()["/moved"]({})
    state = monitor.state()["learning"]
    assert (state["there"], state["errors"]) == (False, [])
    monitor.teach({"known": KNOWN})
    written.broken = True
    (line,) = still.bring(b"")
    assert line == NOT_SENT
    assert monitor.state()["learning"]["shown"] == 4


WRONG = {
    "no texts": ({"known": {"load": 0.5}}, "known: got {'load': 0.5}, expected a text for each"),
    "no names": ({"known": ["0.5"]}, "known: got ['0.5'], expected a text for each output"),
    "no wish": ({"learn": "yes"}, "learn: got 'yes', expected true or false"),
    "missing": ({"known": {"load": "0"}}, "position: got nothing, expected a number from -1.0"),
    "no file": ({"theta": None}, "theta: got None, expected 8 whole numbers from -8192 to 8191"),
    "empty": ({"known": KNOWN | {"width": " "}}, "width: got nothing, expected a number from -1.0"),
    "no number": ({"known": KNOWN | {"load": "nan"}}, "load: got 'nan', expected a number from -1"),
    "no theta": ({"theta": "0"}, "theta: got '0', expected 8 whole numbers from -8192 to 8191"),
    "short": ({"theta": [1] * 7}, "theta: got 7 values, [1, 1, 1, 1, 1, 1, 1], expected 8 whole"),
    "beyond": ({"theta": [8192] * 8}, "theta: got 8 values, [8192, 8192, 8192, 8192, 8192, 8192, "),
    "too far": ({"known": KNOWN | {"load": "-1.0001"}}, "load: got '-1.0001', expected a number f"),
}


def posted(server: Server, path: str, body: str, **headers: str) -> tuple[int, str]:
    """Status and text of the answer to a request, with these headers in place of the usual ones."""
    host, port = server.address.removeprefix("http://").rstrip("/").split(":")
    connection = http.client.HTTPConnection(host, int(port), timeout=30)
    usual = {"Content_Type": "application/json", "Host": f"{host}:{port}"}
    sent = {name.replace("_", "-"): text for name, text in (usual | headers).items() if text}
    connection.putrequest("POST", path, skip_host=True)
    for name, text in ({"Content-Length": str(len(body))} | sent).items():
        connection.putheader(name, text)
    connection.endheaders(body.encode())
    answer = connection.getresponse()
    return answer.status, answer.read().decode()


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_request_is_answered_with_what_was_expected(scene: Scene, name: str) -> None:
    request, message = WRONG[name]
    still = Still(scene)
    written = Written(still)
    still.bring(still.packet(0, count=1))
    with Server("t", still.monitor.state, still.monitor.actions()) as server:
        status, text = posted(server, "/teach", json.dumps(request))
    assert status == 400
    assert json.loads(text)["error"].startswith(message)
    still.bring(b"")
    assert written.data == b""


def test_only_the_page_itself_may_ask() -> None:
    asked: list[Any] = []

    def take(sent: Any) -> dict[str, int]:
        asked.append(sent)
        return {"took": 1}

    with Server("t", dict, {"/teach": take}) as server:
        own = server.address.rstrip("/")
        own_name = own.removeprefix("http://").replace("127.0.0.1", "localhost")
        for path, body, headers, status in (
            ("/teach", "{}", {}, 200),
            ("/teach", "{}", {"Content_Type": "application/json; charset=utf-8"}, 200),
            ("/teach", "{}", {"Origin": own}, 200),
            ("/teach", "{}", {"Origin": f"http://{own_name}", "Host": own_name}, 200),
            ("/teach", "{}", {"Origin": "http://evil.example"}, 403),
            ("/teach", "{}", {"Origin": "null"}, 403),
            ("/teach", "{}", {"Origin": f"http://{own_name}"}, 403),
            ("/teach", "{}", {"Host": "evil.example:80"}, 403),
            ("/teach", "{}", {"Host": ""}, 403),
            ("/teach", "{}", {"Content_Type": "text/plain"}, 415),
            ("/teach", "{}", {"Content_Type": ""}, 415),
            ("/state", "{}", {}, 404),
            ("/teach", "{", {}, 400),
            ("/teach", "[]", {}, 400),
            ("/teach", "", {"Content_Length": "99999"}, 400),
            ("/teach", "", {"Content_Length": "-1"}, 400),
        ):
            answer = posted(server, path, body, **headers)
            assert answer[0] == status, (path, headers, answer)
            assert ("took" in answer[1]) == (status == 200)
        # A browser asks first whether it may send JSON from elsewhere.
        connection = http.client.HTTPConnection(own.removeprefix("http://"), timeout=30)
        connection.request("OPTIONS", "/teach")
        assert connection.getresponse().status == 501
    assert asked == [{}] * 4


def test_a_tour_goes_on_behind_a_placement_that_is_refused(scene: Scene) -> None:
    placed: list[dict[str, float]] = []

    def place(known: dict[str, float]) -> None:
        placed.append(known)
        if len(placed) == 1:
            raise InputError("no such placement")

    tour = tour_of(Board(scene, scene), SimpleNamespace(place=place))
    with pytest.raises(InputError, match="no such placement"):
        next(tour)
    rows = [one.row for one in islice(proposed(Sensitivity.of(scene, np.zeros(4))), 2)]
    assert next(tour) == texts(scene, rows[1])
    assert [f"{value:g}" for value in placed[1].values()] == list(texts(scene, rows[1]).values())


CLICKS = """<script>
const asked = [], answers = {teach: [400, {error: "load: got nothing"}], next: [200, KNOWN]};
window.fetch = async (path, options) => {
  if (path === "state") return {json: async () => (STATE)};
  asked.push([path, options.method, options.headers["Content-Type"], JSON.parse(options.body)]);
  const [status, answer] = answers[path] || [200, null];
  return {ok: status === 200, json: async () => answer};
};
const later = n => new Promise(done => setTimeout(done, n));
setTimeout(async () => {
  const told = [];
  for (const id of ["teach", "next", "teach", "learn", "moved"]) {
    document.getElementById(id).click();
    await later(50);
    told.push(document.getElementById("refused").textContent);
  }
  document.title = JSON.stringify([asked, told]);
}, 500);
</script>"""


def test_the_page_asks_for_what_is_pressed(scene: Scene, tmp_path: Path) -> None:
    still = Still(scene)
    Written(still)
    still.bring(still.packet(0, "learning", count=1))
    state = still.monitor.state()
    state["learning"]["tour"] = True
    page = page_of("t")
    script = CLICKS.replace("STATE", json.dumps(state)).replace("KNOWN", json.dumps(KNOWN))
    (tmp_path / "page.html").write_text(page.replace("<body>", f"<body>{script}"))
    shown = browse((tmp_path / "page.html").as_uri(), tmp_path)
    title = re.search(r"<title>(.*?)</title>", shown, re.S)
    asked, told = json.loads(html.unescape(title[1]))
    empty = dict.fromkeys(KNOWN, "")
    assert [[path, sent] for path, _, _, sent in asked] == [
        ["teach", {"known": empty}],
        ["next", {}],
        ["teach", {"known": KNOWN}],
        ["teach", {"learn": False}],
        ["moved", {}],
    ]
    assert {(method, kind) for _, method, kind, _ in asked} == {("POST", "application/json")}
    refusal = "load: got nothing"
    assert told == [refusal, "", refusal, refusal, ""]
