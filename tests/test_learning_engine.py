"""Tests the engine that learns: the hardware is the rule, and the rule that of the networks."""

from collections import Counter
from dataclasses import replace
from itertools import zip_longest

import numpy as np
import pytest
from pages import cells, section
from shared import in_myhdl

from golden.engine.formats import DROPPED, WIDTH
from golden.engine.graph import LOOKED_UP, Kind, Term
from golden.engine.integer_network import evaluate
from golden.input_error import InputError
from golden.learning.corrected import THETA, Corrected
from golden.learning.gradient import bounded, hidden_words
from golden.learning.program import assembled
from golden.learning.segments import lms
from golden.learning.timeline import INPUTS, OUTPUTS, Timeline
from golden.networks.learning_engine import LearningEngine
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from tactus.scene import Scene, load_scene
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


def sent(frame: Codes) -> list[tuple[int, int, int]]:
    """Valid, data and last of a frame."""
    return [(1, code, int(k == len(frame) - 1)) for k, code in enumerate(frame.tolist())]


class Desk:
    """Plays rows of inputs through a timeline, and keeps rows and outputs."""

    def __init__(self, twin: LearningEngine) -> None:
        self.twin, self.timeline = twin, Timeline(twin.program)
        self.rows: list[tuple[int, ...]] = []
        self.seen: list[tuple[int, ...]] = []

    def play(
        self,
        samples: list[tuple[int, int, int]],
        targets: list[tuple[int, int, int]] = (),
        learn: int = 0,
        clocks: int = 0,
        theta: int = 0,
    ) -> None:
        """Send words, for so many clocks at least."""
        words = zip_longest(range(clocks), samples, targets, fillvalue=(0, 0, 0))
        for _, sample, target in words:
            self.clock(*sample, *target, theta, learn, 0)

    def clock(self, *row: int) -> None:
        self.seen.append(self.timeline.clock(len(self.rows), *row))
        self.rows.append(row)

    def show(self, samples: Codes, known: Codes) -> None:
        """A placement: a frame, and its known outputs."""
        self.play(sent(samples), clocks=self.twin.interval)
        self.play([], sent(known), clocks=60)

    def learn(self, count: int) -> None:
        """Until so many steps were taken."""
        while self.timeline.pupil.steps < count:
            self.play([], learn=1, clocks=1)


@pytest.mark.parametrize("shipped", [False, True])
def test_the_hardware_is_the_rule(small: Scene, shipped: bool) -> None:
    """Learned, told, put in, and brought back by a reset: every port in every clock."""
    scene = SCENE if shipped else small
    twin, codes = scene.twin(), scene.vectors().codes
    desk, rng = Desk(twin), np.random.default_rng(5)
    for frame in codes[:2]:
        known = twin.process(frame) + rng.integers(-3000, 3001, twin.outputs)
        known = np.clip(known, SIGNAL.low, SIGNAL.high)
        desk.show(frame, known)
    desk.learn(3 * twin.outputs)
    frame = sent(codes[0])
    desk.play(frame, clocks=twin.interval + 2 * twin.inputs + 3)
    assert np.abs(desk.timeline.pupil.codes).min() > 0
    theta = rng.integers(SIGNAL.low, SIGNAL.high, 2 * twin.inputs)
    desk.play([], sent(theta), clocks=60, theta=1)
    assert desk.timeline.pupil.codes.tolist() == theta.tolist()
    desk.play(frame, clocks=twin.interval + 2 * twin.inputs + 3)
    # From there it learns on, until a difference in the lowest bit of a step can be read.
    desk.play([], learn=1, clocks=20 * twin.longest_equation)
    desk.play(frame, clocks=twin.interval + 2 * twin.inputs + 3)
    # Words of both kinds in one stream, whose length is neither's.
    for count, kind in ((3, 1), (9, 0)):
        desk.play([], [(1, 500, 0)] * count, theta=kind)
    desk.play([], [(1, 500, 1)], clocks=60)
    desk.clock(0, 0, 0, 0, 0, 0, 0, 0, 1)
    desk.play(frame, learn=1, clocks=twin.interval + 2 * twin.inputs + 3)
    assert not desk.timeline.pupil.theta.any()
    # An output leaves where its stream is valid.
    unseen = np.zeros((len(desk.seen), len(OUTPUTS)), dtype=bool)
    for stream in ("out", "theta"):
        valid = np.array(desk.seen)[:, OUTPUTS.index(f"{stream}_valid")]
        assert valid.any()
        unseen[:, OUTPUTS.index(f"{stream}_data")] = valid == 0
    found = in_myhdl(twin, INPUTS, OUTPUTS, desk.rows)
    np.testing.assert_array_equal(np.where(unseen, 0, found), np.where(unseen, 0, desk.seen))


@pytest.mark.parametrize("words", [1, 3, 4, 5])
@pytest.mark.parametrize("theta", [0, 1])
@pytest.mark.parametrize("framed", [True, False])
def test_what_is_told_of_the_wrong_length_or_without_a_frame_is_not_kept(
    small: Scene, words: int, theta: int, framed: bool
) -> None:
    twin = small.twin()
    desk = Desk(twin)
    if framed:
        desk.play(sent(np.array([1000, -2000])), clocks=twin.interval)
    told = np.full(words, 500)
    right = framed and words == (2 * twin.inputs if theta else twin.outputs)
    desk.play([], sent(told), clocks=60, theta=theta)
    assert sum(row[OUTPUTS.index("target_error")] for row in desk.seen) == (not right)
    desk.play([], learn=1, clocks=5 * twin.longest_equation)
    pupil = desk.timeline.pupil
    assert (pupil.placements, pupil.changes) == (0, int(right))


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
    table, (frame, keep, first, *others) = twin.program.table, twin.program.parts
    with pytest.raises(InputError, match=r"learning: got equations .* whose first 1 steps are al"):
        assembled(table, [frame, keep, [first[0], *first[2:]], *others])
    assert assembled(table, twin.program.parts)[0] == twin.program.words


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
def taught(twin: LearningEngine) -> Corrected:
    return twin.program.taught


def test_without_a_correction_the_networks_are_those_of_the_scene(taught: Corrected) -> None:
    theta = np.zeros((len(VECTORS.codes), 2 * taught.sensors), dtype=np.int64)
    outputs = taught.process(theta, VECTORS.codes)
    np.testing.assert_array_equal(outputs, evaluate(taught.networks, VECTORS.codes))
    np.testing.assert_array_equal(outputs, SCENE.twin().process(VECTORS.codes))


@pytest.mark.parametrize("output", range(4))
def test_derivatives_are_those_of_the_network(taught: Corrected, output: int) -> None:
    """By calculus on the trained network, which reads known outputs in front of it."""
    theta = np.zeros((len(VECTORS.codes), 2 * taught.sensors), dtype=np.int64)
    hidden = hidden_words(taught, theta, VECTORS.codes, TARGETS, output)
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
