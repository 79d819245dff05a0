"""Proved properties of engine, with a loaded and with a built-in program.

The proofs do not cover what the data paths compute. A program has no branches, so its clocks are
the same for every frame.
"""

from dataclasses import dataclass

from tb.common.properties import Property
from tb.common.watch import busy_of, frames_computed, table
from tb.networks.engine_parts_proof import lane_accumulate, lane_round, operand_memory

# The first case has a layer of tanh on one lane. Then come several layers with ReLU; tanh on three
# lanes, and ReLU on eight without a table; quantised networks, and registers behind the memories;
# and programs that are loaded, into one lane and into several.
ALSO = (
    *("steep-engine", "rails-lanes", "relu-lanes", "exact-lanes", "floor-lanes", "deep-engine"),
    *("rails-reload", "rails-lanes-reload"),
)


def properties(twin):
    if twin.loaded:
        return [*loaded(twin), placed(twin)]
    return built_in(twin, stepped(twin))


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


def built_in(twin, steps, place="samples"):
    """The properties of an engine with a known program, of which every clock is known too.

    ``steps`` says how the program is read, and ``place`` is a name that the hardware does not have.
    """
    program, inputs = twin.program, twin.inputs
    begins = program.pipeline.run
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
    at, begin, words = program.pipeline, program.begin * twin.alone, len(program.words)
    # A single lane has a memory of its own kind, in which every other word is one of the program.
    here, place = ("lane_alone0_", 2) if twin.alone else ("u_program_memory_0.", 1)
    own = "lane_alone0_" * twin.alone
    # A word that is not the first one of the program.
    elsewhere = 0 if begin else words - 1

    def behind(clocks):
        """The address that is read so many clocks after the counter left the first one."""
        return f"(since > {clocks} ? {begin - clocks} + since : {begin})"

    watch = f"""
        reg [15:0] read_from, fetched_from;
        always @(posedge clk) begin
            read_from <= {here}counter;
            fetched_from <= {"read_from" if late else f"{here}counter"};
        end
    """
    helps = [
        f"{here}counter == {behind(at.run - 1)}",
        f"since < {at.run} || fetched_from == {behind(at.begin)}",
        f"since < {at.run} || word == {here}memory[{place} * fetched_from]",
    ]
    if late:
        helps += [
            f"since == 0 || read_from == {behind(at.run)}",
            f"since == 0 || {here}fetched == {here}memory[{place} * read_from]",
        ]
    return Steps(
        f"While a frame is computed, each step comes from one of the {words} words "
        "of the program, one after the other. After the last word there is no step.",
        begin,
        watch,
        tuple(helps),
        f"since < {at.begin} || since >= {at.begin + program.length}",
        ((rf"(if \({own}stands\) begin\s+{own}counter <=) {begin}", rf"\1 {elsewhere}"),),
    )


def placed(twin):
    """Where the words of an image go."""
    sizes, lanes = twin.loaded.sizes, range(twin.lanes)
    table, columns = sizes.table_words, sizes.columns
    own = [f"behind && column == {1 + lane // 2}" for lane in lanes]
    high = [f"put_word[{18 * (lane % 2) + 17}:{18 * (lane % 2)}]" for lane in lanes]
    return Property(
        name="words where they belong",
        sentence=f"The first {table} words of an image are written to the tables of every lane. "
        f"Behind them are rows of {columns} words: the first is that of the program, and in each "
        "further one there are the weights of two lanes, at the place of the row.",
        states=(
            "put_program == (put && behind && column == 0)",
            *(f"lane_put_{n} == (put && (!behind || ({own[n]})))" for n in lanes),
            f"!behind || (row == number && lane_addr == {sizes.program_words} + number)",
            "behind || lane_addr == put_addr",
            *(f"lane_word_{n} == {high[n]}" for n in lanes),
        ),
        watch=f"""
            wire [31:0] address = put_addr;
            wire behind = address >= {table};
            wire [31:0] number = (address - {table}) / {columns};
            wire [31:0] column = (address - {table}) % {columns};
        """,
        assumes={
            "No address is beyond those that an image may have, which image_loader proves.": (
                f"put_addr < {sizes.words}"
            )
        },
        free=("put", "put_addr", "put_word"),
        reached=("put_program && row == 3", "put && !behind"),
        refuted_by=(
            (r"put_addr\[\d+-1:\d+\] - 1\)", "put_addr[10:9])"),
            (r"lane_put_0 = .*;", "lane_put_0 = put;"),
            *[(r"lane_word_1 = .*;", "lane_word_1 = put_word[17:0];")] * (twin.lanes > 1),
        ),
        clocks=2,
    )


PARTS = {
    "lane_accumulate": lane_accumulate,
    "lane_round": lane_round,
    "operand_memory": operand_memory,
}
