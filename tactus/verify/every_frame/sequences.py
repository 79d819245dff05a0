"""The theorem: what is shown of hardware and network, for frames in any sequence.

Every claim is a run of the hardware in which data are symbols or unknown. Unknown stands for every
value, so what is shown with it holds whatever a register held before.
"""

import sys
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import reduce
from itertools import count
from typing import Any

from tactus.verify.every_frame.bits import Bits, X, abstract, agreed
from tactus.verify.every_frame.netlist import Netlist
from tactus.verify.every_frame.network import Network
from tactus.verify.every_frame.sums import Space, UnsupportedError, Value
from tactus.verify.every_frame.unrolled import State, Unrolled
from tactus.verify.every_frame.values import Values

# The inputs or the outputs of a clock.
Clock = dict[str, Bits]
# Rounds in which the state between frames must have settled.
ROUNDS = 30
IDLE: Clock = {"in_valid": 0}
# Clocks behind a sample in which it is written, and the most states between two samples.
WRITTEN, STATES = 2, 150
# Idle clocks that are tried where no number of them can be shown to change nothing.
TRIED = 8


class RefusedError(Exception):
    """What cannot be shown, with the reason; it is not known to be wrong."""


class WrongError(Exception):
    """Control that is wrong, whatever the samples are."""


@dataclass
class DiffersError(Exception):
    """An output that is not what the network says: its number, its clock, and both values."""

    output: int
    clock: int
    got: Value
    expected: Value


def before(given: dict[str, Any]) -> list[dict[str, int]]:
    """The inputs of the clocks between reset and frames: each stream, and clocks for its work."""
    found: list[dict[str, int]] = []
    for stream in given["before"]:
        name, last = stream["name"], len(stream["data"]) - 1
        found += [
            {f"{name}_valid": 1, f"{name}_data": v, f"{name}_last": int(k == last)}
            | stream.get("beside", {})
            for k, v in enumerate(stream["data"])
        ]
        found += [{}] * stream["clocks"]
    return found


class Sequences:
    def __init__(
        self,
        hardware: Netlist,
        description: dict[str, Any],
        clock: Callable[[int], None] = lambda _: None,
    ):
        sys.setrecursionlimit(1 << 20)
        self.given, self.network = description, Network(description)
        self.run = Unrolled(hardware)
        self.sizes = [net.width for net in self.run.held]
        self.told = clock
        self.bits: int = description["bits"]
        self.count: int = description["samples"]
        self.words = description["stream"] == "words"
        self.clocks: list[int] = description["output_clocks"]
        self.still = dict.fromkeys(description["still"], 0)
        self.space = Space()
        top = 1 << self.bits - 1
        self.symbols = [self.run.sample(f"x{k}", self.bits) for k in range(self.count)]
        self.samples = [self.space.sample(f"x{k}", -top, top - 1) for k in range(self.count)]
        self.values = Values(self.space, {f"x{k}": v for k, v in enumerate(self.samples)})
        # Every word of the network, and those of the outputs, once they are needed.
        self.inner: list[Value] = []
        self.expected: list[Value] | None = None

    # Driving.

    def _frame(self, data: Sequence[Bits]) -> list[Clock]:
        """The inputs of the clocks of a frame; slots behind its samples hold nothing."""
        if self.words:
            return [{"in_valid": 1, **{f"in_data_{k}": v for k, v in enumerate(data)}}]
        elements = [*data, *[X] * (self.given["elements"] - self.count)]
        last = len(elements) - 1
        return [
            {"in_valid": 1, "in_data": v, "in_last": int(k == last)} for k, v in enumerate(elements)
        ]

    def _clock(self, inputs: Clock) -> None:
        """A clock with these inputs. Of the others nothing is known, but for those that stay 0."""
        others = dict.fromkeys(self.run.hardware.inputs, X)
        self.run.step({**others, "clk": 0, "rst": 0, **self.still, **inputs})

    def _outputs(self) -> Clock:
        return {name: self.run.out(name) for name in self.run.hardware.outputs}

    def _play(self, inputs: Sequence[Clock]) -> list[Clock]:
        """The outputs of these clocks; control must be known in each."""
        found = []
        for one in inputs:
            self._clock(one)
            found.append(out := self._outputs())
            needed = ["out_valid", "frame_error", *["out_last"] * (out["out_valid"] == 1)]
            for name in needed:
                if not isinstance(out.get(name, 0), int):
                    raise RefusedError(
                        f"{name} is not known in clock {self.run.clocks}: it hangs on data, or "
                        "on what nothing has set"
                    )
            self.run.clock()
            self.told(self.run.clocks)
        return found

    # Checking.

    def _check(self, found: list[Clock], ended: Sequence[int] = (), watched: int = 0) -> None:
        """The outputs of frames whose last elements came in these clocks; `watched` has the
        symbols."""
        due: dict[int, list[tuple[int, int]]] = defaultdict(list)
        for number, clock in enumerate(ended):
            for k, after in enumerate(self.clocks):
                due[clock + after].append((number, k))
        for clock, out in enumerate(found):
            if out.get("frame_error", 0):
                raise WrongError(f"frame_error in clock {clock} of good frames")
            valid, expected = out["out_valid"], int(clock in due)
            if valid != expected:
                raise WrongError(f"out_valid is {valid} in clock {clock}, expected {expected}")
            for number, k in due.get(clock, ()):
                if "out_last" in out and out["out_last"] != int(k == len(self.clocks) - 1):
                    raise WrongError(f"out_last is {out['out_last']} at output {k}")
                if number == watched:
                    self._compare(k, clock - ended[number], out)

    def _compare(self, k: int, clock: int, out: Clock) -> None:
        bits = out[f"out_data_{k}" if self.words else "out_data"]
        if self.expected is None:
            self.inner = self.network.words(self.space, self.samples)
            self.expected = self.network.outputs(self.inner)
        try:
            got = self.values.number(bits, self.bits, True)
        except UnsupportedError as reason:
            raise RefusedError(f"output {k}: {reason}, {getattr(reason, 'place', '')}") from None
        if got - self.expected[k] != 0:
            raise DiffersError(k, clock, got, self.expected[k])

    # States.

    def _joined(self, a: State, b: Iterable[Bits]) -> State:
        """What two states have in common; the rest is unknown."""
        return [agreed(*one) for one in zip(a, b, self.sizes, strict=True)]

    def _after(self, state: State, inputs: Sequence[Clock]) -> tuple[State, list[Clock]]:
        """The state behind these clocks, with X for what hangs on samples, and the outputs."""
        self.run.restore(state)
        found = self._play(inputs)
        return self.run.abstracted(), found

    # The claims.

    def prove(self) -> Iterator[tuple[str, bool]]:
        """The claims in their order; an error where one fails."""
        run, distance = self.run, self.given["interval"]
        self._clock({"rst": 1, **dict.fromkeys(self.still, X)})
        run.clock()
        reset, begins = run.state(), [{**IDLE, **one} for one in before(self.given)]
        self._play(begins)
        state = run.abstracted()
        tail, ends = max(self.clocks) + 1, self.given["elements"] - 1
        pause = [IDLE] * max(tail - 1, distance - self.given["elements"])
        for _ in range(ROUNDS):
            idle, nothing = self._after(state, [IDLE])
            self._check(nothing)
            behind, found = self._after(state, [*self._frame(self.symbols), *pause])
            following = [idle, behind]
            if "load_valid" in self.still:
                # What the memory holds of another image is not known.
                following.append(self._after(self._joined(reset, state), begins)[0])
            # What all of them have in common stands for each.
            earlier, state = state, reduce(self._joined, following, state)
            if state == earlier:
                break
        else:
            raise RefusedError(
                f"the state between frames has not settled after {ROUNDS} rounds: something "
                "counts frames or idle clocks"
            )
        self._check(found, [ends])
        known = "after one clock of reset, control is known in every clock"
        yield f"{known}, and no bit of data reaches it", True
        yield "no value that a register or a memory held before reaches an output", True
        shown = [*dict.fromkeys(self.clocks)]
        listed = ", ".join(map(str, shown)) if len(shown) < 5 else f"{shown[0]} to {shown[-1]}"
        yield f"the outputs are those of the network, {listed} clocks after the last sample", True
        text = f"{len(pause) + 1} clocks after a last sample, and after an idle clock,"
        yield f"{text} control is where it was, so this holds for any number of frames", True
        if not self.words and self.count > 1:
            if self._any_gaps(state, pause):
                yield "any number of idle clocks between samples changes nothing", True
            else:
                tried = f"(1 to {TRIED} were tried, at each place and at all)"
                yield f"idle clocks between samples change nothing {tried}", False
        if distance < ends + tail:
            if distance == 1:
                self._alone(state)
            else:
                self._close(state, tail, ends)
            text = f"frames {distance if distance > 1 else 'any number of'} clocks apart"
            yield f"{text} do not disturb each other, in any number", True

    def _any_gaps(self, start: State, pause: list[Clock]) -> bool:
        """Whether any gaps give the outputs; else some are tried."""
        run, (*frame, last) = self.run, self._frame(self.symbols)
        for exact in (WRITTEN, STATES):
            with suppress(RefusedError):
                states = [start]
                for inputs in frame:
                    states = self._idle(states, inputs, exact)
                for state in states:
                    run.restore(state)
                    self._check(self._play([last, *pause]), [0])
                return True
        many = len(frame)
        plans = [[g * (j == k) for j in range(many)] for k in range(many) for g in (1, TRIED)]
        for gaps in [*plans, *([g] * many for g in range(1, TRIED + 1))]:
            run.restore(start)
            spaced = [i for f, g in zip(frame, gaps, strict=True) for i in (f, *[IDLE] * g)]
            self._check(self._play([*spaced, last, *pause]), [len(spaced)])
        return False

    def _idle(self, states: list[State], inputs: Clock, exact: int) -> list[State]:
        """The states that these inputs lead to with idle clocks behind them. Behind so many, what
        any numbers of them have in common stands for each."""
        found: list[State] = []
        for state in states:
            self.run.restore(state)
            self._check(self._play([inputs]))
            for gap in count():
                state = self.run.state()
                if state in found:
                    break
                # A joined state has the one before it within.
                found[len(found) - (gap > exact) :] = [state]
                if len(found) > STATES:
                    raise RefusedError("too many states")
                self._check(self._play([IDLE]))
                if gap >= exact:
                    self.run.restore(self._joined(state, self.run.state()))
        return found

    def _alone(self, start: State) -> None:
        """A frame in one clock, or an idle one. Before it and behind it stands in each clock what
        frames of unknown samples and idle clocks have in common, so neither matters."""
        run, either = self.run, [*self._frame([X] * self.count), IDLE]

        def after(state: State, inputs: list[Clock]) -> tuple[State, list[Any]]:
            """What the states have in common that these inputs lead to, and the outputs."""
            states, found = [], []
            for one in inputs:
                run.restore(state)
                self._clock(one)
                found.append(self._outputs())
                run.clock()
                states.append(run.state())
            return reduce(self._joined, states), found

        always: State | None = None
        while always != start:
            always, start = start, self._joined(start, map(abstract, after(start, either)[0]))
        for inputs in (*self._frame(self.symbols), IDLE):
            state, found = after(start, [inputs])
            seen = [found]
            for _ in range(max(self.clocks)):
                state, found = after(state, either)
                seen.append(found)
            for k, clock in enumerate(self.clocks):
                for out in seen[clock]:
                    if out["out_valid"] != inputs["in_valid"] or out.get("frame_error", 0) != 0:
                        raise RefusedError(f"out_valid hangs on frames {clock} clocks away")
                    if inputs["in_valid"]:
                        self._compare(k, clock, out)

    def _close(self, start: State, tail: int, ends: int) -> None:
        """Frames as close as they may be: what the others hold is unknown, so it does not
        matter."""
        interval, around = self.given["interval"], -(-(ends + tail) // self.given["interval"])
        nothing, pause = self._frame([X] * self.count), [IDLE] * (interval - self.given["elements"])
        seen: list[State] = []
        while start not in seen:
            if len(seen) > ROUNDS + around:
                raise RefusedError("close frames do not come to a state that repeats")
            frames = [self._frame(self.symbols), *[nothing] * around]
            inputs = [one for frame in frames for one in (*frame, *pause)]
            _, found = self._after(start, [*inputs, *[IDLE] * tail])
            ended = [n * interval + ends for n in range(-len(seen), len(frames))]
            self._check(found, ended, len(seen))
            seen.append(start)
            start, _ = self._after(start, [*nothing, *pause])
