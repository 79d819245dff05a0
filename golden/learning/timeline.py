"""What an engine that learns does in every clock: which frames, known outputs and steps it takes.

It is exact in clocks, but not in steps: a frame, a placement or an equation is computed as a whole,
in the first clock in which nothing can stop it any more.
"""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from golden.engine.formats import OUTPUT_SHIFT, SAMPLE_SHIFT, WORD
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
class Stream:
    """A stream whose frames have a number of elements: a frame of another length is broken.

    count: Elements of the frame so far.
    began, dropping: Whether a frame has begun, and whether the rest of it is dropped.
    raised: Whether the element of the clock before broke its frame.
    """

    count: int = 0
    began: bool = False
    dropping: bool = False
    raised: bool = False

    def take(self, valid: bool, last: bool, refused: bool, length: int) -> tuple[int, bool]:
        """The number of the element that is accepted, or -1; and whether its frame is complete.

        refused: Whether nothing is accepted, and a frame that has begun is broken.
        length: How many elements a frame has.
        """
        accept = valid and not refused and not self.dropping
        breaks = refused and (valid or self.began) and not self.dropping
        complete = self.count == length - 1
        wrong = accept and complete != last
        number, done = self.count if accept and not wrong else -1, accept and complete and last
        self.raised = breaks or wrong
        if valid:
            self.dropping = not last and (self.dropping or self.raised)
            self.began = not last
        elif breaks:
            self.dropping = True
        self.count = 0 if wrong or done or refused else self.count + accept
        return number, done


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
    bank, equation, shown, written: The bank of theta in use, the equation that is next, the
        placement to which it belongs, and the placement that is written next.
    full: Whether every place of a placement has been written.
    stepped: Whether any step has been taken.
    fresh: Whether the samples of the last frame are there, none of which was at an end of its
        range.
    clipped: Whether a sample of the frame so far was.
    putting, partly: Whether the last word that came in was one of theta, and whether more of them
        are to come.
    """

    program: LessonProgram
    met: Counter[str] = field(default_factory=Counter)

    def __post_init__(self) -> None:
        # Words that were never written are unlikely ones.
        self.memory = np.full((1 << self.program.places.addr_width, 1), WORD.low)
        self.reset()

    def reset(self) -> None:
        """Forget everything but the words of the memory."""
        self.bank = self.equation = self.shown = self.written = 0
        self.full = self.stepped = self.fresh = self.lost = self.refused = False
        self.putting = self.partly = self.clipped = False
        self.samples, self.targets = Stream(), Stream()
        self.frame, self.keep, self.study = Part(), Part(), Part()
        self.leaving: dict[int, int] = {}
        # The elements of theta that are still to be read, and the one that leaves.
        self.unread = range(0)
        self.told: int | None = None

    @property
    def theta(self) -> list[int]:
        """The words of theta in use."""
        places = self.program.places
        first = places.mapped(places.theta, self.bank, 0)
        return [int(word) for word in self.memory[first : first + places.unknowns, 0]]

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
        seen = (
            int(out is not None),
            out or 0,
            int(busy and t == self.frame.ends),
            int(self.samples.raised),
            int(ready),
            int(self.targets.raised or self.lost),
            int(self.refused),
            int(self.told is not None),
            self.told or 0,
        )
        arrives, taken = bool(valid) and not busy, bool(target) and ready
        quiet = not (studying or arrives or taken or self.unread or self.partly)
        idle = ready and quiet
        self.refused = self.lost = False
        if idle and learn and self.shown != self.written:
            self.study = self._part(t, EQUATIONS + self.equation)
        kept, passed = keeping and t == self.keep.ends, studying and t == self.study.ends
        self._tell(arrives, ended=busy and t == self.frame.ends)
        if kept and self.putting:
            # Theta that came in is the one in use from now on.
            self.met["theta put in"] += 1
            self.bank, self.stepped = 1 - self.bank, True
        if kept and not self.putting:
            self._keep()
        elif passed:
            self._step()
        elif self.shown == self.written:
            self.shown = self._next(self.shown) if self.full else 0
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
        ended = busy and t == self.frame.ends and not self.clipped
        self.fresh = (self.fresh or ended) and not arrives
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
        number, done = self.targets.take(taken, last, refused, length)
        self.met["targets refused"] += self.targets.raised
        if number >= 0 and self.putting:
            self._write(places.theta + number, code << OUTPUT_SHIFT, 1 - self.bank)
        elif number >= 0:
            self.memory[places.targets + number] = code << SAMPLE_SHIFT
        if done:
            self.keep = self._part(t, KEEP)

    def _take_samples(self, t: int, valid: bool, code: int, last: bool, busy: bool) -> None:
        # A frame that comes too early is broken at once. One that began before is complete.
        sensors = self.program.places.sensors
        number, done = self.samples.take(valid, last, busy and valid, sensors)
        self.met["frames refused"] += self.samples.raised
        if number >= 0:
            self.memory[self.program.places.samples + number] = code << SAMPLE_SHIFT
            self.clipped = (self.clipped and number > 0) or code in (SIGNAL.low, SIGNAL.high)
        if not done:
            return
        self.met["frames"] += 1
        self.met["clipped frames"] += self.clipped
        self.met["corrected frames"] += any(self.theta) and self.stepped
        self.frame = self._part(t, FRAME)
        leaves = iter(self.program.output_clocks)
        # Until a step has been taken, a frame clears the bank in use, and after that the other one.
        cleared = 1 - self.bank if self.stepped else self.bank
        for slot, word, _ in self.program.run(FRAME, self.memory, self.bank, 0):
            self._write(slot.store, word, cleared)
            if slot.leaves:
                self.leaving[t + next(leaves)] = int(word[0]) >> OUTPUT_SHIFT

    def _write(self, address: int, word: Codes | int, bank: int) -> None:
        self.memory[self.program.places.mapped(address, bank, self.written)] = word

    def _tell(self, arrives: bool, ended: bool) -> None:
        """Behind a frame theta leaves, element by element, until a sample comes."""
        self.told = self.theta[self.unread[0]] >> OUTPUT_SHIFT if self.unread else None
        if ended:
            self.unread = range(self.program.places.unknowns)
        else:
            self.unread = range(0) if arrives else self.unread[1:]

    def _keep(self) -> None:
        """Keep a placement, with which learning goes on."""
        self.met["placements"] += 1
        for slot, word, _ in self.program.run(KEEP, self.memory, self.bank, 0):
            self._write(slot.store, word, self.bank)
        self.shown, self.equation = self.written, 0
        self.written = self._next(self.written)
        self.full = self.full or not self.written

    def _next(self, number: int) -> int:
        return (number + 1) % (1 << self.program.places.number_width)

    def _step(self) -> None:
        """An equation, and the step that follows from it, unless it leaves the format of theta."""
        places, fits = self.program.places, True
        part = EQUATIONS + self.equation
        for slot, word, held in self.program.run(part, self.memory, self.bank, self.shown):
            self._write(slot.store, word, 1 - self.bank)
            fits = fits and (held or not places.of_theta(slot.store))
        self.refused = not fits
        self.met["steps refused" if self.refused else "steps taken"] += 1
        if fits:
            self.bank, self.stepped = 1 - self.bank, True
        self.equation = (self.equation + 1) % places.outputs
        if not self.equation:
            self.shown = self._next(self.shown)
