"""Proved properties of engine, with a loaded and with a built-in program.

The proofs do not cover what the data paths compute. A program has no branches, so its clocks are
the same for every frame.
"""

from tb.sign_off.properties import Property
from tb.sign_off.watch import frames_computed, table

# These have built-in programs: one layer of tanh, and several layers with ReLU. That of the first
# case is loaded.
ALSO = ("rails-engine", "steep-engine")


def properties(twin):
    return loaded() if twin.loaded else built_in(twin)


def loaded():
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
            helps=("busy == run",),
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
    at = program.pipeline
    begin, words = twin.program_memory.begin, len(program.words)
    # A word that is not the first one of the program.
    elsewhere = 0 if begin else words - 1
    stores = [n + at.mark for n in program.store_steps]
    # For each clock after the last sample: the operands that the memory holds by then.
    written = [
        inputs - (clock < 2) + sum(n + 4 <= clock for n in stores) for clock in range(twin.busy + 2)
    ]
    outputs = " || ".join(f"since == {clock}" for clock in twin.output_clocks)
    watch = frames_computed(inputs, twin.busy, place)
    watch += """
        reg [15:0] fetched_from;
        reg [15:0] operands = 0;
        always @(posedge clk) begin
            fetched_from <= u_program_memory_0.counter;
            if (write) operands <= write_addr == 0 ? 1 : write_addr + 1;
        end
        wire [15:0] held = held_at(since);
        wire [15:0] held_next = held_at(since + 1);
    """
    watch += table("held_at", written, 16)
    helps = (
        "run == (since != 0)",
        f"since <= {twin.busy} && {place} < {inputs} && (since == 0 || {place} == 0)",
        "u_frame_check_0.dropping == skipping",
        f"u_program_memory_0.counter == {begin} + since",
        f"since == 0 || fetched_from == {begin - 1} + since",
        "since == 0 || word == u_program_memory_0.memory[fetched_from]",
        f"since != 0 || u_frame_check_0.addr == ({place} == 0 ? {(1 << twin.addr_width) - 1} "
        f": {place} - 1)",
    )
    common = {"watch": watch, "helps": helps}
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
            sentence=f"While a frame is computed, each step comes from one of the {words} words "
            "of the program, one after the other. After the last word there is no step.",
            states=(
                f"!run || since == 0 || (fetched_from >= {begin} "
                f"&& fetched_from < {begin + words})",
            ),
            reached=("since == 2",),
            refuted_by=((rf"(if \(stands\) begin\s+counter <=) {begin}", rf"\1 {elsewhere}"),),
            clocks=inputs + 9,
            induction=5,
            **common,
        ),
        Property(
            name="operands are there",
            sentence="No step reads an operand that has not been written for its frame: a sample, "
            "or the result of a step before.",
            states=(f"!run || since == 0 || since > {program.length} || source < operands",),
            reached=("since == 2",),
            refuted_by=((r"write <= \(accept \|\| store\)", "write <= store"),),
            clocks=inputs + 9,
            induction=5,
            watch=watch,
            helps=(
                *helps,
                "since < 2 || operands == held",
                "since == 0 || u_frame_check_0.addr + 1 == held_next",
                # A sample is written one clock after it is taken.
                f"since != 0 || {place} == 0 || write || operands == {place}",
                f"since != 0 || {place} == 0 || !write || write_addr == {place} - 1",
                f"since != 0 || {place} < 2 || !write || operands == {place} - 1",
                f"since != 1 || (write && write_addr == {inputs - 1} && operands == {inputs - 1})",
            ),
        ),
    ]
