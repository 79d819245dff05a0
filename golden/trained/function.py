"""Functions of one variable that a scene defines, for activations that are tables."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from golden.input_error import InputError, naming, suggest
from golden.numbers.expression import evaluate
from golden.numbers.precision import EXACT, SIGNAL
from golden.numbers.real import Real
from golden.trained.spline_basis import DEGREE, Basis

# An activation that is a table begins with this text. The name of a function follows, or a name for
# each node, separated by commas.
TABLE = "table:"
# The format of the sum that a function takes. Sums beyond it saturate.
FMT = EXACT.hidden_fmt
LARGEST = 2.0 ** (FMT.width - 1 - FMT.frac)
LOW, HIGH = float(FMT.to_real(FMT.low)), float(FMT.to_real(FMT.high))
_STEP = 2.0**-FMT.frac
TANH_TEXT = "tanh(x)"
NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


@dataclass(frozen=True)
class Function:
    """A function of a hidden sum q, given by an expression, by points or by a spline.

    Sums saturate at the ends of their format, -8 and 8. Beyond these ends the function keeps the
    value that it has there.

    name: Letters, digits and underscores.
    expression: An expression of x; see ``golden.numbers.expression``. Empty where there are
        points or a spline.
    points: Points that are joined by straight lines, from left to right. Beyond the first and the
        last of them the function is level.
    spline: The ends of a range of equal intervals, the largest magnitude of a value, and then the
        coefficients of the cubic B-splines of the intervals; see ``golden.trained.spline_basis``.
        Beyond its range the function goes straight on. Where it would exceed its largest magnitude,
        it is level.
    frac: Fraction bits of the function's values in hardware; None for those with the least error.
    end: Beyond -end and end the function keeps its value; 8 at most.
    """

    name: str
    expression: str = ""
    points: tuple[tuple[float, float], ...] = ()
    spline: tuple[float, ...] = ()
    frac: int | None = None
    end: float = LARGEST

    def __post_init__(self) -> None:
        if not NAME.fullmatch(self.name):
            raise InputError(f"got the name {self.name!r}, expected letters, digits and _")
        if self.spline:
            low, high, most, *coefficients = (*self.spline, 0.0, 0.0)[: max(3, len(self.spline))]
            finite = np.isfinite(self.spline).all()
            if not (finite and low < high and most > 0 and len(coefficients) > DEGREE):
                raise InputError(
                    f"got a spline of {self.spline}, expected two ends that rise, a magnitude "
                    f"above 0 and {DEGREE + 1} coefficients or more, all finite"
                )
        elif not self.expression:
            places = [x for x, _ in self.points]
            if len(places) < 2 or not all(a < b for a, b in pairwise(places)):
                got = ", ".join(f"{x:g}" for x in places)
                raise InputError(f"x: got [{got}], expected two or more numbers that rise")
            if not np.isfinite(self.points).all():
                raise InputError("x, y: got NaN or infinity, expected finite numbers")
        # The table of tanh is computed in integers, so that it is the same on every processor. So
        # nothing computes tanh in floating point for it, not even here.
        elif self.expression != TANH_TEXT:
            self._check_values()

    def _check_values(self) -> None:
        q = FMT.to_real(np.arange(FMT.low, FMT.high + 1))
        bad = ~np.isfinite(self.value(q))
        if bad.any():
            raise InputError(
                f"got {self.expression!r}, which has no finite value at x = {q[bad][0]:g}, "
                f"expected one everywhere from {LOW:g} to {-LOW:g}"
            )

    def value(self, q: Real) -> Real:
        """The function at each sum."""
        x = np.clip(q, max(LOW, -self.end), min(HIGH, self.end))
        if self.expression:
            return evaluate(self.expression, x)
        if self.spline:
            low, high, most, *coefficients = self.spline
            basis = Basis(low, high, len(coefficients) - DEGREE)
            return np.asarray(basis.function(x, np.array(coefficients)).clip(-most, most))
        places, values = zip(*self.points, strict=True)
        return np.asarray(np.interp(x, places, values), dtype=np.float64)

    @property
    def goes_on(self) -> bool:
        """Whether its expression changes beyond the ends of sums, where the function is held."""
        if not self.expression or self.expression == TANH_TEXT:
            return False
        ends = np.array([LOW, -LOW])
        inside, beyond = (evaluate(self.expression, x) for x in (ends, 2 * ends))
        return not bool((np.abs(beyond - inside) < 2.0**-SIGNAL.frac).all())

    def slope(self, q: Real) -> Real:
        """The slope at each sum, from the values one code below and above; 0 beyond the ends."""
        rise: Real = self.value(q + _STEP) - self.value(q - _STEP)
        return rise / (2 * _STEP)


TANH = Function("tanh", TANH_TEXT)
# The function of a node that gives its sum as it is.
ITSELF = Function("itself", spline=(-8.0, 8.0, 8.0, *Basis(-8.0, 8.0, 1).centres.tolist()))


def functions_of(
    activation: str, nodes: int, known: Mapping[str, Function]
) -> tuple[Function, ...]:
    """The function of each node of a layer; none where the activation is no table.

    known: The functions that there are, by name.
    """
    names = table_names(activation)
    for name in names:
        if name not in known:
            expected = f"one of {', '.join(known)}" if known else "it in [network.functions]"
            hint = suggest(name, list(known))
            raise InputError(f"{activation!r}: no function {name!r}, expected {expected}{hint}")
    if names and len(names) not in (1, nodes):
        raise InputError(
            f"{activation!r}: got {len(names)} functions for {nodes} nodes, expected one for all, "
            "or one for each"
        )
    return tuple(known[name] for name in names) * (nodes if len(names) == 1 else 1)


def table_names(activation: str) -> list[str]:
    """The names of the functions in an activation; none where it is no table."""
    if not activation.startswith(TABLE):
        return []
    return [name.strip() for name in activation.removeprefix(TABLE).split(",")]


def by_name(functions: tuple[Function, ...]) -> dict[str, Function]:
    """The functions by their names."""
    return {function.name: function for function in functions}


def read_function(name: str, given: object) -> Function:
    """A function as a scene gives it: the text of an expression, or a table of ``x`` and ``y``."""
    with naming(f"network.functions.{name}"):
        if isinstance(given, str):
            if not given.strip():
                raise InputError("got an empty text, expected an expression of x")
            return Function(name, given)
        assert isinstance(given, dict)
        if set(given) != {"x", "y"}:
            raise InputError(
                f"got {', '.join(given) or 'nothing'}, expected x and y, or points alone"
            )
        x, y = given["x"], given["y"]
        if len(x) != len(y):
            raise InputError(f"y: got {len(y)} numbers, expected {len(x)}, one for each x")
        return Function(name, points=tuple(zip(map(float, x), map(float, y), strict=True)))
