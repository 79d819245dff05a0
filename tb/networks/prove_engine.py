"""Proved properties of engine, with a loaded and with a built-in program.

The proofs do not cover what the data paths compute. A program has no branches, so its clocks are
the same for every frame.
"""

from dataclasses import dataclass

from golden.engine.fields import get
from golden.engine.formats import SAMPLE_SHIFT
from golden.engine.graph import Kind
from golden.engine.replay import CLEAR, ONE_PLANE
from golden.engine.serial_program import BEFORE, LEAVES, NOTHING
from golden.engine.serial_program import ENDS as ENDS_FRAME
from golden.engine.tanh_table import ENDS
from tb.common.properties import Property
from tb.common.watch import busy_of, frames_computed, table

# These have built-in programs: one layer of tanh, and several layers with ReLU. That of the first
# case is loaded.
ALSO = ("rails-engine", "steep-engine")


def properties(twin):
    return loaded(twin) if twin.loaded else built_in(twin)


def loaded(twin):
    """The properties of an engine that takes images, whatever these hold."""
    return [
        Property(
            name="no half image",
            sentence="A frame starts, and is computed, only while the last image that came was "
            "whole and had the right check, and no byte of another has been taken since. So the "
            "program memory is never written from the start of a frame to its last output.",
            states=(
                "!(start || run) || u_image_loader_0.whole",
                "!(start || run) || !(halt || put || u_image_loader_0.accept)",
            ),
            helps=busy_of(twin),
            # The program in the memory and the check of an image may be anything.
            free=("word", "u_image_loader_0.check"),
            reached=("start",),
            refuted_by=(
                (r"(?s)(frame_guard u_frame_guard_0 .*?\.halt)\(halt\)", r"\1(1'b0)"),
                (r"\.busy\(busy\)", ".busy(1'b0)"),
                (r"accept \|\| \(!whole\)", "!whole"),
            ),
            clocks=18,
        ),
    ]


def built_in(twin, place="place"):
    """The properties of an engine with a known program, of which every clock is known too.

    ``place`` is a name that the hardware does not have.
    """
    program, inputs = twin.program, twin.inputs
    begins = program.pipeline.run
    steps = replayed_steps(twin) if twin.serial else stepped(twin)
    stores = [program.clock(n) for n in program.store_steps]
    # For each clock after the last sample: the operands that the memory holds by then.
    written = [
        inputs - (clock < 2) + sum(stored < clock for stored in stores)
        for clock in range(twin.busy + 2)
    ]
    outputs = " || ".join(f"since == {clock}" for clock in twin.output_clocks)
    watch = frames_computed(inputs, twin.busy, place) + steps.watch
    watch += """
        reg [15:0] operands = 0;
        always @(posedge clk) if (write) operands <= write_addr == 0 ? 1 : write_addr + 1;
        wire [15:0] held = held_at(since);
        wire [15:0] held_next = held_at(since + 1);
    """
    watch += table("held_at", written, 16)
    helps = (
        f"run == (since >= {begins}) && finish == (since == {twin.busy})",
        *(("start == (since == 1)", "u_frame_check_0.waiting == start") if begins > 1 else ()),
        f"since <= {twin.busy} && {place} < {inputs} && (since == 0 || {place} == 0)",
        "u_frame_check_0.dropping == skipping",
        f"since != 0 || u_frame_check_0.addr == ({place} == 0 ? {(1 << twin.addr_width) - 1} "
        f": {place} - 1)",
        *steps.helps,
    )
    common = {"watch": watch, "helps": helps}
    # With one input no number of operands is due before the sample is written.
    begun = "since < 2" if inputs == 1 else "since == 0"
    return [
        Property(
            name="outputs of good frames",
            sentence="Each good frame, and nothing else, yields outputs in the clocks "
            f"{', '.join(map(str, twin.output_clocks))} after its last sample, the last one with "
            "out_last. frame_error is high for one clock for each wrong frame, which yields no "
            "output.",
            states=(
                f"out_valid == ({outputs})",
                f"out_valid || since != {twin.busy}",
                f"!out_valid || out_last == (since == {twin.output_clocks[-1]})",
                "frame_error == told",
            ),
            reached=("since == 2",),
            refuted_by=(
                (r"out_valid <= leaves", "out_valid <= (leaves || start)"),
                (r"complete != in_last", "complete && !in_last"),
            ),
            clocks=inputs + 9,
            induction=5,
            **common,
        ),
        Property(
            name="program counter",
            sentence=steps.sentence,
            states=(
                f"!run || (fetched_from >= {steps.begin} "
                f"&& fetched_from < {steps.begin + len(program.words)})",
            ),
            reached=("since == 2",),
            refuted_by=steps.refuted_by,
            clocks=inputs + 9,
            induction=5,
            **common,
        ),
        Property(
            name="operands are there",
            sentence="No step reads an operand that has not been written for its frame: a sample, "
            "or the result of a step before.",
            states=(f"!run || {begun} || {steps.idle} || source < operands",),
            reached=("since == 2",),
            refuted_by=((r"write <= \(accept \|\| store\)", "write <= store"),),
            clocks=inputs + 9,
            induction=5,
            watch=watch,
            helps=(
                *helps,
                "since < 2 || (operands == held && write == (held_next != held))",
                "since == 0 || u_frame_check_0.addr + 1 == held_next",
                # A sample is written one clock after it is taken.
                f"since != 0 || {place} == 0 || write || operands == {place}",
                f"since != 0 || {place} == 0 || !write || write_addr == {place} - 1",
                f"since != 0 || {place} < 2 || !write || operands == {place} - 1",
                f"since != 1 || (write && write_addr == {inputs - 1})",
                *(() if inputs == 1 else (f"since != 1 || operands == {inputs - 1}",)),
            ),
        ),
    ]


@dataclass(frozen=True)
class Steps:
    """How a program is read.

    sentence: What the property of the counter says.
    begin: The first address of the program.
    watch: ``fetched_from`` is the address of the word that is there while ``run`` is high.
    idle: Whether the word that is there reads no operand.
    refuted_by: Broken copies, for the property of the counter.
    """

    sentence: str
    begin: int
    watch: str
    helps: tuple[str, ...]
    idle: str
    refuted_by: tuple[tuple[str, str], ...]


def stepped(twin):
    """The words are read one after the other."""
    program, late = twin.program, twin.program.pipeline.memory_registers
    at, memory = program.pipeline, "u_program_memory_0"
    begin, words = twin.program_memory.begin, len(program.words)
    # A word that is not the first one of the program.
    elsewhere = 0 if begin else words - 1

    def behind(clocks):
        """The address that is read so many clocks after the counter left the first one."""
        return f"(since > {clocks} ? {begin - clocks} + since : {begin})"

    watch = f"""
        reg [15:0] read_from, fetched_from;
        always @(posedge clk) begin
            read_from <= {memory}.counter;
            fetched_from <= {"read_from" if late else f"{memory}.counter"};
        end
    """
    helps = [
        f"{memory}.counter == {behind(at.run - 1)}",
        f"since < {at.run} || fetched_from == {behind(at.begin)}",
        f"since < {at.run} || word == {memory}.memory[fetched_from]",
    ]
    if late:
        helps += [
            f"since == 0 || read_from == {behind(at.run)}",
            f"since == 0 || {memory}.fetched == {memory}.memory[read_from]",
        ]
    return Steps(
        f"While a frame is computed, each step comes from one of the {words} words "
        "of the program, one after the other. After the last word there is no step.",
        begin,
        watch,
        tuple(helps),
        f"since < {at.begin} || since >= {at.begin + program.length}",
        ((rf"(if \(stands\) begin\s+counter <=) {begin}", rf"\1 {elsewhere}"),),
    )


def replayed_steps(twin):
    """The words are read pass by pass, and each pass of a plane knows its clocks."""
    program, memory = twin.program, twin.replay_memory
    begin, words, busy = memory.begin, len(program.words), twin.busy
    # Addresses are counted modulo the words of the memory.
    width = memory.addr_width
    one, span = f"{width}'d1", 1 << width
    # In the first clock nothing is computed yet.
    nothing = [0] * (busy + 1)
    places, planes, _ = memory.places([0] + [1] * busy, nothing, nothing)
    steps = program.instructions
    starts = [n for n, step in enumerate(steps) if step.first] + [words - 1]
    # For each word: the first word of its neuron, and of the next one.
    own = [begin + max(start for start in starts if start <= n) for n in range(words)]
    other = [(begin + min([s for s in starts if s > n] or [words])) % span for n in range(words)]
    told = {
        clock: get(memory.contents[place], BEFORE)
        for clock, (place, plane) in enumerate(zip(places, planes, strict=True))
        if clock and plane == CLEAR and get(memory.contents[place], BEFORE) != NOTHING
    }
    here, unit = "u_replay_memory_0", "serial_steps0"
    watch = f"""
        reg [{width - 1}:0] fetched_from;
        always @(posedge clk) fetched_from <= {here}.address;
        wire [15:0] word_of_program = fetched_from - {begin};
        wire [{width - 1}:0] own = own_start(word_of_program), other = next_start(word_of_program);
        wire [4:0] number = plane_at(since);
        wire [1:0] kind = {unit}_kind;
        function [1:0] told_at(input [15:0] n);
            case (n)
                {" ".join(f"{clock}: told_at = {value};" for clock, value in told.items())}
                default: told_at = {NOTHING};
            endcase
        endfunction
    """
    watch += table("place_at", places, width) + table("plane_at", planes, 5)
    watch += table("own_start", own, width) + table("next_start", other, width)
    return Steps(
        f"While a frame is computed, each step comes from one of the {words} words of the "
        "program, in the order of the passes. After the last word there is no step.",
        begin,
        watch,
        (
            "since == 0 || fetched_from == place_at(since)",
            f"since == 0 || {unit}_word == {here}.memory[fetched_from]",
            f"since == 0 || {here}.counter == fetched_from + {one}",
            f"since != 0 || ({here}.place == {1 << CLEAR} && {here}.sort == 3)",
            f"since != 0 || {here}.base == {begin}",
            f"{here}.second == {here}.base + {one}",
            f"since == 0 || {here}.place == 1 << number",
            f"since == 0 || {here}.sort == (number == {CLEAR} ? 3 : number == {ONE_PLANE} ? 1 "
            f": number < {SAMPLE_SHIFT} ? 2 : 0)",
            f"since == 0 || {here}.base == (number == 0 ? other : own)",
            f"since == 0 || number >= {ONE_PLANE} "
            f"|| ({here}.following == other && {here}.beside == other + {one})",
            f"{unit}_waits == (since == 0 ? 0 : told_at(since - 1))",
            f"{unit}_late == (since < 2 ? 0 : told_at(since - 2))",
            f"{unit}_later == (since < 3 ? 0 : told_at(since - 3))",
            f"store == (since > 3 && told_at(since - 4) != {NOTHING})",
            f"leaves == (since > 3 && told_at(since - 4) >= {LEAVES})",
            f"ends == (since > 3 && told_at(since - 4) == {ENDS_FRAME})",
        ),
        # An operand counts from the first plane on in which one of its bits can be set.
        f"(kind == {Kind.WORD} ? number == {CLEAR} || {unit}_weight == 0 "
        f": kind == {Kind.DISTANCE} ? number >= {max(ENDS)} "
        f": kind == {Kind.ONE} || number > {ONE_PLANE})",
        ((r"(if \(stands\) begin\s+base <=) \d+", r"\1 0"),),
    )
