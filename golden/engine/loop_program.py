"""The program of an engine with several multipliers as a loop, in which frames overlap."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from golden.engine.fields import get, put
from golden.engine.finish import word_of
from golden.engine.formats import SAMPLE_SHIFT
from golden.engine.function_table import codes_of
from golden.engine.graph import LOOKED_UP, Graph, Kind, Term
from golden.engine.lane_groups import reduction_steps
from golden.engine.lane_pipeline import LanePipeline
from golden.engine.lane_program import (
    JOINED,
    JOINED_OUTPUT,
    NO_SUM,
    OWN,
    LaneInstruction,
    LaneProgram,
    Layout,
    start_of,
)
from golden.engine.listing import operand_text
from golden.engine.loop_schedule import (
    EFFORT,
    LoopSchedule,
    least_length,
    loop_schedule,
    sends,
    shortest_loop,
    sizes_of,
)
from golden.engine.program import WORD_WIDTH, weight_of
from golden.engine.schedule import WAIT, Step
from golden.input_error import InputError
from golden.numbers.fixed import Codes

Field = tuple[int, int]


@dataclass(frozen=True)
class LoopLayout(Layout):
    """Where a word has its fields: for each its lowest bit and its number of bits.

    place_width, source_width, turn_width, gather_width: Bits of the fields that are as wide as the
        network needs.

    ``source`` is the address of the operand, and ``turn`` says how many loops ago it was stored.
    With ``copy`` a sample is stored. With ``late`` an output belongs to a frame that began a loop
    before the one whose first outputs leave in the same loop. ``wrap`` stands some words before the
    last one, see ``wrap_lead``.
    """

    place_width: int = field(kw_only=True)
    source_width: int = field(kw_only=True)
    turn_width: int = field(kw_only=True)
    gather_width: int = field(kw_only=True)

    @cached_property
    def _fields(self) -> dict[str, Field]:
        widths = {
            "place": self.place_width,
            "source": self.source_width,
            "turn": self.turn_width,
            "kind": 2,
            "opens": 2,
            "gather": self.gather_width,
        }
        flags = ("store", "copy", "together", "relu", "output", "end", "late", "wrap")
        found, low = {}, 0
        for name, width in (widths | dict.fromkeys(flags, 1)).items():
            found[name] = low, width
            low += width
        return found

    def __getitem__(self, name: str) -> Field:
        return self._fields[name]

    @property
    def width(self) -> int:
        """Bits of a word."""
        return sum(self["wrap"])


@dataclass(frozen=True)
class LoopProgram(LaneProgram):
    """The words of the loop, and what the lanes do with them for one frame.

    Samples and results are stored at addresses in the order of the words that store them, which
    start afresh with each loop. A memory holds the words of ``turns`` loops.
    """

    loop: LoopSchedule = field(kw_only=True)
    layout: LoopLayout = field(kw_only=True)

    @property
    def turns(self) -> int:
        """Of how many loops the operands are kept."""
        return 1 << self.layout.turn_width

    def field(self, name: str) -> Field:
        return self.layout[name]

    def clock(self, step: int) -> int:
        """The clock of a result where the loop begins with the frame's last sample."""
        return 1 + self.pipeline.memory_registers + step + self.pipeline.result

    @property
    def stages(self) -> int:
        """For how many loops a frame is computed; for two at least."""
        return max(2, self.last_stage + 1)

    @property
    def last_stage(self) -> int:
        """The loop, of those of a frame, in which its last output is marked."""
        return self._leaves[-1] // self.loop.length

    @property
    def first_stage(self) -> int:
        """The loop, of those of a frame, in which its first output is marked."""
        return self._leaves[0] // self.loop.length

    @property
    def _leaves(self) -> list[int]:
        return [self.loop.ends[n] + self.pipeline.mark for n in self.loop.leaving]

    def _at(self, time: int, name: str) -> int:
        return get(self.words[time % self.loop.length], self.layout[name])

    @cached_property
    def lane_steps(self) -> list[LaneInstruction]:
        at = self.pipeline
        assert isinstance(at, LanePipeline)
        found = []
        for t, step in enumerate(self._steps):
            if step.neuron < 0:
                found.append(LaneInstruction(*[0] * len(LaneInstruction.__dataclass_fields__)))
                continue
            marks = {
                name: self._at(t + at.mark, name) if step.last else 0
                for name in ("store", "together", "relu", "output", "end")
            }
            found.append(
                LaneInstruction(
                    place=self._at(t + at.place, "place"),
                    source=self._at(t, "source"),
                    kind=self._at(t + at.operand, "kind"),
                    opens=self._at(t + at.start, "opens"),
                    gather=self._at(t + at.gather, "gather"),
                    **marks,
                )
            )
        return found

    @cached_property
    def _steps(self) -> list[Step]:
        """What a frame does at each time."""
        loop = self.loop
        found = [WAIT] * (max(loop.ends) + 1)
        for n, (begin, end, terms) in enumerate(
            zip(loop.begins, loop.ends, loop.orders, strict=True)
        ):
            for t in range(begin, end + 1):
                k = t - begin
                term = terms[k] if k < len(terms) else Term(Kind.ONE, -1, 0)
                found[t] = Step(n, term, t == begin, t == end)
        return found

    def scheduled(self, graph: Graph) -> list[Step]:
        return self._steps

    def address(self, time: int) -> int:
        """The address at which the word at a time stores."""
        words = self.words[: time % self.loop.length]
        return sum(get(word, self.layout["store"]) for word in words)

    def stored(self, graph: Graph, samples: Codes) -> Iterator[tuple[int, bool, Codes, Codes]]:
        order = [step.neuron for step in self._steps if step.last]
        for number, (step, sums, words) in zip(order, self.lanes_run(samples), strict=True):
            for lane, neuron in enumerate(self.shared.groups[number].members):
                if neuron >= 0:
                    yield neuron, bool(step.relu), sums[lane], words[lane]

    def lanes_run(
        self, samples: Codes
    ) -> Iterator[tuple[LaneInstruction, list[Codes], list[Codes]]]:
        lanes, zero = range(self.lanes), np.zeros(len(samples), dtype=np.int64)
        length, mark = self.loop.length, self.pipeline.mark
        # Words by their address and by the loop that stores them, counted from that of the frame.
        memories: list[dict[tuple[int, int], Codes]] = [{} for _ in lanes]
        for k, time in enumerate(self.loop.copies):
            for memory in memories:
                memory[self.address(time), time // length] = samples[:, k] << SAMPLE_SHIFT
        sums = [zero for _ in lanes]
        for t, step in enumerate(self.lane_steps):
            if self._steps[t].neuron < 0:
                continue
            if step.gather:
                pairs = dict(reduction_steps(self.lanes)[step.gather.bit_length() - 1])
                added = [sums[pairs[j]] if j in pairs else zero for j in lanes]
            else:
                looks = step.kind in LOOKED_UP
                weights = (0,) * self.lanes if looks else self.weights[step.place]
                there = step.source, t // length - self._at(t, "turn")
                reads = step.kind != Kind.ONE and (step.kind != Kind.WORD or any(weights))
                read = [[memory[there]] if reads else [zero] for memory in memories]
                wanted = LaneInstruction(**{**vars(step), "source": 0})
                added = [self._product(wanted, read[j], weights[j], zero) for j in lanes]
            if step.opens:
                sums = [zero + start_of(step.opens, lane) for lane in lanes]
            sums = [total + value for total, value in zip(sums, added, strict=True)]
            if not self._steps[t].last:
                continue
            words = [word_of(total, step.relu, self.cut, self.even) for total in sums]
            if step.together:
                words = [words[0] for _ in lanes]
            if step.store:
                time = t + mark
                for memory, word in zip(memories, words, strict=True):
                    memory[self.address(time), time // length] = word
            yield step, sums, words


def wrap_lead(pipeline: LanePipeline) -> int:
    """How many words before its last one a loop says that it ends."""
    return 2 + pipeline.memory_registers


def assemble_loop(program: LaneProgram, graph: Graph, interval: int) -> LoopProgram:
    """The loop of ``interval`` words, or of a few less, that computes what a program computes."""
    pipeline, shared = program.pipeline, program.shared
    assert isinstance(pipeline, LanePipeline)
    lengths = range(interval, least_length(shared) - 1, -1)
    length = next((one for one in lengths if loop_schedule(shared, pipeline, one)), 0)
    loop = loop_schedule(shared, pipeline, length, EFFORT) if length else None
    if loop is None:
        least = shortest_loop(shared, pipeline, len(program.words))
        raise InputError(
            f"hardware.interval: got {interval}, expected {least.length if least else 'more'} "
            f"clocks or more: with lanes = {program.lanes} a frame has {sum(sizes_of(shared))} "
            "steps, and another one for each output that leaves later than it is computed"
        )
    made = _assembled(program, graph, loop)
    if made.layout.width > WORD_WIDTH:
        raise InputError(
            f"hardware.interval: got {interval}, for which a word of the program has "
            f"{made.layout.width} bits, expected {WORD_WIDTH} at most: give more clocks"
        )
    return made


def _assembled(program: LaneProgram, graph: Graph, loop: LoopSchedule) -> LoopProgram:
    pipeline, length, shared = program.pipeline, loop.length, loop.shared
    assert isinstance(pipeline, LanePipeline)
    mark, inputs = pipeline.mark, graph.inputs
    # The time of the word that stores each value.
    times = dict(enumerate(loop.copies))
    times |= {inputs + n: end + mark for n, end in enumerate(loop.ends[: loop.stored])}
    order = sorted(time % length for time in times.values())
    address = {source: order.index(time % length) for source, time in times.items()}
    ago = {
        (begin + k, term.source): (begin + k) // length - times[term.source] // length
        for begin, terms in zip(loop.begins, loop.orders, strict=True)
        for k, term in enumerate(terms)
        if term.source >= 0
    }
    places = max(len(shared.weights) - 1, 2 * program.blocks - 1 if program.blocks > 1 else 0)
    layout = LoopLayout(
        place_width=max(1, places.bit_length()),
        source_width=(len(times) - 1).bit_length(),
        turn_width=max(ago.values(), default=0).bit_length(),
        gather_width=len(reduction_steps(shared.lanes)),
    )
    words = [0] * length

    def write(time: int, **values: int) -> None:
        for name, value in values.items():
            put(words, time % length, layout[name], value)

    codes = codes_of(graph.functions)
    for n, (begin, end, terms) in enumerate(zip(loop.begins, loop.ends, loop.orders, strict=True)):
        neuron, group = shared.graph.neurons[n], shared.groups[n]
        opens = OWN if not group.joined else JOINED_OUTPUT if neuron.output else JOINED
        for t in range(begin, end + 1):
            k = t - begin
            term = terms[k] if k < len(terms) else Term(Kind.ONE, -1, 0)
            if term.source >= 0:
                write(t, source=address[term.source], turn=ago[t, term.source])
            write(t + pipeline.operand, kind=int(term.kind))
            write(t + pipeline.place, place=weight_of(term, codes))
            write(t + pipeline.start, opens=NO_SUM if k else opens)
            write(t + pipeline.gather, gather=1 << (k - len(terms)) if k >= len(terms) else 0)
        write(
            end + mark,
            store=not sends(group),
            together=group.joined,
            relu=neuron.relu,
            output=n in loop.leaving,
            end=n == loop.leaving[-1],
        )
    for time in loop.copies:
        write(time, store=1, copy=1, together=1)
    firsts = (loop.ends[loop.leaving[0]] + mark) // length
    for n in loop.leaving:
        time = loop.ends[n] + mark
        write(time, late=time // length > firsts)
    write(length - 1 - wrap_lead(pipeline), wrap=1)
    return LoopProgram(
        inputs,
        program.segment_width,
        program.table,
        tuple(words),
        pipeline,
        _notes(loop),
        program.rectifies,
        program.cut,
        program.even,
        program.blocks,
        shared=shared,
        loop=loop,
        layout=layout,
    )


def _notes(loop: LoopSchedule) -> tuple[str, ...]:
    """What the step in each word does."""
    graph, found = loop.shared.graph, ["wait"] * loop.length
    for begin, end, terms, neuron in zip(
        loop.begins, loop.ends, loop.orders, graph.neurons, strict=True
    ):
        for t in range(begin, end + 1):
            k = t - begin
            step = Step(0, terms[min(k, len(terms) - 1)])
            added = operand_text(graph, step) if k < len(terms) else "sums of lanes"
            done = ", done" if t == end else ""
            found[t % loop.length] = (
                f"{neuron.name} {'+' if k else '='} {added}{done}{_ago(t // loop.length)}"
            )
    return tuple(found)


def _ago(loops: int) -> str:
    """Of which frame a step is."""
    return f", {loops} loop{'s' * (loops > 1)} ago" if loops else ""
