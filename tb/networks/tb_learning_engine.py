"""learning_engine, an engine that learns gains and offsets of its sensors, against its twin.

Sweeps: all recorded frames of the scene; frames of random samples; known outputs that the networks
would nearly give, random ones, and those at the ends of their range; more placements than are kept;
frames and known outputs that are too short or too long, and known outputs without a frame before.
Drives: frames as close as the design takes them, closer, and so far apart that equations fit
between them; samples with gaps, which stop equations; known outputs behind a frame, late, with
gaps, and interrupted by the next frame; a mode that is switched on and off; resets at random
clocks.
Checks: every output port in every clock, and every output of a frame bit for bit, in the twin's
timeline, which executes the words of the program. So outputs show which steps were taken before
the frame, and which were not. The bench also measures the clocks of a frame.
Does not prove: how much of a drift the rule takes away (docs/learning.md).
"""

from dataclasses import dataclass, field

import cocotb
import numpy as np

from golden.learning.timeline import INPUTS, OUTPUTS, Timeline
from golden.precision import SIGNAL
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.framing import random_lengths
from tb.common.network import random_elements, recorded_frames
from tb.common.small import LESSONS
from tb.common.stimulus import random_resets

CASES = LESSONS
FAULTS = [
    (r"bank <= \(!bank\)", "bank <= 1"),
    (r"\(frame_run && \(!stepped\)\)", "1'b0"),
    (r"lesson_control0_passed && \(!bad\)", "lesson_control0_passed"),
    (r"\(arrives \|\| \(!fresh\)\)", "arrives"),
    (r"arrives && keep_busy && \(!finish\)", "arrives && keep_busy"),
    (r"written == \d+", "written == 0"),
    (r"if \(\(stops \|\| ", "if ((1'b0 || "),
    (r"\{second\[17\], ", "{1'b0, "),
    (r"spoiled <= 1'b1", "spoiled <= 1'b0"),
    (r"jump <= \(", "jump <= !("),
]


@dataclass
class Words:
    """Words that are sent one after the other, each from a clock on, and held until it is taken.

    Attributes
    ----------
    rows : list of tuples of int
        The clocks to wait before a word, the word, and whether it is the last of its frame.
    """

    rows: list[tuple[int, int, int]] = field(default_factory=list)
    waited: int = 0

    def offered(self, rng):
        """The valid, data and last of this clock. Data without valid is random."""
        if self.rows and self.waited >= self.rows[0][0]:
            return 1, *self.rows[0][1:]
        self.waited += 1
        return 0, int(rng.integers(SIGNAL.low, SIGNAL.high + 1)), int(rng.integers(0, 2))

    def taken(self):
        self.rows.pop(0)
        self.waited = 0


class Player:
    """Makes a timeline with the twin beside it, which says when a known output is taken."""

    def __init__(self, bench):
        self.bench, self.rng = bench, bench.rng
        self.twin = bench.twin
        self.timeline = Timeline(self.twin.program)
        self.rows = []

    def play(self, samples, targets, learn=1, clocks=0, resets=()):
        """Send words until all are sent, and for so many clocks at least."""
        samples, targets = Words(samples), Words(targets)
        for n in range(1_000_000):
            if n >= clocks and not samples.rows and not targets.rows:
                break
            valid, data, last = samples.offered(self.rng)
            offered = targets.offered(self.rng)
            row = (valid, data, last, *offered, learn, int(n in resets))
            seen = self.timeline.clock(len(self.rows), *row)
            self.rows.append(row)
            if valid:
                samples.taken()
            if offered[0] and seen[OUTPUTS.index("target_ready")]:
                targets.taken()

    def frame(self, codes, before=0, gap=0):
        """The words of a frame, with clocks before it and before each other sample."""
        return [
            (before if k == 0 else gap, int(code), int(k == len(codes) - 1))
            for k, code in enumerate(codes)
        ]

    async def check(self, *met, at_least=1, frames=0):
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
            if name != "out_data":
                bench.compare(name, recording.unsigned(name, rows), expected[name], clock=rows)
        left = np.flatnonzero(expected["out_valid"])
        got = recording.signed("out_data", rows[left])
        bench.compare("out_data", got, expected["out_data"][left], clock=left)
        if frames:
            entered = rows[(inputs["in_valid"] & inputs["in_last"]) == 1]
            assert len(entered) == frames, "a frame was refused"
            first, final = entered[0] - self.twin.inputs + 1, recording.rows("out_last")[0]
            bench.facts = {
                "frames": frames,
                "seconds": recording.seconds,
                "clocks_per_frame": int(final - first + 1),
                "interval": int(np.diff(entered).min()),
            }
        for name in met:
            assert timeline.met[name], f"{name}: none, expected some; {dict(timeline.met)}"
        assert len(left) >= at_least, f"got {len(left)} outputs, expected {at_least}"
        bench.finish(at_least=at_least)
        return timeline


def near(twin, rng, frame, off):
    """Known outputs near those that the networks give."""
    outputs = twin.process(frame[np.newaxis])[0]
    return np.clip(outputs + rng.integers(-off, off + 1, len(outputs)), SIGNAL.low, SIGNAL.high)


@cocotb.test()
async def recorded(dut):
    """Play the recorded frames as close as the design takes them, which leaves none to learn."""
    bench = Bench(dut)
    player, codes = Player(bench), recorded_frames(bench)
    for frame in codes:
        player.play(player.frame(frame, before=player.twin.interval - len(frame)), [])
    player.play([], [], clocks=player.twin.interval)
    await player.check("frames", at_least=len(codes) * player.twin.outputs, frames=len(codes))


@cocotb.test()
async def lessons(dut):
    """Keep placements, learn from them between frames, and watch the outputs change."""
    bench = Bench(dut)
    player, twin, rng = Player(bench), bench.twin, bench.rng
    longest = twin.longest_equation
    for frame in bench.given.codes[: min(3, twin.placements)]:
        player.play(player.frame(frame), [], learn=0, clocks=twin.interval)
        player.play([], player.frame(near(twin, rng, frame, 2000), gap=1), learn=0, clocks=60)
    for n in range(40):
        frame = bench.given.codes[n] if n < 3 else random_elements(player.bench, twin.inputs)
        # Frames as close as they may be, with room for a few equations, and slow ones, whose
        # samples stop equations.
        room = (0, int(rng.integers(1, 2 * longest)), 4 * longest)[n % 3]
        gap = int(rng.integers(0, longest)) if n % 5 == 4 else 0
        player.play(player.frame(frame, before=room, gap=gap), [], clocks=twin.interval + room)
    await player.check(
        "corrected frames", "equations stopped", "steps taken", at_least=30 * twin.outputs
    )


@cocotb.test()
async def steps_refused(dut):
    """Show what no gain and no offset gives, until a step would leave the range."""
    bench = Bench(dut)
    player, twin = Player(bench), bench.twin
    for frame in bench.given.codes[:1]:
        ends = SIGNAL.low, SIGNAL.high
        target = np.array([ends[int(output < 0)] for output in twin.process(frame)])
        player.play(player.frame(frame), [], learn=0, clocks=twin.interval)
        player.play([], player.frame(target), learn=0, clocks=60)
    for _ in range(12):
        frame = random_elements(bench, twin.inputs)
        player.play(player.frame(frame, before=12 * twin.longest_equation), [])
    player.play([], [], clocks=twin.interval)
    await player.check("steps refused", "steps taken", "corrected frames", at_least=12)


@cocotb.test()
async def more_placements_than_are_kept(dut):
    """Keep more placements than there is room for, and learn from those that are left."""
    bench = Bench(dut)
    player, twin, rng = Player(bench), bench.twin, bench.rng
    for _ in range(twin.placements + 4):
        frame = random_elements(player.bench, twin.inputs)
        player.play(player.frame(frame), [], learn=0, clocks=twin.interval)
        player.play([], player.frame(near(twin, rng, frame, 500)), learn=0, clocks=50)
    player.play([], [], clocks=(twin.placements + 2) * sum(twin.equation_clocks))
    # With every place taken, placements come while equations run.
    for _ in range(3):
        frame = random_elements(player.bench, twin.inputs)
        player.play(player.frame(frame), [], clocks=twin.interval)
        player.play([], player.frame(near(twin, rng, frame, 500), before=200), clocks=700)
    player.play(player.frame(random_elements(player.bench, twin.inputs)), [], clocks=twin.interval)
    timeline = await player.check("corrected frames", at_least=twin.placements)
    assert timeline.full, "the places were not all taken"
    assert timeline.met["placements"] > 1 << twin.program.places.number_width


def traffic(player, count, resets=False):
    """Frames and known outputs of any length at any time."""
    twin, rng = player.twin, player.rng
    longest = twin.longest_equation

    def stream(length, most):
        words = []
        last = random_lengths(rng, length, count * length)
        pause = np.roll(last, 1) * rng.integers(0, most + 1, len(last))
        for ends, before in zip(last.tolist(), pause.tolist(), strict=True):
            wait = before if before else int(rng.integers(0, 3) * (rng.random() < 0.2))
            words.append((wait, int(random_elements(player.bench, 1)[0]), ends))
        return words

    samples = stream(twin.inputs, twin.interval + 3 * longest)
    targets = stream(twin.outputs, twin.interval + longest)
    clocks = 8 * (twin.interval + longest)
    at = np.flatnonzero(random_resets(rng, 60 * clocks, every=clocks)) if resets else ()
    player.play(samples, targets, resets=set(map(int, at)))
    player.play([], [], clocks=twin.interval)


@cocotb.test()
async def any_traffic(dut):
    """Play frames and known outputs of all lengths at any time, while it learns."""
    player = Player(Bench(dut))
    twin, rng = player.twin, player.rng
    traffic(player, 50)
    # A frame that comes at each clock around those in which a placement is kept.
    for clocks in range(twin.program.lengths[1] + 2 * twin.program.pipeline.result):
        first, second = (
            random_elements(player.bench, twin.inputs),
            random_elements(player.bench, twin.inputs),
        )
        player.play(player.frame(first), [], clocks=twin.interval)
        player.play(
            player.frame(second, before=clocks),
            player.frame(random_elements(player.bench, twin.outputs)),
        )
        player.play([], [], clocks=int(rng.integers(twin.interval, 2 * twin.interval)))
    await player.check(
        *("frames refused", "targets refused", "placements", "equations stopped", "steps taken"),
        *("placements lost", "corrected frames"),
        at_least=20,
    )


@cocotb.test()
async def resets(dut):
    """Play the same with resets at any time. Each brings back what was shipped."""
    player = Player(Bench(dut))
    traffic(player, 80, resets=True)
    await player.check("placements", "steps taken", at_least=20)
