"""The listing of a program that learns: a line for every word, part by part."""

from __future__ import annotations

from golden.learning.program import LessonProgram


def lesson_listing(program: LessonProgram) -> list[str]:
    """The words behind the table, and which part begins where.

    A part is computed from its first word on. The words before it say where its first results go.

    Parameters
    ----------
    program : LessonProgram
    """
    outputs = len(program.starts) - 2
    parts = ["frame", "keep a placement", *(f"equation {k + 1}" for k in range(outputs))]
    begun = {
        start: f"{part}, {length} steps"
        for start, part, length in zip(program.starts, parts, program.lengths, strict=True)
    }
    lines = [f"words 0 to {len(program.table) - 1}: the table of tanh"]
    for address in range(len(program.table), len(program.notes)):
        if address in begun:
            lines.append(f"{begun[address]}:")
        lines.append(f"{address:>5}  {program.notes[address]}")
    return lines
