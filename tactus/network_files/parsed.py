"""The content of a network file, which is the same for every form of file."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from golden.input_error import InputError
from golden.numbers.real import Real
from golden.trained.dense import LEAK, Quantiser
from golden.trained.function import Function

# The name or the number of a class.
Label = str | int


@dataclass(frozen=True)
class Ending:
    """What stands in a file behind the network, and tells the class from its outputs.

    operator: The first operator behind the network, such as "Softmax".
    labels: The label of each class in the order of the outputs; empty if the file has none. Of two
        classes with one output, the second holds where the output is above 0.
    """

    operator: str
    labels: tuple[Label, ...] = ()


@dataclass
class ParsedLayer:
    """A layer as it stands in a file. Each row of the weights is a node.

    leak: The slope of "leaky_relu" below 0.
    """

    weights: Real
    biases: Real
    activation: str = "linear"
    leak: float = LEAK
    quantiser: Quantiser | None = None


@dataclass(frozen=True)
class ParsedNetwork:
    """The layers of a file, not yet checked against each other; the last one is linear.

    functions: The functions that activations name and the file itself defines.
    ending: What makes a class of the outputs, in the file of a classifier.
    """

    layers: tuple[ParsedLayer, ...]
    functions: tuple[Function, ...] = ()
    ending: Ending | None = None

    @property
    def activations(self) -> tuple[str, ...]:
        return tuple(layer.activation for layer in self.layers[:-1])

    @property
    def labels(self) -> tuple[str, ...]:
        """The labels of a classifier, as texts; empty if the file has none."""
        return tuple(map(str, self.ending.labels)) if self.ending else ()


def file_of(path: Path) -> Path:
    """The file that holds a network: ``rig.npz`` for ``rig.npz/force``, one of several in it."""
    return next((one for one in path.parents if one.suffix == ".npz" and not one.is_dir()), path)


def name_in_file(path: Path) -> str:
    """The name of a network among several in its file; empty if the file holds only this one."""
    return "/".join(path.parts[len(file_of(path).parts) :])


def short_path(path: Path) -> Path:
    """The path of a network from the folder of its file on."""
    return path.relative_to(file_of(path).parent)


def real_numbers(path: Path, name: str, value: Any) -> Real:
    array = np.asarray(value)
    if array.dtype.kind not in "biuf":
        raise InputError(f"{path}: {name}: got {array.dtype}, expected real numbers")
    return array.astype(np.float64)


def for_labels(path: Path, held: ParsedNetwork, labels: Sequence[str]) -> ParsedNetwork:
    """The network of a file with an output for each label, in the order of the labels.

    A network of one output tells two classes apart: it is the second one where the output is above
    0, or above 1/2 if it is a sigmoid. It gets an output in front that is always at this limit, so
    the largest output decides in the same way. A sigmoid at the end is left out, because it changes
    nothing about which output is the largest.

    path: For messages.
    held: The shapes of its arrays need not be right; ``load_network`` checks them later.
    labels: Those of the scene. If the file has labels and these are the same texts, its outputs are
        sorted. If they are the numbers 0, 1, 2 and so on, they stand for the scene's labels in
        their order.
    """
    limit = 0.0
    *layers, last = held.layers
    passes_on = np.array_equal(last.weights, np.eye(np.size(last.biases))) and not last.biases.any()
    if passes_on and held.activations[-1:] == ("sigmoid",):
        if layers[-1].quantiser:
            limit = 0.5
        else:
            last = replace(layers.pop(), activation="linear")
    weights, biases = last.weights, last.biases
    if len(labels) == 2 and weights.ndim == 2 and len(weights) == np.size(biases) == 1:
        weights, biases = np.vstack([np.zeros_like(weights), weights]), np.append(limit, biases)
    found = held.labels
    if found and not stand_for_order(found, labels):
        if sorted(found) != sorted(labels):
            raise InputError(
                f"{path}: got a network for the classes {', '.join(found)}, expected "
                f"{', '.join(labels)}, the labels in data.classes of the scene"
            )
        if len(found) == len(weights) == np.size(biases):
            order = [found.index(label) for label in labels]
            weights, biases = weights[order], biases[order]
    return replace(held, layers=(*layers, replace(last, weights=weights, biases=biases)))


def stand_for_order(found: Sequence[str], labels: Sequence[str]) -> bool:
    """Whether the labels of a file only count the classes, from 0 on, and a scene has others."""
    counted = [str(n) for n in range(len(labels))]
    return list(found) == counted and sorted(labels) != sorted(counted)
