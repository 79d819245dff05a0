"""Power folding: raises a number to the power P on one multiplier."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.border import Border, border_among
from golden.common.port import CLOCKED, Port, Unsigned, input_port, output_port
from golden.input_error import InputError
from golden.numbers.fixed import Codes, Rounding, check_unsigned, cut


@dataclass(frozen=True)
class PowerFold(Block):
    """x = t**P, by using one multiplier P - 1 times (thesis section 5.8, Figure 5.25).

    in_width, in_frac: Format of the unsigned t.
    out_width, out_frac: Format of the unsigned power and of the accumulator; ``out_frac`` is at
        most ``in_frac``.
    max_power: Largest P, 2 or more. Every power takes as many clocks as this one.

    The accumulator starts from t, at the power's binary point, and is multiplied by t P - 1 times.
    Each product is rounded half up and saturated to 2**out_width - 1. A saturated accumulator stays
    saturated: it is larger than 1, so t is too, and the product is larger still.
    """

    block = "power_fold"
    section = "5.8"
    area = "visualisation"
    in_width: int
    in_frac: int
    out_width: int
    out_frac: int
    max_power: int

    def __post_init__(self) -> None:
        self.check(out_frac=(0, min(self.in_frac, self.out_width - 1)), max_power=(2, None))

    @property
    def interval(self) -> int:
        """Least clocks from one power to the next; each use of the multiplier takes two."""
        return 2 * (self.max_power - 1) + 1

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("in_valid", "t and P are there, for this clock"),
            input_port("in_data", "t", Unsigned(self.in_width, self.in_frac)),
            input_port("in_power", "P, 1 to `max_power`", Unsigned(self.power_width)),
            output_port("out_valid", "`out_data` holds a new power"),
            output_port(
                "out_data",
                "t^P, which stays until the clock in which the next pair comes",
                Unsigned(self.out_width, self.out_frac),
            ),
        )

    @property
    def unreachable(self) -> dict[str, str]:
        others = {0, *range(self.max_power + 1, 1 << self.power_width)}
        return {f"in_power={n}": f"P is 1 to {self.max_power}" for n in sorted(others)}

    @property
    def latency(self) -> int:
        return self.interval

    @property
    def power_width(self) -> int:
        return self.max_power.bit_length()

    @property
    def product_width(self) -> int:
        return self.in_width + self.out_width

    @property
    def borders(self) -> tuple[Border, ...]:
        return _borders(self)

    def powers(self, data: Codes) -> list[Codes]:
        """t, t^2 and so on up to the largest power, each before it saturates."""
        found = [cut(data, self.in_frac - self.out_frac, Rounding.ROUND)]
        for _ in range(1, self.max_power):
            acc = np.minimum(found[-1], (1 << self.out_width) - 1)
            found.append(cut(acc * data, self.in_frac, Rounding.ROUND))
        return found

    def quantities(self, *inputs: Codes) -> dict[str, Codes]:
        data, power = inputs
        return {f"power {n}": kept[power >= n] for n, kept in enumerate(self.powers(data), start=1)}

    def process(self, data: ArrayLike, power: ArrayLike) -> Codes:
        """The powers; the arguments are broadcast.

        data: The number t.
        power: The exponent P, 1 to ``max_power``.
        """
        t = check_unsigned(data, self.in_width, "power_fold data")
        p = np.asarray(power, dtype=np.int64)
        if p.size and not 1 <= p.min() <= p.max() <= self.max_power:
            worst = int(p.min() if p.min() < 1 else p.max())
            raise InputError(f"power_fold power: got {worst}, expected 1 to {self.max_power}")
        t, p = np.broadcast_arrays(t, p)
        acc = np.choose(p - 1, self.powers(t))
        return np.asarray(np.minimum(acc, (1 << self.out_width) - 1), dtype=np.int64)


@lru_cache
def _every(fold: PowerFold) -> list[Codes]:
    return fold.powers(np.arange(1 << fold.in_width, dtype=np.int64))


@lru_cache
def _borders(fold: PowerFold) -> tuple[Border, ...]:
    """The borders at which each power saturates, over every t."""
    return tuple(
        border_among(f"power {n} saturates", f"power {n}", 1 << fold.out_width, kept)
        for n, kept in enumerate(_every(fold), start=1)
    )


def border_data(fold: PowerFold) -> Codes:
    """Some values of t on both sides of each border."""
    pairs = zip(fold.borders, _every(fold), strict=True)
    return np.concatenate([border.closest(kept) for border, kept in pairs])
