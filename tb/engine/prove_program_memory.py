"""Proved properties of program_memory, whatever controls it."""

from golden.engine.formats import WORD_WIDTH
from tb.common.properties import Property
from tb.common.watch import past, pipe, table


def properties(twin):
    width, words, late = twin.addr_width, len(twin.contents), twin.latency
    sentence = f"Each of the {words} addresses gives the twin's word. The counter's word comes "
    sentence += f"{late} clock{'s' * (late > 1)} later."
    return [
        counted(twin, words),
        Property(
            name="words",
            sentence=sentence,
            states=(f"!there[{late - 1}] || word == contents(here_{late - 1})",),
            watch=f"wire [{width}:0] here = counter;"
            + pipe("here", late, width + 1, also=False)
            + past(late)
            + table("contents", twin.contents, WORD_WIDTH),
            free=("counter",),
            reached=(f"there[{late - 1}] && here_{late - 1} == {words - 1}",),
            refuted_by=((r"(memory\[0\] <= \S+);", r"\1 ^ 1;"),),
            clocks=late + 2,
            induction=late + 1,
        ),
    ]


def counted(twin, words):
    """The properties of the counter that steps through a program."""
    return Property(
        name="counter",
        sentence="The counter stands at 0, the program's first word, after a reset, "
        "after finish, and after a clock with neither start nor run. Otherwise it steps to the "
        "next word.",
        states=("counter == expected",),
        watch=f"""
            reg [31:0] expected;
            always @(posedge clk) expected <= rst || finish || !(start || run) ? 0
                : (expected + 1) % {words};
        """,
        helps=(f"expected < {words}",),
        reached=("expected == 3",),
        refuted_by=(
            (r"stands = \(finish \|\| \(!\(start \|\| run\)\)\)", "stands = (!(start || run))"),
            (r"stands = \(finish \|\| \(!\(start \|\| run\)\)\)", "stands = (finish || (!run))"),
            (r"rst == 1", "0"),
            (r"counter \+ 1", "counter + 2"),
        ),
        clocks=6,
    )
