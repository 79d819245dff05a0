"""Proved properties of replay_memory, whatever controls it."""

from golden.engine.formats import SAMPLE_SHIFT, WIDTH
from golden.engine.program import WORD_WIDTH
from golden.engine.replay import CLEAR, ONE_PLANE
from golden.engine.serial_program import ALL, DEEP, END, WIDE
from tb.common.properties import Property
from tb.common.watch import pipe, table


def properties(twin):
    width, words = twin.addr_width, len(twin.contents)
    low, bits = END
    return [
        Property(
            name="passes",
            sentence=f"Whatever the words are, each pass ends with the word that says so for its "
            f"plane; the pass of plane {CLEAR} ends with its first word. The next pass begins with "
            "the neuron's first word. The pass behind plane 0 begins with the first word of the "
            f"next neuron, which stands behind the last word of plane {ONE_PLANE}. A reset, finish "
            "and a clock without run lead back to the program's first word.",
            states=(
                "place == 1 << number",
                "!known || first == begins",
                "address == next",
            ),
            watch=f"""
                // As the twin counts: where this clock's word stands, and in which plane.
                reg known = 0, begins;
                reg [4:0] number;
                reg [{width - 1}:0] here, base_word, next_neuron;
                wire [{bits - 1}:0] mark = word[{low + bits - 1}:{low}];
                wire last = number == {CLEAR} || (number == {ONE_PLANE} ? mark == {ALL}
                    : number >= {SAMPLE_SHIFT} ? mark >= {WIDE} : mark >= {DEEP});
                wire [{width - 1}:0] behind = here + 1;
                wire [{width - 1}:0] next = last ? base_word : behind;
                wire [{width - 1}:0] after_all = last && number == {ONE_PLANE} ? behind
                    : next_neuron;
                always @(posedge clk) begin
                    known <= after_reset;
                    here <= next;
                    begins <= last;
                    next_neuron <= after_all;
                    if (rst || finish || !run) begin
                        base_word <= {twin.begin};
                        number <= {CLEAR};
                    end else if (last) begin
                        number <= number == 0 ? {CLEAR} : number - 1;
                        if (number == 1) base_word <= after_all;
                    end
                end
            """,
            helps=(
                f"number <= {CLEAR}",
                f"sort == (number == {CLEAR} ? 3 : number == {ONE_PLANE} ? 1 "
                f": number < {SAMPLE_SHIFT} ? 2 : 0)",
                f"base == base_word && second == base_word + {width}'d1",
                f"number == {CLEAR} || counter == behind",
                f"number >= {ONE_PLANE} || (following == next_neuron "
                f"&& beside == next_neuron + {width}'d1)",
            ),
            free=("fetched",),
            reached=(f"number == {ONE_PLANE} && begins", "number == 0"),
            refuted_by=(
                (r"end_field == 3", "end_field == 2"),
                (r"end_field != 0", "end_field == 1"),
                (r"ends = end_field\[1\]", "ends = end_field[0]"),
                (r"ends && place\[14\]", "ends && place[13]"),
                (r"if \(place\[1\]\)", "if (place[2])"),
                (r"stands = \(finish \|\| ", "stands = ("),
                (r"counter <= second", "counter <= further"),
            ),
            clocks=CLEAR + 8,
        ),
        Property(
            name="words",
            sentence=f"Each of the {words} addresses gives the twin's word one clock later, as "
            "word and, where it is looked up, as table_word, which is 0 otherwise.",
            states=(
                "!there[0] || word == contents(here_0)",
                f"!there[0] || table_word == (asked_0 ? contents(below_0) % {1 << WIDTH} : 0)",
            ),
            watch=f"""
                wire [{width}:0] here = address, below = segment;
                wire [1:0] asked = look_up;
            """
            + pipe("here", 1, width + 1)
            + pipe("below", 1, width + 1, also=False)
            + pipe("asked", 1, 2, also=False)
            + table("contents", twin.contents, WORD_WIDTH),
            free=("address",),
            reached=(f"there[0] && here_0 == {words - 1}", "there[0] && asked_0 && below_0 == 1"),
            refuted_by=(
                (r"(memory\[0\] <= \S+);", r"\1 ^ 1;"),
                (r"(memory\[\d\d\d\] <= \S+);", r"\1 ^ 1;"),
                (r"if \(look_up\)", "if (1)"),
                (r"memory\[segment\]", "memory[segment ^ 1]"),
            ),
            clocks=3,
        ),
    ]
