"""A program as a text for a person to read."""

from __future__ import annotations

from typing import TYPE_CHECKING

from golden.engine.formats import HIDDEN, ONE, coeff_frac
from golden.engine.function_table import codes_of, table_of
from golden.engine.graph import Graph, Kind
from golden.engine.schedule import Step
from golden.trained.function import TANH

if TYPE_CHECKING:
    from golden.engine.program import Program


def operand_text(graph: Graph, step: Step) -> str:
    """The text for the operand that a step reads."""
    term = step.term
    if step.neuron < 0:
        return "wait"
    if term.kind is Kind.ONE:
        return "1"
    if term.source < graph.inputs:
        return f"sample {term.source + 1}"
    name = graph.neurons[term.source - graph.inputs].name
    before = {Kind.WORD: "", Kind.INTERCEPT: "sign of ", Kind.DISTANCE: "low bits of "}
    return f"{before[term.kind]}{name}"


def weight_text(graph: Graph, step: Step) -> str:
    """The weight of a step as a decimal number."""
    term = step.term
    if step.neuron < 0:
        return ""
    if term.kind in (Kind.INTERCEPT, Kind.DISTANCE):
        return "intercept of the table" if term.kind is Kind.INTERCEPT else "slope of the table"
    operand = ONE if term.kind is Kind.ONE else graph.format_of(term.source)
    frac = coeff_frac(graph.neurons[step.neuron].result, operand)
    return f"{term.weight / 2**frac:.6g}"


def tables(graph: Graph, program: Program) -> list[str]:
    """A line for every table of the program, with its segments, of which two blocks have two."""
    segment = 2.0 ** (program.segment_width - HIDDEN.frac)
    if not program.table:
        return []
    count = len(program.table) // 2 // program.blocks
    if graph.functions == (TANH,) and program.blocks == 1:
        return [f"tanh in {count} segments of {segment:g}; the last one serves all beyond"]
    found = []
    for function, code in codes_of(graph.functions).items():
        error = table_of(function, program.segment_width).error
        first, own = (code >> 1) * count, count * (1 + (code & 1))
        found.append(
            f"{function.name} in {own} segments of {segment:g}, from {first} on; error "
            f"{error:.2g} at most"
        )
    return found
