"""Tests the engine that learns: its program is the rule, and frames never see half of an update."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from pages import cells, section

from golden.engine.formats import DROPPED, OUTPUT_SHIFT, WIDTH
from golden.engine.graph import LOOKED_UP, Kind, Term
from golden.engine.integer_network import evaluate
from golden.input_error import InputError
from golden.learning.corrected import THETA, Corrected
from golden.learning.gradient import Lesson, bounded, equation, lms_step, start
from golden.learning.program import assembled
from golden.learning.segments import lms
from golden.learning.timeline import OUTPUTS, Timeline
from golden.networks.learning_engine import LearningEngine
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from tactus.recalibration.sensitivity import Sensitivity
from tactus.scene import Scene, load_scene
from tactus.scene.building import taught_of
from tactus.verify.benches.written import scene_of
from tb.common.case_library import CASE

SCENE = replace(load_scene("digit"), learning="lms")
VECTORS = SCENE.vectors()
TARGETS = SIGNAL.quantise(VECTORS.targets)[0]


@pytest.fixture(scope="module")
def twin() -> LearningEngine:
    return SCENE.twin()


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Scene:
    return scene_of(CASE["lesson"], tmp_path_factory.mktemp("lesson"), "lesson")


def sent(frames: Codes, before: int = 0) -> list[tuple[int, int, int]]:
    """Valid, data and last of frames one after the other, each behind some clocks."""
    rows = []
    for frame in frames.tolist():
        rows += [(0, 0, 0)] * before
        rows += [(1, code, int(k == len(frame) - 1)) for k, code in enumerate(frame)]
    return rows


class Desk:
    """Plays rows of inputs through a timeline."""

    def __init__(self, twin: LearningEngine) -> None:
        self.twin, self.timeline, self.clock = twin, Timeline(twin.program), 0

    def play(
        self,
        samples: list[tuple[int, int, int]],
        targets: list[tuple[int, int, int]] = (),
        learn: int = 0,
        clocks: int = 0,
        theta: int = 0,
    ) -> list[tuple[int, ...]]:
        """The outputs of every clock."""
        nothing, found = (0, 0, 0), []
        for n in range(max(len(samples), len(targets), clocks)):
            row = (
                *(samples[n] if n < len(samples) else nothing),
                *(targets[n] if n < len(targets) else nothing),
                theta,
                learn,
                0,
            )
            found.append(self.timeline.clock(self.clock, *row))
            self.clock += 1
        return found

    def show(self, samples: Codes, known: Codes) -> None:
        """A placement: a frame, and its known outputs."""
        self.play(sent(samples[np.newaxis]), clocks=self.twin.interval)
        self.play([], sent(known[np.newaxis]), clocks=60)

    def show_all(self, lesson: Lesson) -> None:
        for samples, known in zip(lesson.samples[0], lesson.targets[0], strict=True):
            self.show(samples, known)

    def learn(self, count: int) -> None:
        """Until so many equations were computed."""
        met, before = self.timeline.met, self._equations
        while self._equations < before + count:
            self.play([], learn=1, clocks=1)
        assert not met["equations stopped"]

    @property
    def _equations(self) -> int:
        return self.timeline.met["steps taken"] + self.timeline.met["steps refused"]


def drifted(count: int, seed: int = 1) -> Lesson:
    """Placements of the recording that drifted sensors read."""
    rng = np.random.default_rng(seed)
    rows = rng.permutation(len(TARGETS))[:count]
    x = VECTORS.inputs[rows] * (1 + 0.03 * rng.standard_normal(4)) + 0.02 * rng.standard_normal(4)
    return Lesson(SIGNAL.quantise(x)[0][np.newaxis], TARGETS[rows][np.newaxis])


@pytest.mark.parametrize("impossible", [False, True])
def test_the_program_is_the_rule(twin: LearningEngine, small: Scene, impossible: bool) -> None:
    """Theta after each placement, bit for bit, also where steps are refused."""
    scene, lesson, passes = SCENE, drifted(3), 3
    if impossible:
        scene, passes = small, 40
        samples = small.vectors().codes[:2]
        known = np.where(small.twin().process(samples) > 0, SIGNAL.low, SIGNAL.high)
        lesson = Lesson(samples[np.newaxis], known[np.newaxis])
    taught, rate = taught_of(scene)
    found = scene.twin()
    desk = Desk(found)
    desk.show_all(lesson)
    theta, refused = start(lesson, taught), 0
    # A new placement comes first, and the oldest one after it.
    order = [len(lesson) - 1, *list(range(len(lesson))) * passes]
    for placement in order:
        desk.learn(found.outputs)
        for output in range(found.outputs):
            said = equation(taught, lesson, theta, placement, output)
            theta, (taken,) = lms_step(theta, said, *rate[output])
            refused += not taken
        assert desk.timeline.theta == theta[0].tolist()
    assert desk.timeline.met["steps refused"] == refused
    assert (refused > 0) is impossible


def read_behind(desk: Desk, frame: Codes) -> list[int]:
    """The codes of theta that leave behind a frame."""
    seen = desk.play(sent(frame[np.newaxis]), clocks=desk.twin.interval + 2 * desk.twin.inputs + 3)
    return [row[OUTPUTS.index("theta_data")] for row in seen if row[OUTPUTS.index("theta_valid")]]


def test_what_was_learned_is_read_and_put_in_again(twin: LearningEngine) -> None:
    """Outputs of a second board are those of networks with the theta that the first one told."""
    taught, _ = taught_of(SCENE)
    lesson, first, second = drifted(4), Desk(twin), Desk(twin)
    first.show_all(lesson)
    first.learn(20 * twin.outputs)
    frame = VECTORS.codes[0]
    codes = read_behind(first, frame)
    assert codes == [word >> OUTPUT_SHIFT for word in first.timeline.theta]
    assert len(codes) == 8
    assert read_behind(second, frame) == [0] * 8
    second.play([], sent(np.array([codes])), clocks=60, theta=1)
    assert read_behind(second, frame) == codes
    seen = second.play(sent(VECTORS.codes[:9], before=twin.interval), clocks=12 * twin.interval)
    words = np.array(codes)[np.newaxis] << OUTPUT_SHIFT
    outputs = [row[1] for row in seen if row[0]]
    np.testing.assert_array_equal(
        np.array(outputs).reshape(9, -1),
        np.vstack([taught.process(words, one[np.newaxis]) for one in VECTORS.codes[:9]]),
    )
    assert second.timeline.met["theta put in"] == 1
    assert not second.timeline.met["placements"]


def test_a_reset_brings_back_what_was_shipped(twin: LearningEngine) -> None:
    lesson, desk = drifted(1), Desk(twin)
    desk.show_all(lesson)
    desk.learn(3)
    assert any(desk.timeline.theta)
    desk.timeline.clock(desk.clock, 0, 0, 0, 0, 0, 0, 0, 0, 1)
    desk.clock += 1
    frames = VECTORS.codes[:3]
    seen = desk.play(sent(frames, before=twin.interval), learn=1)
    seen += desk.play([], learn=1, clocks=twin.interval)
    outputs = [row[1] for row in seen if row[0]]
    np.testing.assert_array_equal(outputs, twin.process(frames).ravel())
    assert not any(desk.timeline.theta)


def test_every_sum_fits_whatever_the_words_are(twin: LearningEngine) -> None:
    """The largest sum of a part, from the program's own words, with every word at its end."""
    program, most = twin.program, 0
    for part in program.parts:
        total = 0
        for step in part:
            largest = abs(step.field) << (WIDTH - 1)
            if step.product:
                largest = 1 << 31
            elif step.kind == 3:
                largest = abs(step.field) << DROPPED
            elif step.kind:
                largest = 1 << (WIDTH - 1 + DROPPED)
            total = largest + (1 << 17 if step.first else total)
            most = max(most, total)
    assert most < 1 << (twin.acc_width - 1)


def test_equations_that_begin_differently_are_refused(twin: LearningEngine) -> None:
    """The program jumps to the rest of an equation behind steps that all of them have."""
    program = twin.program
    frame, keep, first, *others = program.parts
    with pytest.raises(InputError, match=r"learning: got equations .* whose first 1 steps are al"):
        assembled(program.places, program.table, [frame, keep, [first[0], *first[2:]], *others])
    assert assembled(program.places, program.table, program.parts) == program


@pytest.mark.parametrize("count", [4, 7, 9])
def test_theta_of_the_wrong_length_is_not_put_in(twin: LearningEngine, count: int) -> None:
    desk = Desk(twin)
    assert read_behind(desk, VECTORS.codes[0]) == [0] * 8
    seen = desk.play([], sent(np.full((1, count), 500)), clocks=60, theta=1)
    assert sum(row[OUTPUTS.index("target_error")] for row in seen) == 1
    assert read_behind(desk, VECTORS.codes[0]) == [0] * 8


def test_known_outputs_of_the_wrong_length_or_without_a_frame_are_not_kept(small: Scene) -> None:
    twin = small.twin()
    frame = np.array([[1000, -2000]])
    for known, framed in (([5], True), ([5, 6, 7], True), ([5, 6], False)):
        desk = Desk(twin)
        if framed:
            desk.play(sent(frame), clocks=twin.interval)
        seen = desk.play([], sent(np.array([known])), clocks=60)
        assert sum(row[5] for row in seen) == 1
        desk.play([], learn=1, clocks=5 * twin.longest_equation)
        assert not desk.timeline.met["placements"]
        assert not desk.timeline.met["steps taken"]


@pytest.mark.pages
def test_the_pages_have_the_figures_of_the_program(twin: LearningEngine) -> None:
    page, program = section("learning", "As a program of an engine"), twin.program
    frame, keep, *equations = program.lengths
    assert f"| frame | {frame} |" in page
    assert f"| keep | {keep} |" in page
    assert f"| equations | {', '.join(map(str, equations))} |" in page
    *most, last = twin.equation_clocks
    assert f"{', '.join(map(str, most))} or {last} clocks" in page
    clocks = 400 * 20 * sum(twin.equation_clocks)
    assert f"take {clocks:,} clocks, {clocks / 64e3:.0f} ms" in page
    assert f"{len(program.words):,} words with the table" in page
    assert f"{program.acc_width} bits" in page
    assert f"{twin.placements}\n  placements" in page


@pytest.fixture(scope="module")
def taught() -> Corrected:
    recorded = Sensitivity.of(SCENE, np.zeros(len(SCENE.sensors)))
    return Corrected.of(SCENE.mlps(), recorded.gain, recorded.offset)


@pytest.fixture(scope="module")
def recording() -> Lesson:
    """Every row of the recording as the one placement of a drift of its own, without any drift."""
    return Lesson(VECTORS.codes[:, np.newaxis], TARGETS[:, np.newaxis])


def test_without_a_correction_the_networks_are_those_of_the_scene(taught: Corrected) -> None:
    theta = np.zeros((len(VECTORS.codes), 2 * taught.sensors), dtype=np.int64)
    outputs = taught.process(theta, VECTORS.codes)
    np.testing.assert_array_equal(outputs, evaluate(taught.networks, VECTORS.codes))
    np.testing.assert_array_equal(outputs, SCENE.twin().process(VECTORS.codes))


@pytest.mark.parametrize("output", range(4))
def test_derivatives_are_those_of_the_network(
    taught: Corrected, recording: Lesson, output: int
) -> None:
    """By calculus on the trained network, which reads known outputs in front of it."""
    hidden = recording.hidden(taught, start(recording, taught), 0, output)
    found = taught.slopes(output, hidden) / 2**14
    seen = np.hstack([SIGNAL.to_real(VECTORS.codes), SIGNAL.to_real(TARGETS)[:, :output]])
    first, second = SCENE.mlps()[output].layers
    h = np.tanh(first.sums(seen))
    expected = ((second.weights * (1 - h * h)) @ first.weights)[:, :4]
    np.testing.assert_allclose(found, expected, atol=0.02)
    assert np.abs(expected).max() > 0.5


def test_the_page_counts_the_steps_of_a_pass(taught: Corrected) -> None:
    def what(term: Term) -> str:
        if term.kind in LOOKED_UP:
            return "intercept or slope of the table"
        if term.kind is Kind.ONE:
            return "the number one times a weight"
        return f"a word times a {'second word' if term.second >= 0 else 'weight'}"

    program = lms(taught, [[20000, 3], [30000, 0], [90000, 70], [60000, 1]])
    counted = Counter(what(term) for sums in program for one in sums.neurons for term in one.terms)
    page = section("learning", "As a program of an engine")
    assert len(counted) == 4
    for kind, count in counted.items():
        assert cells(page, kind)[0] == str(count)


def test_a_step_that_does_not_fit_is_not_taken_and_flagged() -> None:
    theta = np.array([[0, THETA.high - 1], [5, THETA.low]])
    found, taken = bounded(theta, theta + np.array([[3, 1], [3, -1]]))
    np.testing.assert_array_equal(found, [[3, THETA.high], [5, THETA.low]])
    np.testing.assert_array_equal(taken, [True, False])
