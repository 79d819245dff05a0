"""Questions for z3 whether a sum of an engine can leave its accumulator, for these very weights."""

from __future__ import annotations

from pathlib import Path

from golden.engine.function_table import joined
from golden.engine.graph import Kind, Neuron, Term
from golden.networks.engine import Engine
from golden.networks.network import Network


def write_sums(design: Network, folder: Path) -> int:
    """Write ``sums`` below a folder; the number of sums, 0 where the design adds up elsewhere.

    A sum may hold any part of its products at a time, in whatever order they are added. A product
    with a word is that of the weight with any code of the word. A product with a word of the table
    is any number up to the largest that the table gives.
    """
    core = design.core
    if not isinstance(core, Engine):
        return 0
    place = folder / "sums"
    place.mkdir()
    texts = [_question(core, neuron) for neuron in core.graph.neurons]
    (place / "sums.smt2").write_text("\n".join(texts), encoding="utf-8")
    (place / "due.txt").write_text("unsat\n" * len(texts), encoding="ascii")
    return len(texts)


def _question(engine: Engine, neuron: Neuron) -> str:
    high = 1 << (engine.acc_width - 1)
    table = joined(engine.graph.functions, engine.program.segment_width)
    lines = [f"; {neuron.name}", "(push 1)"]
    products = []
    for n, term in enumerate(neuron.terms):
        lines += [f"(declare-const x{n} Int)", f"(declare-const added{n} Bool)"]
        if term.kind is Kind.WORD:
            low, top = _reach(engine, term)
            lines.append(f"(assert (and (<= {_number(low)} x{n}) (<= x{n} {top})))")
            product = f"(* {_number(term.weight)} x{n})"
        else:
            most = engine.graph.largest(term, table)
            lines.append(f"(assert (and (<= {_number(-most)} x{n}) (<= x{n} {most})))")
            product = f"x{n}"
        products.append(f"(ite added{n} {product} 0)")
    total = f"(+ {neuron.start} {' '.join(products)} 0)"
    lines.append(f"(assert (let ((sum {total})) (or (< sum {_number(-high)}) (>= sum {high}))))")
    return "\n".join([*lines, "(check-sat)", "(pop 1)", ""])


def _reach(engine: Engine, term: Term) -> tuple[int, int]:
    """The codes of the word that a term reads."""
    fmt = engine.graph.format_of(term.source)
    return fmt.low, fmt.high


def _number(value: int) -> str:
    return f"(- {-value})" if value < 0 else str(value)
