"""What an activation publishes for scenes: its real function, its bit-true block, its options."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from golden.activation.activation_block import ActivationBlock
from golden.input_error import InputError, suggest
from golden.numbers.precision import EXACT, PRECISIONS, Precision
from golden.trained.dense import Activation


@dataclass(frozen=True)
class Option:
    """One option of an activation that a scene may set.

    default: Value where a scene sets none. Its type is the type that is expected.
    choices: The texts that are allowed; empty for a number.
    real: Whether the activation in floating point depends on the option too.
    """

    default: Any
    choices: tuple[str, ...] = ()
    real: bool = False

    def check(self, value: object, place: str) -> Any:
        """Check a value and return the one to use."""
        kind = type(self.default)
        used = float(value) if kind is float and type(value) is int else value
        if self.choices:
            if value not in self.choices:
                known = ", ".join(self.choices)
                hint = suggest(str(value), self.choices)
                raise InputError(f"{place}: got {value!r}, expected one of {known}{hint}")
        elif type(used) is not kind or not 0 < used < math.inf:  # type: ignore[operator]
            expected = {int: "a whole number above 0", float: "a number above 0"}[kind]
            raise InputError(f"{place}: got {value!r}, expected {expected}")
        return used


@dataclass(frozen=True)
class Scheme:
    """One activation that a scene can name.

    real: Value and slope in floating point; training uses both for gradient descent.
    build: The bit-true block for a precision, a neuron's Q, and the largest magnitude code that the
        neuron can produce.
    options: The options that a scene may set, by name. ``build`` takes every option as a keyword
        and has the same default; ``real`` takes those that concern it.
    precisions: The precisions for which it is made.
    half_codes: Whether its codes stand for the middle of their steps; see ``ActivationBlock``.
    of_tanh: Whether it approximates tanh: odd, and leaves out what a neuron does not reach.
    """

    real: Activation
    build: Callable[[Precision, int, int], ActivationBlock]
    options: Mapping[str, Option] = field(default_factory=dict)
    precisions: tuple[Precision, ...] = tuple(PRECISIONS.values())
    half_codes: bool = False
    of_tanh: bool = True

    def configured(self, given: Mapping[str, object], place: str = "activation_options") -> Scheme:
        """This scheme with some options set; the others keep their defaults."""
        for name in given:
            if name not in self.options:
                known = ", ".join(self.options) or "none"
                raise InputError(
                    f"{place}: option {name!r} is not known, expected {known}"
                    f"{suggest(name, list(self.options))}"
                )
        chosen = {
            name: self.options[name].check(value, f"{place}.{name}")
            for name, value in given.items()
        }
        if not chosen:
            return self
        concerned = {name: value for name, value in chosen.items() if self.options[name].real}
        real = partial(self.real, **concerned) if concerned else self.real
        return replace(self, real=real, build=partial(self.build, **chosen))


def require_exact(name: str, precision: Precision, factor: int) -> None:
    """Refuse sums for which an activation of the exact precision is not made."""
    if precision.hidden_fmt != EXACT.hidden_fmt or factor != 1:
        raise InputError(
            f"activation {name}: got q in {precision.hidden_fmt}, normalised by {factor}, of "
            f"precision {precision.name!r}, expected {EXACT.hidden_fmt} as it is, of precision "
            f"{EXACT.name!r}"
        )
