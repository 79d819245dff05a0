"""Finds layers whose nodes are sums of functions, which an engine adds up without words between.

A network of learned functions, y = sum over i of f_i(x_i), is a network of layers: the nodes of one
layer take one value each and look up its function, and the next layer adds them up with weights of
1, or of a small whole number. Compiled node by node, a function would take a product that copies
its value, two that look it up, and one that adds it. An engine needs only the two in the middle:
the intercept and the slope of the segment are products of the sum itself, and the word of the value
is read as it is.
"""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from golden.engine.formats import HIDDEN, RESULT
from golden.engine.function_table import fits
from golden.engine.grid import Exact, Value
from golden.numbers.precision import SIGNAL
from golden.trained.function import ITSELF, TANH

# A function that is larger than a word is added in parts, so often at most.
MOST_TIMES = 8
# What is left of a weight that was multiplied by a scale and divided by it.
ROUNDING = Fraction(1, 1 << 40)


def added_up(layers: Sequence[Exact], values: Sequence[Value]) -> list[Exact]:
    """The layers, where those that only add up functions take them as their own.

    values: The operands of the first layer.
    """
    found: list[Exact] = []
    for layer in layers:
        before = found[-1] if found else None
        copies = before is not None and len(found) == 1 and _copies(before, values)
        if before and copies:
            before = _within_reach(before, values)
        if before and _adds(before, layer):
            layer = _taken(before, layer)
            if copies:
                found = []
                layer = _from_inputs(before, layer)
            else:
                found[-1], layer = _each_once(before, layer)
        found.append(layer)
    return found


def _adds(before: Exact, layer: Exact) -> bool:
    """Whether a layer does nothing with the functions of the one before but add them up."""
    target = _target(layer)
    if not before.functions or TANH in before.functions or target is None:
        return False
    times = [
        list(map(_times, layer.weights[:, k]))
        for k, function in enumerate(before.functions)
        if function != ITSELF
    ]
    fitting = all(fits(function, target) for function in before.functions if function != ITSELF)
    if not fitting or min(map(min, times), default=0) < 0:
        return False
    # Where there are functions and every weight is 0, there is nothing to add up.
    return not times or max(map(max, times)) > 0


def _target(layer: Exact) -> int | None:
    """The fraction bits of a layer's sums, if these do not depend on its weights."""
    if layer.grid or not (layer.functions or layer.output):
        return None
    return HIDDEN.frac if layer.functions else RESULT.frac


def _taken(before: Exact, layer: Exact) -> Exact:
    """A layer with the functions of the one before, which gives it its sums."""
    target = _target(layer)
    products = [function == ITSELF for function in before.functions]
    added = [
        [
            (k, replace(function, frac=target))
            for k, function in enumerate(before.functions)
            if not products[k]
            for _ in range(_times(row[k]))
        ]
        for row in layer.weights
    ]
    return replace(layer, weights=layer.weights * products, added=added)


def _each_once(before: Exact, layer: Exact) -> tuple[Exact, Exact]:
    """The layer before as sums alone, equal ones once, and the layer with their new places."""
    sums = [
        (tuple(row), bias, tuple(added))
        for row, bias, added in zip(
            before.weights, before.biases, before.added or [[]] * len(before.weights), strict=True
        )
    ]
    place = {one: n for n, one in enumerate(dict.fromkeys(sums))}
    kept = [sums.index(one) for one in place]
    places = np.array([place[one] for one in sums])
    columns = [layer.weights[:, places == n].sum(axis=1) for n in range(len(kept))]
    before = replace(
        before,
        activation="sums",
        functions=(),
        weights=before.weights[kept],
        biases=before.biases[kept],
        added=[before.added[k] for k in kept] if before.added else [],
    )
    added = [[(place[sums[k]], function) for k, function in node] for node in layer.added]
    return before, replace(layer, weights=np.stack(columns, axis=1), added=added)


def _copies(layer: Exact, values: Sequence[Value]) -> bool:
    """Whether every node of the first layer looks up a function of the word of one operand."""
    if not layer.functions:
        return False
    for row, bias in zip(layer.weights, layer.biases, strict=True):
        if np.count_nonzero(row) != 1:
            return False
        value = values[_only(row)]
        weight = Fraction(2) ** (value.fmt.frac - HIDDEN.frac)
        # An earlier output comes with half a unit of its last place added.
        half = weight / (2 << SIGNAL.frac) if value.earlier else Fraction(0)
        if not (_near(row[_only(row)], weight) and abs(bias - half) < ROUNDING):
            return False
    return True


def _times(weight: Fraction) -> int:
    """How often a function is added for a weight; -1 for one that is not a small whole number."""
    times = round(weight)
    if not weight:
        return 0
    return times if 0 < times <= MOST_TIMES and _near(weight, Fraction(times)) else -1


def _near(found: Fraction, wanted: Fraction) -> bool:
    """Whether a weight is what it was before a file with scales rounded it."""
    return abs(found - wanted) < ROUNDING * wanted


def _within_reach(layer: Exact, values: Sequence[Value]) -> Exact:
    """A layer of copies whose functions keep their values where no word of an operand is."""
    ends = [
        max(-value.low, value.high) * 2.0**-HIDDEN.frac
        for value in (values[_only(row)] for row in layer.weights)
    ]
    functions = tuple(
        function if function in (ITSELF, TANH) else replace(function, end=end)
        for function, end in zip(layer.functions, ends, strict=True)
    )
    return replace(layer, functions=functions)


def _only(row: NDArray[Any]) -> int:
    return int(np.flatnonzero(row)[0])


def _from_inputs(before: Exact, layer: Exact) -> Exact:
    """A layer that takes the operands themselves in the place of copies."""
    sources = [_only(row) for row in before.weights]
    weights = layer.weights @ before.weights
    biases = layer.biases + layer.weights @ before.biases
    added = [[(sources[k], function) for k, function in node] for node in layer.added]
    return replace(layer, weights=weights, biases=biases, added=added)
