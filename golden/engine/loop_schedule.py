"""Puts the steps of an engine's lanes into a loop in which frames overlap: modulo scheduling.

The loop has as many words as there are clocks from frame to frame. A step at time t of a frame
stands in word t mod this length, and is executed in the t div this length-th loop after the one in
which the frame begins. So the loop executes steps of several frames, one after the other.

The steps of a group follow each other without a wait, because a lane has one sum. They take a run
of words that no other group has, whatever its frame is. As results depend on their own frame alone,
a group that finds no room soon enough may come a loop later. Each placement keeps gaps that are
large enough for all groups that are not placed yet.

Outputs leave in their order, and none of a frame before those of the frame before. Where they would
be further apart than a loop is long, the first ones or all of them are kept, and a step of its own
sends each later.
"""

import random
from bisect import bisect_left, insort
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

from golden.engine.formats import DROPPED
from golden.engine.graph import Graph, Kind, Neuron, Term
from golden.engine.lane_groups import Group, LaneGraph, reduction_steps
from golden.engine.lane_pipeline import LanePipeline

# The control of a loop looks so many words ahead.
LEAST = 5
# Assumed delays, in clocks, of a sample's store when stores of other frames occupy its slot.
MARGINS = (0, 1, 2, 4, 8, 16, 32)
# About how many steps are placed in all the orders that are tried for a loop that will be built.
EFFORT = 1500


@dataclass(frozen=True)
class LoopSchedule:
    """When the groups of a frame are computed, from the first word of the loop it begins in.

    length: Words of the loop: clocks from frame to frame.
    shared: The groups. Behind those that are stored stand those that send an output that was kept.
    begins: For each group the time of its first step.
    orders: For each group its terms, in the order of its steps.
    copies: For each sample the time of the word that stores it.
    leaving: The groups whose results leave, in the order of the outputs.
    """

    length: int
    shared: LaneGraph
    begins: tuple[int, ...]
    orders: tuple[tuple[Term, ...], ...]
    copies: tuple[int, ...]
    leaving: tuple[int, ...]

    @property
    def stored(self) -> int:
        """How many groups are stored."""
        return len(self.begins) - sum(map(sends, self.shared.groups))

    @property
    def ends(self) -> tuple[int, ...]:
        """For each group the time of its last step."""
        sizes = sizes_of(self.shared)
        return tuple(begin + size - 1 for begin, size in zip(self.begins, sizes, strict=True))


def sends(group: Group) -> bool:
    """Whether a group sends an output that was kept."""
    return not group.members


def sizes_of(shared: LaneGraph) -> list[int]:
    """The steps of each group, with those that add up the sums of lanes."""
    added = len(reduction_steps(shared.lanes))
    return [
        len(neuron.terms) + added * group.joined
        for neuron, group in zip(shared.graph.neurons, shared.groups, strict=True)
    ]


def least_length(shared: LaneGraph) -> int:
    """No loop is shorter: it has all steps, and in each clock a lane stores or sends one word."""
    return max(LEAST, sum(sizes_of(shared)), shared.graph.inputs + len(shared.groups))


def shortest_loop(shared: LaneGraph, pipeline: LanePipeline, most: int) -> LoopSchedule | None:
    """The shortest loop that is found, if any is shorter than ``most``."""
    lengths = range(least_length(shared), most)
    found = (loop_schedule(shared, pipeline, length) for length in lengths)
    return next((loop for loop in found if loop), None)


def loop_schedule(
    shared: LaneGraph, pipeline: LanePipeline, length: int, effort: int = 0
) -> LoopSchedule | None:
    """The schedule in which the last output leaves soonest, of those that are tried.

    None if the groups do not fit into a loop of this length. With ``effort``, orders of about so
    many steps are tried beside the first two.
    """
    outputs = shared.graph.outputs
    counts = sorted({0, outputs - 1, outputs})
    kept = [sending_later(shared, count) for count in counts]
    found = [
        loop
        for groups in kept
        if least_length(groups) <= length
        for order in _orders(groups, pipeline, effort)
        if (loop := _in_time(groups, pipeline, length, order))
    ]
    return min(found, key=lambda loop: loop.ends[loop.leaving[-1]], default=None)


def sending_later(shared: LaneGraph, count: int) -> LaneGraph:
    """The groups, with one more for each of the first outputs, which sends the kept result."""
    if not count:
        return shared
    graph = shared.graph
    early = [n for n, neuron in enumerate(graph.neurons) if neuron.output][:count]
    one = (1 << DROPPED, *[0] * (shared.lanes - 1))
    weights = shared.weights if one in shared.weights else (*shared.weights, one)
    place = weights.index(one)
    more = tuple(
        Neuron(
            f"{graph.neurons[n].name} leaves",
            graph.neurons[n].result,
            (Term(Kind.WORD, graph.inputs + n, place),),
        )
        for n in early
    )
    whole = replace(graph, neurons=graph.neurons + more)
    return LaneGraph(shared.lanes, whole, shared.groups + (Group(()),) * len(more), weights)


# Groups in the order in which they choose their words; None for that in which they are ready.
Order = Sequence[int] | None


def _orders(shared: LaneGraph, pipeline: LanePipeline, effort: int) -> Iterator[Order]:
    """The orders that are tried: by the clocks that depend on a group, by these about, and none."""
    sizes = sizes_of(shared)
    urgency = _urgency(shared.graph, sizes, pipeline.result_ready)
    yield None
    yield urgency
    drawn = random.Random(0)
    for _ in range(effort // sum(sizes)):
        most = max(urgency) * drawn.random()
        yield [clocks + int(most * drawn.random()) for clocks in urgency]


def _urgency(graph: Graph, sizes: Sequence[int], late: int) -> list[int]:
    """The clocks from a group's first step to the end of what depends on it."""
    behind: list[list[int]] = [[] for _ in sizes]
    for n, neuron in enumerate(graph.neurons):
        for term in neuron.terms:
            if term.source >= graph.inputs:
                behind[term.source - graph.inputs].append(n)
    urgency = [0] * len(sizes)
    for n in reversed(range(len(sizes))):
        urgency[n] = sizes[n] + max((urgency[m] + late - 1 for m in behind[n]), default=0)
    return urgency


def _in_time(
    shared: LaneGraph, pipeline: LanePipeline, length: int, order: Order
) -> LoopSchedule | None:
    """The schedule that reads samples as soon as they can be stored."""
    for margin in MARGINS:
        placing = _Placing(shared, pipeline, length, margin)
        loop = placing.placed(order)
        if loop:
            copies = _copies(loop, pipeline)
            if copies:
                return replace(loop, copies=copies)
    return None


def _copies(loop: LoopSchedule, pipeline: LanePipeline) -> tuple[int, ...]:
    """When each sample is stored, in their order; empty if some would be too late."""
    inputs, length = loop.shared.graph.inputs, loop.length
    # Then a frame that comes may take the place of the one before the last.
    latest = [length - inputs + k for k in range(inputs)]
    for begin, terms in zip(loop.begins, loop.orders, strict=True):
        for k, term in enumerate(terms):
            if 0 <= term.source < inputs:
                time = begin + k - pipeline.result_ready + pipeline.mark
                latest[term.source] = min(latest[term.source], time)
    # A sum that leaves goes through the registers of what is stored, even if it is not stored.
    taken = {(end + pipeline.mark) % length for end in loop.ends}
    found: list[int] = []
    for k in range(inputs):
        # The last sample is there one clock after the loop begins.
        time = max(found[-1] + 1 if found else 0, int(k == inputs - 1))
        while time in taken:
            time += 1
        if time > latest[k]:
            return ()
        found.append(time)
    return tuple(found)


@dataclass
class _Placing:
    """Places groups, one after the other, with samples that are late by ``margin`` clocks."""

    shared: LaneGraph
    pipeline: LanePipeline
    length: int
    margin: int

    def __post_init__(self) -> None:
        graph, late = self.shared.graph, self.pipeline.result_ready - self.pipeline.mark
        self.sizes = sizes_of(self.shared)
        self.ring = _Ring(self.length, self.sizes)
        self.terms = [neuron.terms for neuron in graph.neurons]
        self.begins = [0] * len(self.sizes)
        self.ready = {k: k + self.margin + late for k in range(graph.inputs)} | {-1: 0}
        self.ready[graph.inputs - 1] += graph.inputs == 1 and not self.margin
        self.outputs = [n for n, neuron in enumerate(graph.neurons) if neuron.output]
        self.later = [n for n, group in enumerate(self.shared.groups) if sends(group)]

    def placed(self, order: Order) -> LoopSchedule | None:
        """The schedule, without the copies of samples, if the groups find room in an order."""
        graph = self.shared.graph
        pending = [n for n in range(len(self.sizes)) if n not in self.later]
        outputs = list(self.outputs)
        urgency = order or _urgency(graph, self.sizes, self.pipeline.result_ready)
        while pending:
            able = [
                n
                for n in pending
                if not (n in outputs and n != outputs[0])
                and all(term.source in self.ready for term in graph.neurons[n].terms)
            ]
            n = min(able, key=lambda n: (0 if order else self._soonest(n), -urgency[n], n))
            if not self._place(n):
                return None
            pending.remove(n)
            if n in outputs:
                outputs.remove(n)
        leaving = self._leaving()
        if not leaving:
            return None
        orders = tuple(map(tuple, self.terms))
        return LoopSchedule(self.length, self.shared, tuple(self.begins), orders, (), leaving)

    def _end(self, n: int) -> int:
        return self.begins[n] + self.sizes[n] - 1

    def _soonest(self, n: int) -> int:
        """The first time at which a group can begin: all its terms follow each other."""
        times = sorted(self.ready[term.source] for term in self.terms[n])
        clock = max(0, *(time - k for k, time in enumerate(times)))
        before = self.outputs.index(n) if n in self.outputs else 0
        if before and not self.later:
            return max(clock, self._end(self.outputs[before - 1]) + 2 - self.sizes[n])
        return clock

    def _place(self, n: int) -> bool:
        begin = next(self.ring.places(self._soonest(n), self.sizes[n]), -1)
        if begin < 0:
            return False
        self.ring.take(begin, self.sizes[n])
        self.begins[n] = begin
        self.terms[n] = tuple(sorted(self.terms[n], key=lambda term: self.ready[term.source]))
        self.ready[self.shared.graph.inputs + n] = self._end(n) + self.pipeline.result_ready
        return True

    def _leaving(self) -> tuple[int, ...]:
        """The groups whose results leave, when those that were kept have got their times.

        There are none if they cannot leave within as many clocks as a loop has.
        """
        final = self._end(self.outputs[-1])
        direct = self.outputs[len(self.later) :]
        if not self.later:
            return tuple(direct) if final - self._end(self.outputs[0]) < self.length else ()
        ready = [self.ready[term.source] for n in self.later for term in self.terms[n]]
        lasts = [final] if direct else range(max(ready), max(ready) + 2 * self.length)
        for last in lasts:
            if direct or self.ring.is_free(last):
                times = self._before(last, ready if direct else ready[:-1])
                if times is not None:
                    for n, time in zip(self.later, [*times, last], strict=False):
                        self.begins[n] = time
                    return (*self.later, *direct)
        return ()

    def _before(self, last: int, ready: Sequence[int]) -> list[int] | None:
        """Times before that of the last output, as late as may be, each when its word is ready."""
        found: list[int] = []
        for soonest in reversed(ready):
            least = max(soonest, last - self.length + 1)
            until = found[0] if found else last
            free = (t for t in range(until - 1, least - 1, -1) if self.ring.is_free(t))
            time = next(free, None)
            if time is None:
                return None
            found.insert(0, time)
        return found


@dataclass
class _Ring:
    """The words of a loop that are still free, and the groups that are still to come.

    ``gaps`` are the runs of free words: for the first word of each the number of words.
    """

    length: int
    sizes: Sequence[int]
    gaps: dict[int, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.coming = sorted(self.sizes)

    def places(self, soonest: int, size: int) -> Iterator[int]:
        """The times at which a group leaves room for those to come, the first one first."""
        if not self.gaps:
            yield soonest
            return
        left = list(self.coming)
        left.remove(size)
        choices = sorted(
            ((first + before - soonest) % self.length, first, before)
            for first, free in self.gaps.items()
            for before in range(free - size + 1)
        )
        for clocks, first, before in choices:
            rest = [free for other, free in self.gaps.items() if other != first]
            if _room(left, [*rest, before, self.gaps[first] - size - before]):
                yield soonest + clocks

    def take(self, begin: int, size: int) -> None:
        """Give words that are free to a group."""
        self.coming.remove(size)
        word = begin % self.length
        first, free = self._run(begin) if self.gaps else (word, self.length)
        before = (word - first) % self.length
        self.gaps.pop(first, None)
        behind = (word + size) % self.length
        self.gaps |= {first: before} if before else {}
        self.gaps |= {behind: free - size - before} if free > size + before else {}

    def is_free(self, time: int) -> bool:
        return self._run(time)[1] > 0

    def _run(self, time: int) -> tuple[int, int]:
        """The run of free words in which a time lies; one of no words if it lies in none."""
        word = time % self.length
        runs = self.gaps.items()
        return next((run for run in runs if (word - run[0]) % self.length < run[1]), (word, 0))


def _room(sizes: Sequence[int], runs: list[int]) -> bool:
    """Whether groups find room in runs of free words: the largest first, where it is narrowest."""
    left = sorted(runs)
    for size in reversed(sizes):
        at = bisect_left(left, size)
        if at == len(left):
            return False
        insort(left, left.pop(at) - size)
    return True
