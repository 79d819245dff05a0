"""The outputs of a classifier's file, brought into the order of a scene's labels."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from golden.input_error import InputError
from tactus.network_files.parsed import ParsedNetwork


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
    if _ends_in_sigmoid(held):
        if any(held.quantisers[-1:]):
            limit = 0.5
        else:
            held = _without_last(held)
    last = len(held.activations) + 1
    weights, biases = (np.asarray(held.arrays[f"{kind}{last}"]) for kind in "wb")
    if len(labels) == 2 and weights.ndim == 2 and len(weights) == np.size(biases) == 1:
        weights, biases = np.vstack([np.zeros_like(weights), weights]), np.append(limit, biases)
    found = file_labels(held)
    if found and not stand_for_order(found, labels):
        if sorted(found) != sorted(labels):
            raise InputError(
                f"{path}: got a network for the classes {', '.join(found)}, expected "
                f"{', '.join(labels)}, the labels in data.classes of the scene"
            )
        if len(found) == len(weights) == np.size(biases):
            order = [found.index(label) for label in labels]
            weights, biases = weights[order], biases[order]
    return replace(held, arrays=held.arrays | {f"w{last}": weights, f"b{last}": biases})


def file_labels(held: ParsedNetwork) -> tuple[str, ...]:
    """The labels in a classifier's file, as texts; empty if it has none."""
    return tuple(map(str, held.ending.labels)) if held.ending else ()


def stand_for_order(found: Sequence[str], labels: Sequence[str]) -> bool:
    """Whether the labels of a file only count the classes, from 0 on, and a scene has others."""
    counted = [str(n) for n in range(len(labels))]
    return list(found) == counted and sorted(labels) != sorted(counted)


def _ends_in_sigmoid(held: ParsedNetwork) -> bool:
    """Whether the last layer only passes on the values of a sigmoid."""
    last = len(held.activations) + 1
    weights, biases = (np.asarray(held.arrays[f"{kind}{last}"]) for kind in "wb")
    passes_on = np.array_equal(weights, np.eye(np.size(biases))) and not np.any(biases)
    return held.activations[-1:] == ("sigmoid",) and passes_on


def _without_last(held: ParsedNetwork) -> ParsedNetwork:
    """The same network, with the sums of the layer before the last as its outputs."""
    last = len(held.activations) + 1
    arrays = {k: array for k, array in held.arrays.items() if k not in (f"w{last}", f"b{last}")}
    return replace(
        held,
        arrays=arrays,
        activations=held.activations[:-1],
        leaks=held.leaks[:-1],
        quantisers=held.quantisers[:-1],
    )
