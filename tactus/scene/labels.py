"""The labels of a scene whose networks tell classes apart: ``data.classes``.

Each label is an output of the network, and the class of a frame is that of the largest output. Of
equal outputs the first one counts. A network file holds logits, which have no fixed range. In the
hardware all outputs of a network are divided by one power of two, with which the recorded rows stay
within the range of the codes. This changes no decision, except by rounding.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.input_error import InputError
from golden.numbers.real import Real
from golden.trained.dense import DenseNetwork
from tactus.core.table import as_number, read_texts, rows_where
from tactus.network_files.network_file import provenance_path, read_provenance
from tactus.scene.scale import Scale

if TYPE_CHECKING:
    from tactus.scene.scene import Scene

# A network of a thousand outputs would not fit into any design.
MOST_LABELS = 256
# What pandas and numpy write where there is no label, in small letters.
MISSING = ("nan", "<na>")
# How far the outputs of other rows may exceed those of the recorded rows.
BEYOND = 1.25

_WHOLE = re.compile(r"[-+]?[0-9]+")


def read_labels(
    paths: Sequence[Path], where: Mapping[str, float | str], column: str
) -> tuple[str, ...]:
    """The different labels in a column, whole numbers by value and texts by alphabet."""
    found: list[str] = []
    for path in paths:
        texts = read_texts(path, column)
        found += [texts[row] for row in rows_where(path, where)]
    return ordered(found, f"{', '.join(map(str, paths))}: column {column!r}")


def ordered(rows: Sequence[str], place: str) -> tuple[str, ...]:
    """The labels of some rows in their order; see ``read_labels``."""
    labels = set(rows)
    missing = sorted(label for label in labels if label.lower() in MISSING)
    if missing:
        raise InputError(
            f"{place}: got {missing[0]!r} in {rows.count(missing[0])} rows, which stands for no "
            "label, expected one in every row"
        )
    if len(labels) == len(rows) > 2:
        raise InputError(
            f"{place}: got another label in each of {len(rows)} rows, expected a column whose "
            "labels repeat"
        )
    if not 2 <= len(labels) <= MOST_LABELS:
        shown = ", ".join(map(repr, sorted(labels)[:3]))
        more = ", ..." if len(labels) > 3 else ""
        raise InputError(
            f"{place}: got {len(labels)} labels, {shown}{more}, expected 2 to {MOST_LABELS}"
        )
    if all(map(_WHOLE.fullmatch, labels)):
        numbers = {int(label): label for label in labels}
        for label in labels:
            if numbers[int(label)] != label:
                raise InputError(
                    f"{place}: got the labels {label!r} and {numbers[int(label)]!r}, which are one "
                    "number, expected one way to write it"
                )
        return tuple(numbers[number] for number in sorted(numbers))
    numeric = [label for label in sorted(labels) if as_number(label) is not None]
    if len(numeric) == len(labels):
        broken = next(label for label in numeric if not _WHOLE.fullmatch(label))
        raise InputError(
            f"{place}: got the label {broken!r}, expected text or whole numbers; a measured "
            "quantity is a column of data.outputs"
        )
    return tuple(sorted(labels))


def one_hot(texts: Sequence[str], labels: Sequence[str]) -> Real:
    """For each row 1 in the column of its label and 0 in the others, shape (rows, labels)."""
    return (np.array(texts)[:, np.newaxis] == np.array(labels)).astype(np.float64)


def decided(outputs: ArrayLike) -> NDArray[np.int64]:
    """The number of the class of each row; of equal outputs the first one counts."""
    return np.asarray(outputs).argmax(axis=-1)


def margins(outputs: NDArray[Any]) -> NDArray[Any]:
    """By how much the largest output of each row exceeds the second largest."""
    second, first = np.moveaxis(np.sort(outputs, axis=-1)[..., -2:], -1, 0)
    return first - second


def wrong_percent(outputs: Real, targets: Real) -> Real:
    """For each row and class 100 if the decision is wrong about the class, else 0.

    A row whose class is taken for another one is wrong about both of these. ``outputs`` may have
    further dimensions in front of those of the one-hot ``targets``.
    """
    return 100.0 * (np.eye(targets.shape[-1])[decided(outputs)] != targets)


def class_scale(network: DenseNetwork, readings: Real) -> Scale:
    """The common scale of a network's logits, from the readings of all recorded rows."""
    largest = float(np.abs(network.process(readings)).max())
    return Scale(0.0, 2.0 ** math.ceil(math.log2(BEYOND * largest)) if largest else 1.0)


def check_labels(scene: Scene) -> None:
    """Refuse a network that was trained here for other labels than the scene has."""
    for path in scene.weights_paths:
        labels = (read_provenance(path) or {}).get("labels")
        if labels is not None and tuple(labels) != scene.labels:
            raise InputError(
                f"{provenance_path(path)}: got a network for the labels {', '.join(labels)}, "
                f"expected {', '.join(scene.labels)}, those in column {scene.classes!r} of "
                f"{scene.data_text}; run make train"
            )
