"""Expressions as sums of functions of words."""

import math
import operator
from contextlib import suppress
from functools import reduce
from typing import Any

import numpy as np

from tactus.verify.every_frame.bits import Bits, Expression, X, join, pieces
from tactus.verify.every_frame.operators import CELLS, COMPARISONS, LINEAR, signed
from tactus.verify.every_frame.sums import MOST, Space, UnsupportedError, Value, ends


class Values:
    """What expressions are, over all frames. `samples` maps names to values."""

    def __init__(self, space: Space, samples: dict[str, Value]):
        self.space, self.samples = space, samples

    def number(self, v: Bits, width: int, sign: bool) -> Value:
        """The number that bits are, with or without a sign."""
        if isinstance(v, int):
            return signed(v, width) if sign else v
        return self.space.modulo(self.residue(v, width), width, sign)

    def residue(self, v: Bits, width: int) -> Value:
        """A number that is what the bits are, modulo 2^width."""
        if isinstance(v, int):
            return signed(v, width)
        if isinstance(v, Expression):
            return self.of(v)
        if v is X:
            raise UnsupportedError("something that nothing has set reaches a result")
        # Bits above that repeat the highest one are its sign.
        parts = list(v)
        while len(parts) > 1 and parts[-1] == (parts[-2][0], sum(parts[-2][1:]) - 1, 1):
            parts.pop()
        total: Value = 0
        place = 0
        for k, (source, low, count) in enumerate(parts):
            known = isinstance(source, int)
            piece = source if known else self.space.floor(self.residue(source, 0), low)
            if k < len(parts) - 1:
                piece = self.space.modulo(piece, count, False)
            total = total + piece * (1 << place)
            place += count
        return total if len(parts) == len(v) else self.space.modulo(total, place, True)

    def of(self, e: Expression) -> Value:
        if e.result is None:
            try:
                e.result = self._of(e)
            except UnsupportedError as reason:
                if not hasattr(reason, "place"):
                    reason.place = e.name  # type: ignore[attr-defined]
                raise
        return e.result

    def _of(self, e: Expression) -> Value:
        kind, space = e.kind, self.space
        if kind == "sample":
            return self.samples[e.extra]
        if kind == "$mux":
            s, yes, no = e.arguments
            c = self.number(s, 1, False)
            if isinstance(c, int):
                return self.residue(yes if c else no, e.width)
            return space.choose(c, *(self.residue(v, e.width) for v in (yes, no)))
        if kind == "read":
            return self._read(e)
        f = CELLS[kind]
        if kind in (*LINEAR, "$mul"):
            operands = [self.residue(v, n) for v, n, _ in e.arguments]
            if kind in LINEAR or any(isinstance(v, int) for v in operands):
                return f(*operands)
        if kind in ("$logic_not", "$reduce_or", "$reduce_bool"):
            # Piece by piece, since together they may be wider than a number, or else at once, since
            # pieces of one sum may be those of others.
            with suppress(UnsupportedError):
                parts = pieces(*e.arguments[0][:2])
                alone = [self.number(join((p,)), p[2], False) for p in parts]
                return space.of(lambda *n: f(reduce(operator.or_, n)), *alone)
        numbers = [self.number(v, n, s) for v, n, s in e.arguments]
        if kind == "$mul" and math.prod(max(map(abs, ends(v))) for v in numbers) >= MOST:
            raise UnsupportedError("a product of more than 62 bits")
        if kind in ("$eq", "$ne"):
            return space.of(lambda d: f(d, 0), numbers[0] - numbers[1])
        if kind in COMPARISONS:
            a, b = numbers
            less = space.negative(b - a if kind in ("$gt", "$le") else a - b)
            return less if kind in ("$lt", "$gt") else 1 - less
        return space.of(f, *numbers)

    def _read(self, e: Expression) -> Value:
        words = np.array([signed(w, e.width) if isinstance(w, int) else 0 for w in e.extra])
        known = np.array([isinstance(w, int) for w in e.extra])

        def looked_up(a: Any) -> Any:
            if (a < 0).any() or (a >= len(words)).any() or not known[a].all():
                raise UnsupportedError("a read of a word that nothing has set")
            return words[a]

        ((v, n, _),) = e.arguments
        return self.space.of(looked_up, self.number(v, n, False))
