"""The listing of a program that learns: a line for every word, part by part."""

from golden.learning.program import LessonProgram


def lesson_listing(program: LessonProgram) -> list[str]:
    """The words behind the table, and which part begins where.

    A part is computed from its first word on. The words before it say where its first results go.
    """
    frame, keep, *equations = program.lengths
    texts = [
        f"frame, {frame} steps",
        f"keep a placement, {keep} steps",
        f"all equations, {program.begun_alike} steps, then a jump to the rest of one",
        *(
            f"the rest of equation {k + 1}, {steps - program.begun_alike} steps"
            for k, steps in enumerate(equations)
        ),
    ]
    begun = dict(zip(program.starts, texts, strict=True))
    lines = [f"words 0 to {len(program.table) - 1}: the table of tanh"]
    for address in range(len(program.table), len(program.notes)):
        if address in begun:
            lines.append(f"{begun[address]}:")
        lines.append(f"{address:>5}  {program.notes[address]}")
    return lines
