"""Where a block begins to do something else: a value of an exact number inside it."""

from __future__ import annotations

from dataclasses import dataclass

from golden.fixed import Codes


@dataclass(frozen=True)
class Border:
    """A number from which on a block does something else than below.

    A bench has to drive both sides of it.

    Parameters
    ----------
    name : str
        What begins or ends there.
    quantity : str
        The number that reaches it, such as the exact sum before it is rounded.
    at : int
        The least value on the upper side.
    within : int
        How far from it a value counts as beside it: 1 is ``at`` and ``at - 1`` themselves.
    unreachable : str
        Why no input brings the quantity to both sides; empty where one does.
    """

    name: str
    quantity: str
    at: int
    within: int = 1
    unreachable: str = ""


@dataclass(frozen=True)
class State:
    """A number that a block holds, such as a counter; a bench reaches each of its values.

    Parameters
    ----------
    name : str
    values : range
    """

    name: str
    values: range


def border_among(name: str, quantity: str, at: int, values: Codes) -> Border:
    """The border for a quantity that takes no other values than these, over all inputs.

    A value counts as beside it when none is closer.
    """
    below, above = values[values < at], values[values >= at]
    if not len(below) or not len(above):
        why = f"over all inputs it is {values.min()} to {values.max()}"
        return Border(name, quantity, at, unreachable=why)
    within = max(at - int(below.max()), int(above.min()) - at + 1)
    return Border(name, quantity, at, within)
