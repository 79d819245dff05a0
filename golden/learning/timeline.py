"""What an engine that learns does in every clock: which frames, known outputs and steps it takes.

It is exact in clocks, but not in steps: a frame, a placement or an equation is computed as a whole,
in the first clock in which nothing can stop it any more. Only the clocks of the parts are those of
the program; what they compute is the rule (``golden.learning.gradient``). So a bench compares the
program that the hardware executes with the rule.
"""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from golden.engine.frame_check import Stream
from golden.learning.program import EQUATIONS, FRAME, KEEP, PIPELINE, LessonProgram
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL

INPUTS = (
    "in_valid",
    "in_data",
    "in_last",
    "target_valid",
    "target_data",
    "target_last",
    "target_theta",
    "learn",
    "rst",
)
OUTPUTS = (
    "out_valid",
    "out_data",
    "out_last",
    "frame_error",
    "target_ready",
    "target_error",
    "learn_error",
    "theta_valid",
    "theta_data",
)


@dataclass
class Part:
    """A part of the program that runs: from the clock before its first step to its last result."""

    opens: int = -1
    ends: int = -1

    def at(self, t: int) -> bool:
        """Whether it runs in a clock."""
        return self.opens <= t <= self.ends


@dataclass
class Timeline:
    """An engine that learns, clock by clock from a reset on.

    met: How often each thing happened, for a bench that must show that it did.

    pupil: What it has learned, and the placement and the output that are next.
    last_frame, targets: Codes of the last frame, and of the words that came in behind it.
    rests: Whether the sequencer passes over the placement that is written next.
    fresh: Whether the samples of the last frame are there, none of which was at an end of its
        range.
    clipped: Whether a sample of the frame so far was.
    putting, partly: Whether the last word that came in was one of theta, and whether more of them
        are to come.
    """

    program: LessonProgram
    met: Counter[str] = field(default_factory=Counter)

    def __post_init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        places = self.program.places
        self.pupil = self.program.pupil()
        self.last_frame: Codes = np.zeros(places.sensors, dtype=np.int64)
        self.targets: Codes = np.zeros(max(places.outputs, places.unknowns), dtype=np.int64)
        self.rests = self.fresh = self.lost = self.refused = False
        self.putting = self.partly = self.clipped = False
        self.samples, self.known = Stream(), Stream()
        self.frame, self.keep, self.study = Part(), Part(), Part()
        self.leaving: dict[int, int] = {}
        # The elements of theta that are still to be read, and the one that leaves.
        self.unread = range(0)
        self.told: int | None = None

    def play(self, columns: Mapping[str, Codes]) -> dict[str, Codes]:
        """The outputs in each clock, by the names of the ports, from the inputs in each clock.

        ``out_data`` is 0 where no output leaves, and ``theta_data`` where no element of theta does.
        """
        clocks = zip(*(np.asarray(columns[name]).tolist() for name in INPUTS), strict=True)
        found = [self.clock(t, *row) for t, row in enumerate(clocks)]
        return dict(zip(OUTPUTS, np.array(found).T, strict=True))

    def clock(
        self,
        t: int,
        valid: int,
        data: int,
        last: int,
        target: int,
        known: int,
        last_known: int,
        of_theta: int,
        learn: int,
        reset: int,
    ) -> tuple[int, ...]:
        """The outputs in a clock, from the inputs in that clock, both in their order."""
        busy, keeping, studying = (one.at(t) for one in (self.frame, self.keep, self.study))
        ready = not (busy or keeping)
        out = self.leaving.pop(t, None)
        ends = busy and t == self.frame.ends
        seen = (
            int(out is not None),
            out or 0,
            int(ends),
            int(self.samples.raised),
            int(ready),
            int(self.known.raised or self.lost),
            int(self.refused),
            int(self.told is not None),
            self.told or 0,
        )
        arrives, taken = bool(valid) and not busy, bool(target) and ready
        quiet = not (studying or arrives or taken or self.unread or self.partly)
        if ready and quiet and learn and self.pupil.placements and not self.rests:
            self.study = self._part(t, EQUATIONS + self.pupil.output)
        kept, passed = keeping and t == self.keep.ends, studying and t == self.study.ends
        self.refused = self.lost = self.rests = False
        self._tell(arrives, ends)
        if kept and self.putting:
            # Theta that came in is the one in use from now on.
            self.met["theta put in"] += 1
            self.pupil.put(self.targets[: self.program.places.unknowns])
        elif kept:
            self.met["placements"] += 1
            outputs = self.targets[: self.program.places.outputs]
            self.pupil.keep(self.last_frame.copy(), outputs.copy())
        elif passed:
            # The step that follows from an equation, unless it leaves the format of theta.
            self.refused = not self.pupil.step()
            self.met["steps refused" if self.refused else "steps taken"] += 1
            self.rests = self.pupil.begins
        if studying and not passed and (arrives or taken):
            self.met["equations stopped"] += 1
            self.study = Part()
        if keeping and not kept and arrives:
            self.met["placements lost"] += 1
            self.keep, self.lost = Part(), True
        if taken:
            self.putting, self.partly = bool(of_theta), bool(of_theta and not last_known)
        elif arrives:
            self.partly = False
        self._take_targets(t, taken, known, bool(last_known), arrives, keeping)
        self._take_samples(t, bool(valid), data, bool(last), busy)
        self.fresh = (self.fresh or (ends and not self.clipped)) and not arrives
        if reset:
            self.reset()
        return seen

    def _part(self, t: int, number: int) -> Part:
        """A part that is decided on in a clock."""
        length = self.program.lengths[number]
        return Part(t + 1, t + PIPELINE.run + length - 1 + PIPELINE.result)

    def _take_targets(
        self, t: int, taken: bool, code: int, last: bool, arrives: bool, keeping: bool
    ) -> None:
        refused = (not self.fresh or arrives) and not keeping
        places = self.program.places
        length = places.unknowns if self.putting else places.outputs
        number, done = self.known.take(taken, last, refused, length)
        self.met["targets refused"] += self.known.raised
        if 0 <= number < length:
            self.targets[number] = code
        if done:
            self.keep = self._part(t, KEEP)

    def _take_samples(self, t: int, valid: bool, code: int, last: bool, busy: bool) -> None:
        # A frame that comes too early is broken at once. One that began before is complete.
        sensors = self.program.places.sensors
        number, done = self.samples.take(valid, last, busy and valid, sensors)
        self.met["frames refused"] += self.samples.raised
        if number >= 0:
            self.last_frame[number] = code
            self.clipped = (self.clipped and number > 0) or code in (SIGNAL.low, SIGNAL.high)
        if not done:
            return
        self.met["frames"] += 1
        self.met["clipped frames"] += self.clipped
        self.met["corrected frames"] += bool(self.pupil.theta.any())
        self.frame = self._part(t, FRAME)
        outputs = self.pupil.process(self.last_frame[np.newaxis])[0].tolist()
        clocks = (t + clock for clock in self.program.output_clocks)
        self.leaving |= zip(clocks, outputs, strict=True)

    def _tell(self, arrives: bool, ended: bool) -> None:
        """Behind a frame theta leaves, element by element, until a sample comes."""
        self.told = int(self.pupil.codes[self.unread[0]]) if self.unread else None
        if ended:
            self.unread = range(self.program.places.unknowns)
        else:
            self.unread = range(0) if arrives else self.unread[1:]
