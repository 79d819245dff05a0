"""Proved properties of learning_engine: learning changes no clock of a frame, and nothing by half.

The proofs do not cover what the data paths compute. A program has one jump, in the equations, and
frames have none, so the clocks of every frame are the same.
"""

from golden.engine.formats import DROPPED, OUTPUT_SHIFT, SAMPLE_SHIFT, WIDTH, WORD
from golden.engine.graph import Kind
from golden.learning.program import FRAME
from golden.numbers.precision import SIGNAL
from tb.common.properties import Property
from tb.common.watch import frames_computed, pipe

# This has one output, and so one equation.
PROVED = ("least-lesson",)
# Whatever the data paths compute, and whichever placements are kept.
FREE = ("read", "second", "table_word", "acc", "spoiled", "lesson_control0_none")
ONE_AT_A_TIME = "!(frame_start || frame_run) || !(studying || opening || goes)"


def properties(twin):
    return [outputs(twin), sound_readings(twin), whole_updates()]


def outputs(twin):
    """Which outputs leave when."""
    inputs, first = twin.inputs, twin.program.starts[FRAME]
    left = " || ".join(f"since == {clock}" for clock in twin.output_clocks)
    none = (1 << twin.frame_check.addr_width) - 1
    watch = frames_computed(inputs, twin.busy, taken="accepted")
    watch += """
        reg [15:0] fetched_from;
        always @(posedge clk) fetched_from <= lesson_memory0_counter;
    """
    return Property(
        name="outputs of good frames",
        sentence="Each good frame, and nothing else, yields outputs in the clocks "
        f"{', '.join(map(str, twin.output_clocks))} after its last sample, the last one with "
        "out_last, whether it learns or not and whatever known outputs come. frame_error is high "
        "for one clock for each wrong frame, which yields no output.",
        states=(
            f"out_valid == ({left})",
            f"out_last == (since == {twin.output_clocks[-1]})",
            "frame_error == told",
        ),
        watch=watch,
        helps=(
            "frame_start == (since == 1) && frame_run == (since > 1)",
            "u_frame_check_0.waiting == (since == 1)",
            "u_frame_check_0.dropping == skipping",
            f"since <= {twin.busy} && place < {inputs} && (since == 0 || place == 0)",
            f"since != 0 || u_frame_check_0.addr == (place == 0 ? {none} : place - 1)",
            ONE_AT_A_TIME,
            f"since == 0 || lesson_memory0_counter == {first - 1} + since",
            f"since < 2 || fetched_from == {first - 2} + since",
            "since < 2 || word == lesson_memory0_memory[fetched_from]",
        ),
        free=FREE,
        reached=("since == 2", "studying && in_valid"),
        refuted_by=(
            (r"out_valid <= leaves", "out_valid <= (leaves || frame_start)"),
            (r"early \|\| broken", "broken"),
        ),
        clocks=inputs + 9,
        induction=6,
    )


def sound_readings(twin):
    """Behind which frames known outputs and theta are taken."""
    none, final = (1 << twin.frame_check.addr_width) - 1, twin.inputs - 1
    low, high = f"-{SIGNAL.width}'sd{-SIGNAL.low}", f"{SIGNAL.width}'sd{SIGNAL.high}"
    computed = "(frame_start || frame_run)"
    arrives = f"(in_valid && !{computed})"
    watch = f"""
        // The number of the next sample of a frame; whether one of them was at an end.
        reg [15:0] place = 0;
        reg met_end = 0, sound = 0;
        wire met_end_now = sample_write ? at_low || at_high || (clipped && continues) : clipped;
        always @(posedge clk) begin
            if (u_frame_check_0.accept) begin
                place <= in_last || place == {final} ? 0 : place + 1;
                met_end <= in_data == {low} || in_data == {high} || (met_end && place != 0);
            end
            sound <= !{arrives} && (frame_finish ? !met_end : sound);
            if (rst) begin
                place <= 0;
                sound <= 0;
            end
        end
    """
    return Property(
        name="sound readings",
        sentence="Known outputs and theta are taken from the last output of a frame up to the next "
        "sample, unless a sample of the frame was at an end of its range.",
        states=("fresh == sound", f"halt == (({arrives} || !sound) && !keep_busy)"),
        watch=watch,
        helps=(
            "u_frame_check_0.waiting == frame_start && !(frame_start && frame_run)",
            f"place <= {final} && (place == 0 || !{computed})",
            f"{computed} || u_frame_check_0.addr == (place == 0 ? {none} : place - 1)",
            f"!frame_start || !sample_write || u_frame_check_0.addr == {final}",
            f"(place == 0 && !{computed}) || met_end_now == met_end",
            "!frame_run || !sample_write",
        ),
        # A frame may end in any clock.
        free=(*FREE, "finish"),
        reached=("fresh", "frame_run && clipped"),
        refuted_by=(
            (r"fresh <= \(!clipped\)", "fresh <= 1'b1"),
            (r"clipped && continues", "clipped"),
            (r"at_low \|\| at_high", "at_low"),
        ),
        clocks=2 * twin.inputs + 9,
        induction=3,
    )


def whole_updates():
    """When theta is exchanged, and what happens to a step that would leave the range."""
    return Property(
        name="whole updates",
        sentence="While a frame is computed, no equation is, and the theta that is read stays. "
        "It is exchanged in the clock after the last result of an equation in which no word of "
        "the new theta was saturated, and behind a stream of theta, and in no other clock. No "
        "equation is computed between two words of such a stream. learn_error is high for one "
        "clock, in the clock after the last result of an equation in which a word of the new theta "
        "was saturated.",
        states=(
            "!(frame_start || frame_run) || !studying",
            "!(ran_before && frame_run) || bank == bank_before",
            "reset_before || (bank != bank_before) == ((passed_before && !bad_before) "
            "|| put_before)",
            "!partly || !(studying || opening || goes)",
            "learn_error == (passed_before && bad_before)",
        ),
        watch="""
            reg bank_before, ran_before = 0, passed_before = 0, bad_before, reset_before = 1;
            reg put_before = 0;
            always @(posedge clk) begin
                bank_before <= bank;
                ran_before <= frame_run;
                passed_before <= lesson_control0_passed && !rst;
                bad_before <= bad;
                put_before <= keep_run && finish && putting && !rst;
                reset_before <= rst;
            end
        """,
        helps=(ONE_AT_A_TIME,),
        # A part may end in any clock.
        free=(*FREE, "finish"),
        reached=(
            "frame_run && ran_before",
            "bank != bank_before && !reset_before",
            "put_before && !reset_before",
            "learn_error",
        ),
        refuted_by=(
            (r"lesson_control0_passed && \(!bad\)", "lesson_control0_passed"),
            (r"\(arrives \|\| taken\)", "taken"),
            (r"learn && ready &&", "learn &&"),
            (r"lesson_control0_put \|\| ", "finish || "),
            (r"telling \|\| partly", "telling"),
            (r"learn_error <= \(lesson_control0_passed && bad\)", "learn_error <= bad"),
        ),
        clocks=24,
    )


def operand_memory(twin):
    late, width = twin.latency, twin.addr_width
    return [
        Property(
            name="what was written",
            sentence=f"The word that is read at each of {1 << width} addresses, {late} clock"
            f"{'s' * (late > 1)} later, is the one that was written there last, in a clock before "
            "that of the address.",
            states=(f"!there[{late - 1}] || !met_{late - 1} || word == kept_{late - 1}",),
            watch=f"""
                // Any one address, and the word that was written there last.
                (* anyconst *) reg [{width - 1}:0] place;
                reg known = 0;
                reg [17:0] kept;
                always @(posedge clk) if (write && write_addr == place) begin
                    known <= 1;
                    kept <= data;
                end
                wire met = known && read_addr == place;
            """
            + pipe("met", late, 1)
            + pipe("kept", late, 18, also=False),
            helps=(
                "!known || memory[place] == kept",
                *(("!there[0] || !met_0 || found == kept_0",) if late > 1 else ()),
            ),
            reached=(f"there[{late - 1}] && met_{late - 1}",),
            refuted_by=(
                (r"if \(write\)", "if (1)"),
                (r"memory\[read_addr\]", "memory[read_addr ^ 1]"),
                (r"memory\[write_addr\] <= data", "memory[write_addr >> 1] <= data"),
                (
                    r"found <= memory",
                    "if (write && write_addr == read_addr) found <= data; else found <= memory",
                ),
            ),
            clocks=late + 2,
            induction=late,
            arrays=True,
            whole=True,
        )
    ]


def operand_select(twin):
    one, span = 1 << DROPPED, 1 << twin.segment_width
    late = twin.latency
    return [
        Property(
            name="operand",
            sentence=f"The operand comes {late} clocks later and is what its kind says: the word, "
            "the number one with the word's sign, the word's distance from the middle of a segment "
            f"of {span} codes, or the number one.",
            states=(f"!there[{late - 1}] || $signed(operand) == expected_{late - 1}",),
            watch=f"""
                wire signed [31:0] whole = $signed(word);
                wire signed [31:0] inside = whole & {span - 1};
                wire signed [31:0] expected = kind == {Kind.WORD:d} ? whole
                    : kind == {Kind.DISTANCE:d} ? inside - {span // 2}
                    : kind == {Kind.INTERCEPT:d} && whole < 0 ? -{one} : {one};
            """
            + pipe("expected", late, 32),
            reached=(f"there[{late - 1}] && expected_{late - 1} == -{span // 2}",),
            refuted_by=(
                (r"below = \(!word\[(\d+)\]\)", r"below = word[\1]"),
                (r"\(kind == 1\) && word\[17\]", "(kind == 1)"),
                (r"kind == 2", "kind == 3"),
                (r"chosen = 16384", "chosen = 16383"),
            ),
            clocks=late + 2,
            induction=late + 1,
            whole=True,
        )
    ]


def multiply_accumulate(twin):
    half = 1 << (DROPPED - 1)
    half_output = half << OUTPUT_SHIFT
    least, largest = WORD.low * WORD.high, WORD.low * WORD.low
    # A sum of so many products always fits, whatever they are.
    low, high = -1 << (twin.acc_width - 1), (1 << (twin.acc_width - 1)) - 1
    most = min((high - half_output) // largest, -low // -least)
    in_range = f"($signed(product) >= 64'sd0 + {least} && $signed(product) <= 64'sd{largest})"
    return [
        Property(
            name="products",
            sentence="Each product is that of the operand and the coefficient three clocks before. "
            "The coefficient is the program's weight or the half of the table's word that "
            "take_intercept names.",
            states=(
                "!there[1] || ($signed(factor_late) == taken_1 && $signed(coeff_late) == code_1)",
                "!there[2] || $signed(product) == expected",
            ),
            watch=f"""
                wire [{WIDTH - 1}:0] high = table_word >> {WIDTH}, low = table_word;
                wire [{WIDTH - 1}:0] code = weight | (take_intercept ? high : low);
                wire [{WIDTH - 1}:0] taken = operand;
            """
            + pipe("code", 2, WIDTH)
            + pipe("taken", 2, WIDTH, also=False)
            + f"""
                reg signed [{2 * WIDTH - 1}:0] expected;
                always @(posedge clk) expected <= $signed(factor_late) * $signed(coeff_late);
            """,
            reached=("there[2] && taken_1 == -1 && code_1 == 3",),
            refuted_by=(
                (r"weight \| chosen", "weight"),
                (r"table_word\[36-1:18\]", "table_word[17:0]"),
                (r"coeff_late <= coeff", "coeff_late <= bits"),
                (r"product <= \(", "product <= 2 * ("),
            ),
            clocks=4,
        ),
        Property(
            name="no overflow",
            sentence=f"The sum loses no bit as long as its {twin.acc_width} bits can hold it, "
            f"whatever its products are. They can hold every sum of up to {most} products.",
            states=(
                "!begun || !fits || $signed(acc) == exact",
                f"!begun || count > {most} || fits",
            ),
            # A sum in 64 bits, whether all sums before it fit as well, and how many terms it has.
            watch=f"""
                reg begun = 0, held = 1;
                reg signed [63:0] exact;
                reg [7:0] count = 0;
                wire opens = opening || opening_output;
                wire fits = held && exact >>> {twin.acc_width - 1} == exact >>> 63;
                always @(posedge clk) begin
                    begun <= begun || opens;
                    exact <= (opening_output ? 64'sd{half_output} : opening ? 64'sd{half} : exact)
                        + $signed(product);
                    held <= opens || fits;
                    count <= opens ? 1 : count == 255 ? 255 : count + 1;
                end
            """,
            assumes={f"A product of two codes lies between {least} and {largest}.": in_range},
            helps=(
                "!begun || acc == exact[" + f"{twin.acc_width - 1}:0]",
                "!begun || count != 0",
                *(
                    f"!begun || count != {n} || (exact >= {n} * 64'sd0 + {n * least} && exact "
                    f"<= 64'sd{n * largest + half_output})"
                    for n in range(1, most + 1)
                ),
            ),
            free=("product",),
            reached=(f"begun && count == {most}", "begun && !fits"),
            refuted_by=(
                (r"reg signed \[\d+:0\] total", f"reg signed [{twin.acc_width - 2}:0] total"),
                (r"base = 131072", "base = 8192"),
                (r"base = 8192", "base = 0"),
                (r"if \(opening_output\)", "if (opening_output && opening)"),
            ),
            clocks=most + 4,
            whole=True,
        ),
    ]


def table_address(twin):
    span, last = 1 << twin.segment_width, twin.segments - 1
    return [
        Property(
            name="segment",
            sentence=f"One clock later the address is the segment of {span} codes in which q lies, "
            f"counted from 0 up and from -1 down. Beyond the last segment it is {last}.",
            states=("!after_reset || addr == expected",),
            watch=f"""
                wire signed [31:0] whole = $signed(q);
                wire [31:0] piece = (whole < 0 ? -32'sd1 - whole : whole) / {span};
                reg [31:0] expected;
                always @(posedge clk) expected <= piece > {last} ? {last} : piece;
            """,
            reached=(f"after_reset && expected == {last}", "after_reset && expected == 0"),
            refuted_by=(
                (r"if \(q\[17\]\)", "if (q[16])"),
                (r"addr <= \d+", "addr <= 0"),
                (r"top > 4", "top > 5"),
            ),
            clocks=3,
            induction=2,
            whole=True,
        )
    ]


def round_saturate(twin):
    low, high = WORD.low, WORD.high
    return [
        Property(
            name="word",
            sentence=f"One clock later the word is the sum without its lowest {DROPPED} bits, or "
            f"the end of the word's range where that lies beyond it. Without run the "
            f"word is {1 << SAMPLE_SHIFT} times the sample.",
            states=("!after_reset || $signed(word) == expected",),
            watch=f"""
                wire signed [63:0] sum = $signed(acc);
                wire signed [63:0] cut = sum >>> {DROPPED};
                wire signed [31:0] eightfold = $signed(sample) * 32'sd{1 << SAMPLE_SHIFT};
                reg signed [31:0] expected;
                always @(posedge clk) begin
                    expected <= !run ? eightfold
                        : cut < {low} ? {low} : cut > {high} ? {high} : cut;
                end
            """,
            reached=(f"after_reset && expected == {low}", f"after_reset && expected == {high}"),
            refuted_by=(
                (r"above != 0\)", "above != 1)"),
                (r"above != 127", "above != 126"),
                (r"result = 131071", "result = 131070"),
                (r"wide << 3", "wide << 2"),
                (r"if \(run\)", "if (1)"),
            ),
            clocks=3,
            induction=2,
            whole=True,
        )
    ]


OF_PARTS = {
    "operand_memory": operand_memory,
    "operand_select": operand_select,
    "multiply_accumulate": multiply_accumulate,
    "table_address": table_address,
    "round_saturate": round_saturate,
}
