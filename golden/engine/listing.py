"""A program as a person reads it."""

from __future__ import annotations

from golden.engine.formats import ONE, coeff_frac
from golden.engine.graph import Graph, Kind
from golden.engine.schedule import Step


def operand_text(graph: Graph, step: Step) -> str:
    """What a step reads."""
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
    """Its weight as a number."""
    term = step.term
    if step.neuron < 0:
        return ""
    if term.kind in (Kind.INTERCEPT, Kind.DISTANCE):
        return "intercept of the table" if term.kind is Kind.INTERCEPT else "slope of the table"
    operand = ONE if term.kind is Kind.ONE else graph.format_of(term.source)
    frac = coeff_frac(graph.neurons[step.neuron].result, operand)
    return f"{term.weight / 2**frac:.6g}"


def text_of(graph: Graph, step: Step) -> str:
    """One step in one line."""
    if step.neuron < 0:
        return "wait"
    name = graph.neurons[step.neuron].name
    joint = f"{name} =" if step.first else f"{name} +"
    end = ", done" if step.last else ""
    return f"{joint} {operand_text(graph, step)} x {weight_text(graph, step)}{end}"
