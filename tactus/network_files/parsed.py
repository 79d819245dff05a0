"""The content of a network file, which is the same for every form of file."""

from dataclasses import dataclass
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


@dataclass(frozen=True)
class ParsedNetwork:
    """The arrays of a file, not yet checked against each other.

    arrays: ``w1`` and ``b1`` of the first layer, and so on. Each row of the weights is a node.
    activations: The activation of each layer except the last, which is linear.
    leaks: The slopes of "leaky_relu" below 0 in the same layers; empty if there are none.
    quantisers: The quantisers of the same layers; empty if there are none.
    ending: What makes a class of the outputs, in the file of a classifier.
    functions: The functions that activations name and the file itself defines.
    """

    arrays: dict[str, Real]
    activations: tuple[str, ...] = ("tanh",)
    leaks: tuple[float, ...] = ()
    quantisers: tuple[Quantiser | None, ...] = ()
    ending: Ending | None = None
    functions: tuple[Function, ...] = ()

    @property
    def names(self) -> list[str]:
        """The names of the arrays that must be there, layer by layer."""
        return [f"{kind}{n + 1}" for n in range(len(self.activations) + 1) for kind in "wb"]

    def leak(self, layer: int) -> float:
        """The slope of a layer's "leaky_relu" below 0."""
        return self.leaks[layer] if self.leaks else LEAK

    def quantiser(self, layer: int) -> Quantiser | None:
        """The quantiser behind the activation of a layer; the last layer has none."""
        return self.quantisers[layer] if layer < len(self.quantisers) else None


def real_numbers(path: Path, name: str, value: Any) -> Real:
    """Turn an array into float64."""
    array = np.asarray(value)
    if array.dtype.kind not in "biuf":
        raise InputError(f"{path}: {name}: got {array.dtype}, expected real numbers")
    return array.astype(np.float64)
