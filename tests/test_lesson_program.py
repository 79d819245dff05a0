"""Tests the program of an engine that learns: it is the rule, and frames see whole updates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest
from conftest import random_mlp
from pages import section

from golden.engine.formats import WIDTH
from golden.engine.integer_network import evaluate
from golden.engine.neurons import graph_of
from golden.fixed import Codes
from golden.learning import steps
from golden.learning.corrected import Corrected
from golden.learning.gradient import STEP
from golden.learning.lesson import Lesson
from golden.learning.places import Places
from golden.learning.program import LessonProgram, lesson_program
from golden.learning.timeline import Timeline
from golden.mlp import Mlp
from golden.precision import SIGNAL
from golden.recalibration.sensitivity import Sensitivity
from golden.scene import load_scene

SCENE = load_scene("digit")
VECTORS = SCENE.vectors()
TARGETS = SIGNAL.quantise(VECTORS.targets)[0]
# No address of an operand memory has fewer bits.
LEAST = 7


@dataclass(frozen=True)
class Board:
    """Networks behind sensors that are corrected, and the program that learns.

    Attributes
    ----------
    taught : Corrected
    constants : tuple of int
        The constant step of each output.
    """

    taught: Corrected
    constants: tuple[int, ...]

    @classmethod
    def of(
        cls, mlps: Sequence[Mlp], drift: Sequence[np.ndarray], lengths: Sequence[float]
    ) -> Board:
        """A board whose constant steps are half of those that overshoot with rows so long."""
        constants = STEP.quantise(0.5 / np.array(lengths))[0]
        return cls(Corrected.of(mlps, *drift), tuple(constants.tolist()))

    @cached_property
    def program(self) -> LessonProgram:
        return lesson_program(self.taught, self.constants, graph_of(self.taught.networks), LEAST)

    @property
    def interval(self) -> int:
        """Clocks from one frame to the next."""
        return self.program.clock(self.program.output_steps[-1]) + self.taught.sensors

    @property
    def equation_clocks(self) -> list[int]:
        """Clocks in one piece that the equation of each output takes."""
        at = self.program.pipeline
        return [at.run + count + at.result for count in self.program.lengths[2:]]

    def process(self, frames: Codes) -> Codes:
        """The outputs before anything is learned."""
        return evaluate(self.taught.networks, frames)


@pytest.fixture(scope="module")
def digit() -> Board:
    recorded = Sensitivity.of(SCENE, np.zeros(len(SCENE.sensors)))
    lengths = 0.151, 0.091, 0.019, 0.042
    return Board.of(SCENE.mlps(), (recorded.gain, recorded.offset), lengths)


@pytest.fixture(scope="module")
def small() -> Board:
    """Two flat networks in cascade, which give no output near the ends of the range."""
    mlps = [random_mlp(shape, 0.3, 7 + n) for n, shape in enumerate([(2, 2, 1), (3, 1, 1)])]
    return Board.of(mlps, (np.full(2, 0.05), np.full(2, 0.02)), (0.001, 0.001))


def sent(frames: Codes, before: int = 0) -> list[tuple[int, int, int]]:
    """Valid, data and last of frames one after the other, each behind some clocks."""
    rows = []
    for frame in frames.tolist():
        rows += [(0, 0, 0)] * before
        rows += [(1, code, int(k == len(frame) - 1)) for k, code in enumerate(frame)]
    return rows


class Desk:
    """Plays rows of inputs through a timeline."""

    def __init__(self, board: Board) -> None:
        self.board, self.timeline, self.clock = board, Timeline(board.program), 0

    def play(
        self,
        samples: Sequence[tuple[int, int, int]] = (),
        targets: Sequence[tuple[int, int, int]] = (),
        learn: int = 0,
        clocks: int = 0,
    ) -> list[tuple[int, ...]]:
        """The outputs of every clock."""
        nothing, found = (0, 0, 0), []
        for n in range(max(len(samples), len(targets), clocks)):
            row = (
                *(samples[n] if n < len(samples) else nothing),
                *(targets[n] if n < len(targets) else nothing),
                learn,
                0,
            )
            found.append(self.timeline.clock(self.clock, *row))
            self.clock += 1
        return found

    def show(self, samples: Codes, known: Codes) -> None:
        """A placement: a frame, and its known outputs."""
        self.play(sent(samples[np.newaxis]), clocks=self.board.interval)
        self.play(targets=sent(known[np.newaxis]), clocks=60)

    def learn(self, count: int) -> None:
        """Until so many equations were computed."""
        met, before = self.timeline.met, self._equations
        while self._equations < before + count:
            self.play(learn=1, clocks=1)
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
def test_the_program_is_the_rule(digit: Board, small: Board, impossible: bool) -> None:
    """Theta after each placement, bit for bit, also where steps are refused."""
    board, lesson, passes = digit, drifted(3), 3
    if impossible:
        board, passes = small, 40
        samples = np.random.default_rng(1).integers(SIGNAL.low, SIGNAL.high + 1, (2, 2))
        known = np.where(small.process(samples) > 0, SIGNAL.low, SIGNAL.high)
        lesson = Lesson(samples[np.newaxis], known[np.newaxis])
    taught, desk = board.taught, Desk(board)
    for samples, known in zip(lesson.samples[0], lesson.targets[0], strict=True):
        desk.show(samples, known)
    run = steps.Run(taught, steps.lms(taught, board.constants), [0] * 2 * taught.sensors)
    # A new placement comes first, and the oldest one after it.
    for placement in [len(lesson) - 1, *list(range(len(lesson))) * passes]:
        desk.learn(taught.outputs)
        run.show(lesson, placement)
        assert desk.timeline.theta == run.theta
    assert desk.timeline.met["steps refused"] == run.flags
    assert (run.flags > 0) is impossible


def test_outputs_are_those_of_the_corrected_networks(digit: Board) -> None:
    lesson, desk = drifted(2), Desk(digit)
    for samples, known in zip(lesson.samples[0], lesson.targets[0], strict=True):
        desk.show(samples, known)
    desk.learn(6 * digit.taught.outputs)
    theta, frame = np.array(desk.timeline.theta)[np.newaxis], lesson.samples[0, :1]
    seen = desk.play(sent(frame), clocks=digit.interval)
    outputs = [row[1] for row in seen if row[0]]
    np.testing.assert_array_equal(outputs, digit.taught.process(theta, frame)[0])
    assert outputs != digit.process(frame)[0].tolist()


def test_frames_come_in_the_same_clocks_whether_it_learns_or_not(small: Board) -> None:
    """As close as they may be, nothing is learned; with room between them, it is."""
    frames = np.random.default_rng(1).integers(SIGNAL.low, SIGNAL.high + 1, (12, 2))
    busy = small.interval - small.taught.sensors
    for room in (0, 3 * max(small.equation_clocks)):
        clocks = []
        for learn in (0, 1):
            desk = Desk(small)
            desk.show(frames[0], frames[1])
            rows = sent(frames, before=busy + room)
            seen = desk.play(rows, learn=learn, clocks=len(rows) + busy)
            clocks.append([n for n, row in enumerate(seen) if row[0]])
            assert not any(row[3] for row in seen)
            assert (desk.timeline.met["steps taken"] > 0) == bool(learn and room)
        assert clocks[0] == clocks[1]


def test_a_reset_brings_back_what_was_shipped(digit: Board) -> None:
    lesson, desk = drifted(1), Desk(digit)
    desk.show(lesson.samples[0, 0], lesson.targets[0, 0])
    desk.learn(3)
    assert any(desk.timeline.theta)
    desk.timeline.clock(desk.clock, 0, 0, 0, 0, 0, 0, 0, 1)
    desk.clock += 1
    frames = VECTORS.codes[:3]
    rows = sent(frames, before=digit.interval)
    seen = desk.play(rows, learn=1, clocks=len(rows) + digit.interval)
    outputs = [row[1] for row in seen if row[0]]
    np.testing.assert_array_equal(outputs, digit.process(frames).ravel())
    assert not any(desk.timeline.theta)


def test_known_outputs_of_the_wrong_length_or_without_a_frame_are_not_kept(small: Board) -> None:
    frame = np.array([[1000, -2000]])
    for known, framed in (([5], True), ([5, 6, 7], True), ([5, 6], False)):
        desk = Desk(small)
        if framed:
            desk.play(sent(frame), clocks=small.interval)
        seen = desk.play(targets=sent(np.array([known])), clocks=60)
        assert sum(row[5] for row in seen) == 1
        desk.play(learn=1, clocks=5 * max(small.equation_clocks))
        assert not desk.timeline.met["placements"]
        assert not desk.timeline.met["steps taken"]


@pytest.mark.parametrize("kind", ["random", "dead", "ends"])
def test_no_placement_drives_a_word_out_of_its_range(digit: Board, kind: str) -> None:
    """Every sum fits in the accumulator whatever words it takes, so this looks at theta alone."""
    rng, desk = np.random.default_rng(3), Desk(digit)
    for _ in range(3):
        samples = rng.integers(SIGNAL.low, SIGNAL.high + 1, 4)
        if kind == "dead":
            samples[1] = SIGNAL.high
        known = rng.integers(SIGNAL.low, SIGNAL.high + 1, 4)
        if kind == "ends":
            known = np.where(known > 0, SIGNAL.high, SIGNAL.low)
        desk.show(samples, known)
    desk.learn(40)
    assert max(map(abs, desk.timeline.theta)) <= 1 << (WIDTH - 1)
    assert any(desk.timeline.theta)


def test_every_sum_fits_whatever_the_words_are(digit: Board) -> None:
    """Every sum is of words of the memory, all of which are at an end of their range here."""
    program, rng = digit.program, np.random.default_rng(1)
    ends = np.array([-(1 << (WIDTH - 1)), (1 << (WIDTH - 1)) - 1])
    memory = rng.choice(ends, (1 << program.places.addr_width, 500))
    largest = max(
        int(np.abs(done.total).max())
        for start in program.starts
        for done in program.run(start, memory, 0, 0)
    )
    # The bound is near what is reached.
    assert 1 << (program.acc_width - 3) < largest < 1 << (program.acc_width - 1) <= 1 << 37


def test_places_do_not_overlap() -> None:
    for sensors, outputs, scratch in ((1, 1, 9), (2, 3, 40), (4, 4, 62), (9, 2, 100)):
        places = Places(sensors, outputs, scratch, 7)
        quarter = 1 << (places.addr_width - 2)
        incoming = [
            *range(places.samples, places.samples + (1 << places.sample_width)),
            *range(places.targets, places.targets + (1 << places.target_width)),
        ]
        assert len(set(incoming)) == len(incoming)
        assert scratch <= min(incoming)
        assert max(incoming) < quarter
        assert not places.samples % (1 << places.sample_width)
        assert not places.targets % (1 << places.target_width)
        banks = {
            places.mapped(places.theta + k, bank, 0)
            for k in range(places.unknowns)
            for bank in (0, 1)
        }
        assert len(banks) == 2 * places.unknowns
        assert min(banks) >= quarter
        assert max(banks) < 2 * quarter
        kept = {
            places.mapped(places.placement + k, 0, number)
            for k in range(sensors + outputs)
            for number in range(1 << places.number_width)
        }
        assert len(kept) == (sensors + outputs) << places.number_width
        assert (min(kept), max(kept) < 4 * quarter) == (2 * quarter, True)


def test_the_digit_learns_from_20_placements_within_a_second(digit: Board) -> None:
    assert (1 << digit.program.places.number_width) - 1 >= 20
    # 400 passes at 64 MHz.
    assert 400 * 20 * sum(digit.equation_clocks) < 64_000_000


@pytest.mark.pages
def test_the_page_has_the_figures_of_the_program(digit: Board) -> None:
    page, program = section("learning", "As a program of an engine"), digit.program
    frame, keep, *equations = program.lengths
    assert f"| frame | {frame} |" in page
    assert f"| keep | {keep} |" in page
    assert f"| equations | {', '.join(map(str, equations))} |" in page
    *most, last = digit.equation_clocks
    assert f"{', '.join(map(str, most))} or {last} clocks" in page
    clocks = 400 * 20 * sum(digit.equation_clocks)
    assert f"take {clocks:,} clocks, {clocks / 64e3:.0f} ms" in page
    assert f"{len(program.table) + len(program.words):,} words with the table" in page
    assert f"{program.acc_width} bits" in page
    assert f"{(1 << program.places.number_width) - 1}\n  placements" in page
