"""Proved properties of program_memory, whatever controls it."""

from golden.engine.program import WORD_WIDTH
from tb.common.properties import Property
from tb.common.watch import past, pipe, table


def properties(twin):
    width, words, late = twin.addr_width, len(twin.contents), twin.latency
    sentence = f"Each of the {words} addresses gives the twin's word. The counter's word comes "
    sentence += f"{late} clock{'s' * (late > 1)} later."
    states = [f"!there[{late - 1}] || word == contents(here_{late - 1})"]
    reached = [f"there[{late - 1}] && here_{late - 1} == {words - 1}"]
    refuted_by = [(r"(memory\[0\] <= \S+);", r"\1 ^ 1;")]
    watch, latest = f"wire [{width}:0] here = counter;", late
    if twin.table:
        looked = latest = twin.look_up_latency
        sentence += f" The segment's word comes {looked} clock{'s' * (looked > 1)} later, or 0 "
        sentence += "where none is looked up."
        states.append(
            f"!there[{looked - 1}] || table_word == "
            f"(asked_{looked - 1} ? contents(low_{looked - 1}) : 0)"
        )
        reached.append(f"there[{looked - 1}] && asked_{looked - 1} && low_{looked - 1} == 1")
        refuted_by += [
            (r"(memory\[\d\d\d\] <= \S+);", r"\1 ^ 1;"),
            (r"if \(look_up\)", "if (1)"),
        ]
        watch = f"""
                wire [{width}:0] here = counter, low = segment;
                wire [1:0] asked = look_up;
            """
        watch += pipe("low", looked, width + 1, also=False)
        watch += pipe("asked", looked, 2, also=False)
    return [
        counted(twin, words),
        Property(
            name="words",
            sentence=sentence,
            states=tuple(states),
            watch=watch
            + pipe("here", late, width + 1, also=False)
            + past(latest)
            + table("contents", twin.contents, WORD_WIDTH),
            free=("counter",),
            reached=tuple(reached),
            refuted_by=tuple(refuted_by),
            clocks=latest + 2,
            induction=latest + 1,
        ),
    ]


def counted(twin, words):
    """The properties of the counter that steps through a program."""
    return Property(
        name="counter",
        sentence=f"The counter stands at {twin.begin}, the program's first word, after a reset, "
        "after finish, and after a clock with neither start nor run. Otherwise it steps to the "
        "next word.",
        states=("counter == expected",),
        watch=f"""
            reg [31:0] expected;
            always @(posedge clk) expected <= rst || finish || !(start || run) ? {twin.begin}
                : (expected + 1) % {words};
        """,
        helps=(f"expected < {words}",),
        reached=(f"expected == {twin.begin + 3}",),
        refuted_by=(
            (r"stands = \(finish \|\| \(!\(start \|\| run\)\)\)", "stands = (!(start || run))"),
            (r"stands = \(finish \|\| \(!\(start \|\| run\)\)\)", "stands = (finish || (!run))"),
            (r"rst == 1", "0"),
            (r"counter \+ 1", "counter + 2"),
        ),
        clocks=6,
    )
