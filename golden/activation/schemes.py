"""The activations that a scene can name, each with its real function and its bit-true block."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from golden.activation.activation_block import ActivationBlock
from golden.activation.bipartite import MEMORY, Bipartite, bipartite_for
from golden.activation.bipartite_table import FORMATS as BIPARTITE_FORMATS
from golden.activation.gradient import Gradient
from golden.activation.gradient_parallel import GradientParallel
from golden.activation.lut import lut_for, lut_real
from golden.activation.pade import ITERATIONS, RHO, pade_for, pade_real
from golden.activation.polynomial import polynomial_for, polynomial_real
from golden.activation.precise import Precise
from golden.activation.precise_table import FORMATS, curve_table
from golden.activation.segments import gradient_real, segment_table
from golden.input_error import InputError
from golden.mlp import Activation, tanh
from golden.precision import EXACT, PRECISIONS, SIGNAL, Precision
from golden.table import suggest

# The default of where the coefficients of ``precise`` are stored.
COEFFICIENTS = "logic"


def gradient_for(
    precision: Precision, factor: int, reach: int, kind: type[Gradient] = Gradient
) -> Gradient:
    """The Gradient activation for a neuron normalised by ``factor`` with magnitudes to ``reach``.

    ``kind`` is the block: ``Gradient`` with one multiplier, or ``GradientParallel``.

    Raises
    ------
    InputError
        When the factor is too large for the formats; see ``segments.segment_table``.
    """
    table = segment_table(
        factor,
        reach,
        precision.hidden_fmt,
        SIGNAL,
        precision.coeff_width,
        precision.gradient_frac_limit,
        precision.intercept_frac,
        precision.rounding,
    )
    return kind(
        precision.hidden_fmt,
        SIGNAL,
        table,
        precision.intercept_frac,
        precision.intercept_frac,
        precision.rounding,
        variant=f"q{factor}c{len(table.thresholds)}",
    )


def precise_for(
    precision: Precision, factor: int, reach: int, coefficients: str = COEFFICIENTS
) -> Precise:
    """The precise activation for a neuron whose magnitudes go up to ``reach``.

    Raises
    ------
    InputError
        When the precision's q has another format than that of the segments, or is normalised.
    """
    if precision.hidden_fmt != EXACT.hidden_fmt or factor != 1:
        raise InputError(
            f"activation precise: got q in {precision.hidden_fmt}, normalised by {factor}, of "
            f"precision {precision.name!r}, expected {EXACT.hidden_fmt} as it is, of precision "
            f"{EXACT.name!r}"
        )
    fmt = FORMATS[coefficients]
    most = len(curve_table(fmt).intercepts)
    reached = min(reach, precision.hidden_fmt.high) // (1 << fmt.distance_width) + 1
    # The number is a power of two, so that neurons of similar reach share an entity.
    words = min(1 << (reached - 1).bit_length(), most)
    return Precise(
        precision.hidden_fmt, SIGNAL, coefficients, words, variant=f"{coefficients}{words}"
    )


@dataclass(frozen=True)
class Option:
    """One option of an activation that a scene may set.

    Attributes
    ----------
    default : int, float or str
        Value where a scene sets none. Its type is the type that is expected.
    choices : tuple of str
        The texts that are allowed; empty for a number.
    real : bool
        Whether the activation in floating point depends on the option too.
    """

    default: Any
    choices: tuple[str, ...] = ()
    real: bool = False

    def check(self, value: object, place: str) -> Any:
        """Check a value and return the one to use.

        Raises
        ------
        InputError
            For another type, a number that is not above 0, or a text that is no choice. The message
            begins with ``place``.
        """
        kind = type(self.default)
        if kind is float and type(value) is int:
            value = float(value)
        if self.choices:
            if value not in self.choices:
                known = ", ".join(self.choices)
                hint = suggest(str(value), self.choices)
                raise InputError(f"{place}: got {value!r}, expected one of {known}{hint}")
        elif type(value) is not kind or not 0 < value < math.inf:  # type: ignore[operator]
            expected = {int: "a whole number above 0", float: "a number above 0"}[kind]
            raise InputError(f"{place}: got {value!r}, expected {expected}")
        return value


@dataclass(frozen=True)
class Scheme:
    """One activation that a scene can name.

    Attributes
    ----------
    real : callable
        Value and slope in floating point; training uses both for gradient descent.
    build : callable
        The bit-true block for a precision, a neuron's Q, and the largest magnitude code that the
        neuron can produce.
    options : mapping
        The options that a scene may set, by name. ``build`` takes every option as a keyword and has
        the same default; ``real`` takes those that concern it.
    precisions : tuple of Precision
        The precisions for which it is made.
    half_codes : bool
        Whether its codes stand for the middle of their steps; see ``ActivationBlock``.
    """

    real: Activation
    build: Callable[[Precision, int, int], ActivationBlock]
    options: Mapping[str, Option] = field(default_factory=dict)
    precisions: tuple[Precision, ...] = tuple(PRECISIONS.values())
    half_codes: bool = False

    def configured(self, given: Mapping[str, object], place: str = "activation_options") -> Scheme:
        """This scheme with some options set; the others keep their defaults.

        Raises
        ------
        InputError
            For an option that the scheme does not have, or a value that the option does not allow.
            The message begins with ``place``.
        """
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


SCHEMES = {
    "gradient": Scheme(gradient_real, gradient_for),
    "gradient_parallel": Scheme(gradient_real, partial(gradient_for, kind=GradientParallel)),
    "lut": Scheme(lut_real, lut_for),
    "pade": Scheme(
        pade_real,
        pade_for,
        {"rho": Option(RHO, real=True), "iterations": Option(ITERATIONS, real=True)},
    ),
    "polynomial": Scheme(polynomial_real, polynomial_for),
    "precise": Scheme(
        tanh,
        precise_for,
        {"coefficients": Option(COEFFICIENTS, tuple(FORMATS))},
        precisions=(EXACT,),
    ),
    "bipartite": Scheme(
        tanh,
        bipartite_for,
        {"memory": Option(MEMORY, tuple(BIPARTITE_FORMATS))},
        precisions=(EXACT,),
        half_codes=Bipartite.half_codes,
    ),
}


def forms() -> dict[str, Scheme]:
    """All schemes, and each scheme once more for every other choice of a text option."""
    found = dict(SCHEMES)
    for name, scheme in SCHEMES.items():
        for option, about in scheme.options.items():
            for choice in about.choices:
                if choice != about.default:
                    found[f"{name} {choice}"] = scheme.configured({option: choice})
    return found
