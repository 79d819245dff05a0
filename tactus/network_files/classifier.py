"""The end of a classifier's graph, behind the values of which the largest tells the class.

Softmax, LogSoftmax and the sigmoid of one value do not change which of these values is the largest,
or the sign of the only one. So a network ends in front of them, and the operators behind are only
followed to find the labels.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tactus.network_files.parsed import Ending, Label
from tactus.network_files.quantisers import Refuse, attributes_of

BEGINNINGS = ("Softmax", "LogSoftmax", "ArgMax")
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


@dataclass
class _End:
    """The values found so far, by name, and the labels."""

    kinds: dict[str, int]
    constants: dict[str, Any]
    refuse: Refuse
    width: int
    labels: tuple[Label, ...] = ()

    def step(self, node: Any) -> None:
        if node.op_type not in STEPS or node.domain not in DOMAINS:
            raise self.refuse(
                node,
                f"not supported in the end of a classifier, expected one of {', '.join(STEPS)}",
            )
        takes, gives = STEPS[node.op_type]
        read = [self.kinds[name] for name in node.input if name in self.kinds]
        if not read or read[0] not in takes or len(node.output) != 1:
            raise self.refuse(node, "stands at a wrong place in the end of a classifier")
        self._check(node, read)
        self.kinds[node.output[0]] = read[0] if gives is None else gives

    def _check(self, node: Any, read: list[int]) -> None:
        """Refuse what could change which class it is."""
        attributes = attributes_of(node)
        kind = node.op_type
        axis = attributes.get("axis", 0 if kind == "ArgMax" else 1)
        if kind in (*BEGINNINGS, "Concat") and axis not in (1, -1):
            raise self.refuse(node, f"got axis {axis}, expected 1, along the values of a frame")
        if kind in BEGINNINGS and read == [VALUES] and self.width < 2:
            raise self.refuse(node, f"takes {self.width} value, expected one for each class")
        if kind == "ArgMax" and attributes.get("select_last_index", 0):
            raise self.refuse(node, "select_last_index=1, expected 0, the first of equal values")
        if kind == "Sigmoid" and self.width != 1:
            raise self.refuse(
                node,
                f"makes probabilities of {self.width} classes that may hold at once, expected "
                "classes of which one holds",
            )
        if kind == "Sub" and np.ravel(self.constants.get(node.input[0], 0)).tolist() != [1]:
            raise self.refuse(node, "expected 1 minus the probability")
        if kind == "Concat" and read != [FIRST, SECOND]:
            raise self.refuse(node, "expected the probabilities of both classes, in their order")
        if kind in ("ArrayFeatureExtractor", "Gather"):
            if node.input[0] not in self.constants:
                raise self.refuse(node, f"reads {node.input[0]!r}, expected constant labels")
            self._name(node, self.constants[node.input[0]])
        elif kind == "ZipMap":
            named = [v for k, v in attributes.items() if k.startswith("classlabels")]
            self._name(node, [value for several in named for value in several])

    def _name(self, node: Any, values: Any) -> None:
        """Take labels, which must be as many as the classes and the same wherever they are."""
        labels = tuple(map(_label, np.ravel(np.asarray(values, dtype=object)).tolist()))
        classes = max(self.width, 2)
        if len(labels) != classes:
            raise self.refuse(node, f"got {len(labels)} labels, expected {classes}")
        if self.labels and labels != self.labels:
            raise self.refuse(node, f"got the labels {labels}, expected {self.labels} as before")
        self.labels = labels


def _label(value: Any) -> Label:
    return value.decode() if isinstance(value, bytes) else value


def followed(
    nodes: Sequence[Any],
    start: str,
    outputs: Sequence[str],
    constants: dict[str, Any],
    width: int,
    refuse: Refuse,
) -> Ending:
    """Follow the operators behind a network to the outputs of the graph.

    nodes: They begin with one of which ``begins`` is true.
    start: The name of the network's values.
    outputs: The names of the graph's outputs.
    constants: The values of constants by name.
    width: How many values the network gives.
    refuse: Makes the error about a node.
    """
    end = _End({start: VALUES}, constants, refuse, width)
    for node in nodes:
        end.step(node)
    for name in outputs:
        if name not in end.kinds and name not in constants:
            raise refuse(nodes[-1], f"gives no output {name!r} of the graph")
    return Ending(nodes[0].op_type, end.labels)
