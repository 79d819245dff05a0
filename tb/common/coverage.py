"""Counts what a bench has reached: the sides of borders, the values of ports, and states."""

from collections import Counter
from collections.abc import Iterable

import numpy as np

from golden.common.block import Block
from golden.common.border import State
from golden.common.port import Port
from golden.numbers.fixed import Fix

# Every value of a port with at most so many bits is counted, and both ends of a wider one.
SMALL = 6

# By kind ("borders", "ports", "states") and name: how often each side or value was reached.
Counts = dict[str, dict[str, dict[str, int]]]


def add(total: Counts, more: Counts) -> None:
    """Add counts to others."""
    for kind, entries in more.items():
        for name, found in entries.items():
            kept = total.setdefault(kind, {}).setdefault(name, {})
            for value, count in found.items():
                kept[value] = kept.get(value, 0) + count


class Coverage:
    """The counts of one test.

    twin: The twin names everything that can be reached.
    """

    def __init__(self, twin: Block) -> None:
        self.borders = twin.borders
        self.ports = {port.name: port for port in twin.ports}
        self.counts: Counts = {}

    def meet(self, quantity: str, values: np.ndarray) -> None:
        """Count the values of a quantity on either side of each of its borders."""
        for border in self.borders:
            if border.quantity == quantity:
                offsets = values - border.at
                below = np.count_nonzero((offsets < 0) & (offsets >= -border.within))
                above = np.count_nonzero((offsets >= 0) & (offsets < border.within))
                found = {"below": int(below), "from": int(above)}
                add(self.counts, {"borders": {border.name: found}})

    def visit(self, state: State, values: np.ndarray) -> None:
        """Count the values that a state took. Values that it did not take count 0."""
        met = Counter(np.asarray(values).tolist())
        found = {str(value): met[value] for value in state.values}
        add(self.counts, {"states": {state.name: found}})

    def count_port(self, port: str, words: Iterable[str]) -> None:
        """Count the values of a port."""
        if port in self.ports:
            met, width = Counter(words), self.ports[port].width or 1
            values = values_of(self.ports[port])
            bits = {value: f"{value % (1 << width):0{width}b}" for value in values}
            found = {str(value): met[word] for value, word in bits.items()}
            add(self.counts, {"ports": {port: found}})


def values_of(port: Port) -> list[int]:
    """The values of a port that are counted."""
    if port.kind is None:
        return [0, 1]
    if isinstance(port.kind, Fix):
        return [port.kind.low, port.kind.high]
    if port.width <= SMALL:
        return list(range(port.kind.last + 1))
    return [0, port.kind.last]


def missing(twin: Block, counts: Counts) -> list[str]:
    """What the twin names and no test reached, without what it declares unreachable.

    Both ends of signed inputs must be reached. The ends of other wide ports depend on constants, as
    the number of a network's largest output does, so they are counted but need not be reached.
    """
    found = []
    for border in twin.borders:
        met = counts.get("borders", {}).get(border.name, {})
        for side, where in (("below", border.at - 1), ("from", border.at)):
            if not border.unreachable and not met.get(side):
                found.append(f"border {border.name}: nothing at {where}")
    states = {state.name: dict.fromkeys(map(str, state.values), 0) for state in twin.states}
    for name, met in (states | counts.get("states", {})).items():
        found += [f"state {name}: never {value}" for value, count in met.items() if not count]
    for port in twin.ports:
        ends = port.direction == "in" and port.signed
        if port.name == "clk" or port.by_weights or (port.width > SMALL and not ends):
            continue
        met = counts.get("ports", {}).get(port.name, {})
        found += [
            f"port {port.name}: never {value}"
            for value in values_of(port)
            if not met.get(str(value)) and f"{port.name}={value}" not in twin.unreachable
        ]
    return found
