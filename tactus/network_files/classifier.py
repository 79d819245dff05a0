"""The end of a classifier's graph, behind the values of which the largest tells the class.

Softmax, LogSoftmax and the sigmoid of one value do not change which of these values is the largest,
or the sign of the only one. So a network ends in front of them, and the operators behind are only
followed to find the labels.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from golden.input_error import InputError
from tactus.network_files.parsed import Ending, Label
from tactus.network_files.quantisers import attributes_of

BEGINNINGS = ("Softmax", "LogSoftmax", "ArgMax")
NAMING = ("ArrayFeatureExtractor", "Gather")
DOMAINS = ("", "ai.onnx", "ai.onnx.ml")


# What a value behind the network is: the network's own values; numbers of which the largest is that
# of the class; the probability of the second of two classes, and that of the first; the number of
# the class, and its label; what repeats scores in another form.
VALUES, SCORES, SECOND, FIRST, INDEX, LABEL, TOLD = range(7)
# For each operator, what it may take, and what it gives; None for the same as it takes.
STEPS: dict[str, tuple[tuple[int, ...], int | None]] = {
    "Softmax": ((VALUES, SCORES), SCORES),
    "LogSoftmax": ((VALUES, SCORES), SCORES),
    "ArgMax": ((VALUES, SCORES), INDEX),
    "Sigmoid": ((VALUES,), SECOND),
    "Sub": ((SECOND,), FIRST),
    "Concat": ((FIRST, SECOND), SCORES),
    "ArrayFeatureExtractor": ((INDEX,), LABEL),
    "Gather": ((INDEX,), LABEL),
    "ZipMap": ((SCORES,), TOLD),
    "Slice": ((SCORES,), TOLD),
    "Reshape": ((INDEX, LABEL, TOLD), None),
    "Squeeze": ((INDEX, LABEL, TOLD), None),
    "Cast": ((SCORES, INDEX, LABEL, TOLD), None),
    "Identity": ((SCORES, INDEX, LABEL, TOLD), None),
}


def begins(node: Any, later: Sequence[Any]) -> bool:
    """Whether an operator of the chain is the first of a classifier's end.

    A Sigmoid is, if several operators read its result: one probability becomes two.
    """
    if node.op_type == "Sigmoid":
        return sum(node.output[0] in reader.input for reader in later) > 1
    return node.op_type in BEGINNINGS


def followed(
    nodes: Sequence[Any],
    start: str,
    outputs: Sequence[str],
    constants: dict[str, Any],
    width: int,
    refuse: Callable[[str, Any], InputError],
) -> Ending:
    """Follow the operators behind a network to the outputs of the graph.

    start, width: The name of the network's values, and how many it gives.
    outputs: The names of the graph's outputs.
    refuse: Makes the error about a node.
    """
    kinds, found = {start: VALUES}, tuple[Label, ...]()
    for node in nodes:
        if node.op_type not in STEPS or node.domain not in DOMAINS:
            expected = f"expected one of {', '.join(STEPS)}"
            raise refuse(f"not supported in the end of a classifier, {expected}", node)
        takes, gives = STEPS[node.op_type]
        read = [kinds[name] for name in node.input if name in kinds]
        if not read or read[0] not in takes or len(node.output) != 1:
            raise refuse("stands at a wrong place in the end of a classifier", node)
        if fault := _fault(node, read, constants, width):
            raise refuse(fault, node)
        labels = _labels(node, constants)
        if labels is not None and len(labels) != max(width, 2):
            raise refuse(f"got {len(labels)} labels, expected {max(width, 2)}", node)
        if labels and found and labels != found:
            raise refuse(f"got the labels {labels}, expected {found} as before", node)
        found = labels or found
        kinds[node.output[0]] = read[0] if gives is None else gives
    for name in outputs:
        if name not in kinds and name not in constants:
            raise refuse(f"gives no output {name!r} of the graph", nodes[-1])
    return Ending(nodes[0].op_type, found)


def _fault(node: Any, read: list[int], constants: dict[str, Any], width: int) -> str:
    """Why an operator could change which class it is, or not tell it; empty if it does neither."""
    kind, attributes = node.op_type, attributes_of(node)
    axis = attributes.get("axis", 0 if kind == "ArgMax" else 1)
    if kind in (*BEGINNINGS, "Concat") and axis not in (1, -1):
        return f"got axis {axis}, expected 1, along the values of a frame"
    if kind in BEGINNINGS and read == [VALUES] and width < 2:
        return f"takes {width} value, expected one for each class"
    if kind == "ArgMax" and attributes.get("select_last_index", 0):
        return "select_last_index=1, expected 0, the first of equal values"
    if kind == "Sigmoid" and width != 1:
        return (
            f"makes probabilities of {width} classes that may hold at once, expected classes of "
            "which one holds"
        )
    if kind == "Sub" and np.ravel(constants.get(node.input[0], 0)).tolist() != [1]:
        return "expected 1 minus the probability"
    if kind == "Concat" and read != [FIRST, SECOND]:
        return "expected the probabilities of both classes, in their order"
    if kind in NAMING and node.input[0] not in constants:
        return f"reads {node.input[0]!r}, expected constant labels"
    return ""


def _labels(node: Any, constants: dict[str, Any]) -> tuple[Label, ...] | None:
    """The labels of the classes that an operator holds; None if it holds none."""
    values: Any = None
    if node.op_type in NAMING:
        values = constants[node.input[0]]
    elif node.op_type == "ZipMap":
        named = [v for k, v in attributes_of(node).items() if k.startswith("classlabels")]
        values = [value for several in named for value in several]
    if values is None:
        return None
    labels = np.ravel(np.asarray(values, dtype=object)).tolist()
    return tuple(one.decode() if isinstance(one, bytes) else one for one in labels)
