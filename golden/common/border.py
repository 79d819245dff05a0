"""The values of numbers inside a block at which the block's behaviour changes."""

from dataclasses import dataclass

import numpy as np

from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class Border:
    """A value of a number at which a block's behaviour changes.

    A bench has to drive both sides of it.

    name: The behaviour that begins or ends there.
    quantity: The number that is compared, such as the exact sum before it is rounded.
    at: The least value on the upper side.
    within: The largest distance at which a value counts as next to the border. With 1 only ``at``
        and ``at - 1`` do.
    unreachable: Why no input brings the quantity to both sides; empty if some input does.
    """

    name: str
    quantity: str
    at: int
    within: int = 1
    unreachable: str = ""

    def closest(self, values: Codes) -> Codes:
        """The places of the values closest to the border, at most four on each side."""
        offset = values - self.at
        sides = (np.flatnonzero(offset < 0), np.flatnonzero(offset >= 0))
        orders = (np.argsort(np.abs(offset[side]), kind="stable") for side in sides)
        return np.concatenate([side[order[:4]] for side, order in zip(sides, orders, strict=True)])


@dataclass(frozen=True)
class State:
    """A number that a block holds, such as a counter; a bench reaches each of its values."""

    name: str
    values: range


def border_among(name: str, quantity: str, at: int, values: Codes) -> Border:
    """The border of a quantity for which these are all possible values.

    The values closest to the border count as next to it.
    """
    below, above = values[values < at], values[values >= at]
    if not len(below) or not len(above):
        why = f"over all inputs it is {values.min()} to {values.max()}"
        return Border(name, quantity, at, unreachable=why)
    within = max(at - int(below.max()), int(above.min()) - at + 1)
    return Border(name, quantity, at, within)
