"""Proved properties of lanes: frames, outputs, the program counter and the operands' addresses.

The proofs do not cover what the data paths compute. A program has no branches, so its clocks are
the same for every frame.
"""

from golden.engine.loop_program import LoopProgram
from tb.common.properties import Property
from tb.networks.prove_engine import built_in, loaded

# The first has ReLU, eight lanes and no table. In the second frames overlap. Into the third images
# are loaded.
ALSO = ("relu-lanes", "rails-loop", "rails-lanes-reload")
# What a reset clears of the model.
CLEARED = (
    *("samples", "pause", "at", "skipping", "told", "loops", "asked", "began", "began_before"),
    *("due", "closes"),
)


def properties(twin):
    if isinstance(twin.program, LoopProgram):
        return [outputs_of_a_loop(twin)]
    if twin.loaded:
        return [*loaded(twin), placed(twin)]
    return built_in(twin, "samples")


def outputs_of_a_loop(twin):
    """Which outputs leave when, for frames that overlap."""
    program, inputs, busy = twin.program, twin.inputs, twin.busy
    length, stages, loop = program.loop.length, program.stages, program.loop
    late = program.pipeline.memory_registers
    times = [loop.ends[n] + program.pipeline.mark for n in loop.leaving]
    marked = [f"(live[{time // length}] && fetched == {time % length})" for time in times]
    watch = f"""
        reg [15:0] samples = 0, pause = 0, at = 0, earlier = 0, fetched = 0;
        reg skipping = 0, told = 0, loops = 0, asked = 0;
        reg [{stages - 1}:0] began = 0, began_before = 0;
        reg [1:0] due = 0, closes = 0;
        wire taken = in_valid && pause == 0 && !skipping;
        wire is_good = taken && samples == {inputs - 1} && in_last;
        wire is_wrong = in_valid && !skipping
            && (pause != 0 || in_last != (samples == {inputs - 1}));
        wire over = loops && at == 0;
        wire turning = over || (is_good && !loops);
        wire another = is_good || asked || began[{stages - 2}:0] != 0;
        wire [{stages - 1}:0] live = {"began_before" if late else "began"};
        always @(posedge clk) begin
            if (taken) samples <= is_good || is_wrong ? 0 : samples + 1;
            if (in_valid) skipping <= !in_last && (skipping || is_wrong);
            pause <= is_good ? {busy} : pause == 0 ? 0 : pause - 1;
            told <= is_wrong;
            loops <= over ? another : loops || is_good;
            at <= turning ? (!over || another) : loops && at != {length - 1} ? at + 1 : 0;
            asked <= !turning && (asked || is_good);
            if (turning) began <= {{began[{stages - 2}:0], is_good || asked}};
            began_before <= began;
            due <= {{due[0], {" || ".join(marked)}}};
            closes <= {{closes[0], {marked[-1]}}};
            if (rst) begin
                {" ".join(f"{name} <= 0;" for name in CLEARED)}
            end
        end
        // The word that is there was read from this place of the memory.
        always @(posedge clk) begin
            earlier <= u_program_memory_0.counter;
            fetched <= {"earlier" if late else "u_program_memory_0.counter"};
        end
    """
    return Property(
        name="outputs of frames that overlap",
        sentence="Each good frame, and nothing else, yields outputs in the clocks "
        f"{', '.join(map(str, twin.output_clocks))} after the clock in which a loop begins with "
        "it, the last one with out_last. That is the clock of its last sample where no loop runs, "
        f"and otherwise the next one that is a multiple of {length} clocks after the loop before. "
        "frame_error is high for one clock for each wrong frame, which yields no output.",
        states=(
            "out_valid == due[1]",
            "!out_valid || out_last == closes[1]",
            "frame_error == told",
        ),
        watch=watch,
        helps=(
            "leaves == due[0] && ends == closes[0] && out_last == closes[1]",
            "lane_loop0_runs == loops && lane_loop0_waits == asked && lane_loop0_frames == began",
            "lane_loop0_frames_late == live",
            "u_program_memory_0.counter == at",
            f"at < {length} && (loops || at == 0)",
            "lane_loop0_last == (loops && at == 0)",
            f"lane_loop0_wraps == (loops && at == {length - 1})",
            "loops || began == 0",
            "!loops || word == u_program_memory_0.memory[fetched]",
            f"!loops || at <= {late + 1} || fetched == at - {late + 1}",
            f"!loops || at != 0 || fetched == {length - 1 - late}",
            f"!loops || at != {late + 1} || fetched == 0",
            "lane_loop0_samples0_remaining == pause",
            "u_frame_check_0.running == (pause != 0) && u_frame_check_0.dropping == skipping",
            f"pause <= {busy} && samples < {inputs} && (pause == 0 || samples == 0)",
            f"pause != 0 || u_frame_check_0.addr == (samples == 0 "
            f"? {(1 << twin.frame_check.addr_width) - 1} : samples - 1)",
        ),
        reached=("loops && at == 2",),
        refuted_by=(
            (r"out_valid <= leaves", "out_valid <= (leaves || lane_loop0_good)"),
            (r"frame_error <= \(early \|\| broken\)", "frame_error <= broken"),
        ),
        clocks=inputs + 9,
        induction=3,
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
            (r"lane_word_1 = .*;", "lane_word_1 = put_word[17:0];"),
        ),
        clocks=2,
    )
