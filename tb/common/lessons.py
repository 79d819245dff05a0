"""Plays frames and known outputs to an engine that learns, in the timeline of its twin."""

from collections.abc import Container
from dataclasses import dataclass, field

import numpy as np

from golden.learning.timeline import INPUTS, OUTPUTS, Timeline
from golden.networks.learning_engine import LearningEngine
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.framing import random_lengths
from tb.common.network import random_elements
from tb.common.stimulus import random_resets

# How often theta is put at its ends, until a step would leave them.
TRIES = 50


@dataclass
class Words:
    """Words that are sent one after the other, each from a clock on, and held until it is taken.

    rows: The clocks to wait before a word, the word, whether it is the last of its frame, and other
        bits that come with it.
    bits: How many bits come with each word.
    """

    rows: list[tuple[int, ...]] = field(default_factory=list)
    bits: int = 1
    waited: int = 0

    def offered(self, rng: np.random.Generator) -> tuple[int, ...]:
        """The valid, data and bits of this clock. Without valid they are random."""
        if self.rows and self.waited >= self.rows[0][0]:
            return 1, *self.rows[0][1:]
        self.waited += 1
        bits = rng.integers(0, 2, self.bits).tolist()
        return 0, int(rng.integers(SIGNAL.low, SIGNAL.high + 1)), *bits

    def taken(self) -> None:
        self.rows.pop(0)
        self.waited = 0


class Player:
    """Makes a timeline with the twin beside it, which says when a known output is taken."""

    def __init__(self, bench: Bench) -> None:
        self.bench, self.rng = bench, bench.rng
        self.twin = bench.twin
        self.timeline = Timeline(self.twin.program)
        self.rows: list[tuple[int, ...]] = []

    def play(
        self,
        samples: list[tuple[int, int, int]],
        targets: list[tuple[int, int, int]] | list[tuple[int, int, int, int]],
        learn: int = 1,
        clocks: int = 0,
        resets: Container[int] = (),
        theta: bool = False,
    ) -> None:
        """Send words until all are sent, and for so many clocks at least.

        A target may have a bit behind it that says whether it is theta. Of those without one
        ``theta`` says so of all.
        """
        bits = [row if len(row) == 4 else (*row, int(theta)) for row in targets]
        sent, known = Words(samples), Words(list(bits), bits=2)
        for n in range(1_000_000):
            if n >= clocks and not sent.rows and not known.rows:
                break
            came, offered = sent.offered(self.rng), known.offered(self.rng)
            row = (*came, *offered, learn, int(n in resets))
            seen = self.timeline.clock(len(self.rows), *row)
            self.rows.append(row)
            if came[0]:
                sent.taken()
            if offered[0] and seen[OUTPUTS.index("target_ready")]:
                known.taken()

    def frame(self, codes: Codes, before: int = 0, gap: int = 0) -> list[tuple[int, int, int]]:
        """The words of a frame, with clocks before it and before each other sample."""
        return [
            (before if k == 0 else gap, int(code), int(k == len(codes) - 1))
            for k, code in enumerate(codes)
        ]

    async def check(self, *met: str, at_least: int = 1, frames: int = 0) -> Timeline:
        """Play the timeline, and compare every port with the twin in every clock.

        With a number of frames, as close as the design takes them, their clocks are measured.
        """
        bench = self.bench
        drive = dict(zip(INPUTS, np.array(self.rows).T, strict=True))
        recording = await bench.play(drive, list(OUTPUTS))
        rows = np.arange(RESET_CLOCKS, recording.clocks)
        signed = {"in_data", "target_data"}
        inputs = {
            name: (recording.signed if name in signed else recording.unsigned)(name, rows)
            for name in INPUTS
        }
        timeline = Timeline(self.twin.program)
        expected = timeline.play(inputs)
        for name in OUTPUTS:
            if not name.endswith("_data"):
                bench.compare(name, recording.unsigned(name, rows), expected[name], clock=rows)
        for stream in ("theta", "out"):
            left = np.flatnonzero(expected[f"{stream}_valid"])
            name = f"{stream}_data"
            got = recording.signed(name, rows[left])
            bench.compare(name, got, expected[name][left], clock=left)
        if frames:
            entered = rows[(inputs["in_valid"] & inputs["in_last"]) == 1]
            assert len(entered) == frames, "a frame was refused"
            first, final = entered[0] - self.twin.inputs + 1, recording.rows("out_last")[0]
            bench.measured(recording, frames, first, final, entered)
        for name in met:
            assert timeline.met[name], f"{name}: none, expected some; {dict(timeline.met)}"
        assert len(left) >= at_least, f"got {len(left)} outputs, expected {at_least}"
        bench.finish(at_least=at_least)
        return timeline


def near(twin: LearningEngine, rng: np.random.Generator, frame: Codes, off: int) -> Codes:
    """Known outputs near those that the networks give."""
    outputs = twin.process(frame[np.newaxis])[0]
    return np.clip(outputs + rng.integers(-off, off + 1, len(outputs)), SIGNAL.low, SIGNAL.high)


def refusals(player: Player) -> None:
    """Show what no gain and no offset gives, until a step would leave the range."""
    bench, twin = player.bench, player.twin
    for frame in bench.given.codes[:1]:
        ends = SIGNAL.low, SIGNAL.high
        target = np.array([ends[int(output < 0)] for output in twin.process(frame)])
        player.play(player.frame(frame), [], learn=0, clocks=twin.interval)
        player.play([], player.frame(target), learn=0, clocks=60)
    for _ in range(12):
        frame = random_elements(bench, twin.inputs)
        player.play(player.frame(frame, before=12 * twin.longest_equation), [])
    # Where nodes saturate, nothing moves theta that far. Then it is put at its ends.
    for _ in range(TRIES):
        if player.timeline.met["steps refused"]:
            break
        for count, theta in ((twin.program.places.unknowns, True), (twin.outputs, False)):
            frame = random_elements(bench, twin.inputs)
            player.play(player.frame(frame), [], learn=0, clocks=twin.interval)
            words = player.frame(bench.rng.choice([SIGNAL.low, SIGNAL.high], count))
            player.play([], words, learn=0, theta=theta, clocks=60)
        player.play([], [], clocks=4 * twin.longest_equation)
    player.play([], [], clocks=twin.interval)


def mixed(
    rng: np.random.Generator, known: list[tuple[int, int, int]], theta: list[tuple[int, int, int]]
) -> list[tuple[int, int, int, int]]:
    """Frames of known outputs and of theta in random order, with a bit that says which it is."""
    frames: list[list[tuple[int, int, int, int]]] = []
    for of_theta, words in enumerate((known, theta)):
        frames.append([])
        for word in words:
            frames[-1].append((*word, of_theta))
            if word[2]:
                frames.append([])
    return [word for n in rng.permutation(len(frames)) for word in frames[n]]


def traffic(player: Player, count: int, resets: bool = False) -> None:
    """Frames, known outputs and theta of any length at any time."""
    twin, rng = player.twin, player.rng
    longest = twin.longest_equation

    def stream(frames: int, length: int, most: int) -> list[tuple[int, int, int]]:
        words = []
        last = random_lengths(rng, length, frames * length)
        pause = np.roll(last, 1) * rng.integers(0, most + 1, len(last))
        for ends, before in zip(last.tolist(), pause.tolist(), strict=True):
            wait = before if before else int(rng.integers(0, 3) * (rng.random() < 0.2))
            words.append((wait, int(random_elements(player.bench, 1)[0]), ends))
        return words

    samples = stream(count, twin.inputs, twin.interval + 3 * longest)
    unknowns, most = twin.program.places.unknowns, twin.interval + longest
    targets = mixed(rng, stream(count, twin.outputs, most), stream(count // 2, unknowns, most))
    clocks = 8 * (twin.interval + longest)
    at = np.flatnonzero(random_resets(rng, 60 * clocks, every=clocks)) if resets else ()
    player.play(samples, targets, resets=set(map(int, at)))
    player.play([], [], clocks=twin.interval)
