"""Graphs of searches for shared terms, which are kept where a search is long."""

from collections.abc import Callable
from typing import Any

from golden.layers import sharing
from golden.layers.sharing import Matrix, shared
from golden.layers.shift_add import Constant, Input, Node, Operand, Row, ShiftAdd, Sum

# The search for a matrix with fewer weights takes about as long as reading what was kept.
LEAST_WEIGHTS = 32
# Takes what a graph depends on, whether it must be kept, and the search; gives the data of the
# graph. Whoever has a place for files sets it. Without it every graph is searched anew.
keeper: Callable[[dict[str, Any], bool, Callable[[], Any]], Any] | None = None


def graph_of(matrix: Matrix, levels: int, spare: int, operands: int, runs: int) -> ShiftAdd:
    """The graph of ``shared``. For a large matrix, or a given number of runs, it is found once."""
    small = sum(map(len, matrix.weights)) < LEAST_WEIGHTS
    if keeper is None or (small and not runs):
        return shared(matrix, levels, spare, operands, runs)
    # Tests set other limits, which the code does not show.
    parts = {
        "limits": (sharing.RUNS, sharing.PAIRS),
        "matrix": repr(matrix),
        "levels": levels,
        "spare": spare,
        "operands": operands,
        "runs": runs,
    }
    return of_data(
        matrix,
        keeper(parts, bool(runs), lambda: as_data(shared(matrix, levels, spare, operands, runs))),
    )


def as_data(graph: ShiftAdd) -> dict[str, list[object]]:
    """A graph without its ends as data for JSON."""
    return {
        "nodes": [_node_data(node) for node in graph.nodes],
        "lows": list(graph.lows),
        "rows": [[row.node, row.shift, row.minus] for row in graph.rows],
    }


def of_data(matrix: Matrix, data: dict[str, list[Any]]) -> ShiftAdd:
    """The graph that ``as_data`` gave as data."""
    return ShiftAdd(
        matrix.ends,
        tuple(_node(one) for one in data["nodes"]),
        tuple(data["lows"]),
        tuple(Row(*row) for row in data["rows"]),
    )


def _node_data(node: Node) -> list[object]:
    """The kind of a node, and what it holds."""
    if isinstance(node, Input):
        return ["input", node.number]
    if isinstance(node, Constant):
        return ["constant", node.value]
    return ["sum", *([one.node, one.shift, one.sign] for one in node.operands)]


def _node(data: list[Any]) -> Node:
    kind, *held = data
    if kind == "sum":
        return Sum(tuple(Operand(*one) for one in held))
    return Input(*held) if kind == "input" else Constant(*held)
