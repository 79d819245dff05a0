"""The adders of a constant matrix as a text for a person to read."""

from golden.layers.constant_matrix import ConstantMatrix
from golden.layers.shift_add import Constant, Input, ShiftAdd


def listing(matrix: ConstantMatrix) -> list[str]:
    """A heading, and a line for every node of the graph and for every result.

    The column ``is`` shows whole numbers, with shifts and ``~`` as in Python. ``cut`` is the number
    of low bits that a node or a result lacks compared with its exact sum.
    """
    rows = [("node", "cut", "is")]
    for number, cut in enumerate(matrix.graph.lows):
        rows.append((f"n{number}", str(cut), _text(matrix.graph, number)))
    for i, row in enumerate(matrix.graph.rows):
        drop = matrix.drop(row)
        node = f"{'~' if row.minus else ''}n{row.node}"
        moved = f"{node} {'>>' if drop >= 0 else '<<'} {abs(drop)}"
        finish = matrix.row_finishes[i]
        if finish.even:
            tie = f"{node} % {1 << max(0, drop)} == 0"
            moved = f"({moved}) - (({moved}) & 1) * ({tie})"
        if finish.rectified:
            moved = f"({moved}) * ({node} >= 0)"
        rows.append((f"out_data_{i}", str(matrix.out_shift), moved))
    name, cut = (max(map(len, column)) for column in list(zip(*rows, strict=True))[:2])
    low, high = matrix.out_fmt.low, matrix.out_fmt.high
    return [
        f"{matrix.entity}: no result needs places below {matrix.place}; out_data is {low} to "
        f"{high} and saturates",
        *(f"{a:{name}}  {b:>{cut}}  {c}" for a, b, c in rows),
    ]


def _text(graph: ShiftAdd, number: int) -> str:
    node = graph.nodes[number]
    if isinstance(node, Input):
        return f"in_data_{node.number}"
    if isinstance(node, Constant):
        return str(node.value)
    found = []
    for one, step in zip(node.operands, graph.steps(number), strict=True):
        text = f"n{one.node}"
        if step.cut:
            text = f"({text} >> {step.cut})"
        elif step.move:
            text = f"({text} << {step.move})"
        found.append((one.sign, text))
    # One that is added comes first.
    (_, first), *rest = sorted(found, key=lambda item: -item[0])
    return " ".join([first, *(f"{'+' if sign > 0 else '-'} {text}" for sign, text in rest)])
