"""What the hardware must compute: a network as plain arithmetic, read from JSON.

`words` lists what is computed, in order; the first are the samples. A word is one of

- a sum: `sum` holds pairs of a word and a weight, `start` what the sum begins with. Its lowest
  `shift` bits are dropped (`round`: "down", "up" for the nearest and halves up, or "even"), the
  code is clipped to `clip`, and shifted left by `left`;
- a look-up: `table` names one of `tables`, `of` the word.

`place` names network, layer and node to which a word belongs, for messages alone.

A table lists `values` from the code `first` on, or is one of lines: `intercepts` and `slopes` of
segments of 2^`segment` codes (`both`: behind those of q >= 0 come those of q < 0; otherwise the
function is odd), of which the value, after 2^`shift` is divided out and halves are rounded up, is
clipped to `clip`.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from tactus.verify.every_frame.sums import Space, UnsupportedError, Value


class Network:
    """The network of that JSON; over values of a space, or over numbers."""

    def __init__(self, description: dict[str, Any]):
        self.given = description

    def words(self, space: Space, samples: Sequence[Value]) -> list[Value]:
        """Every word, in order."""
        words: list[Value] = list(samples)
        for word in self.given["words"]:
            if "table" in word:
                table = self.given["tables"][word["table"]]
                words.append(space.of(looked_up(table), words[word["of"]]))
            else:
                words.append(_summed(space, word, words))
        return words

    def outputs(self, words: Sequence[Value]) -> list[Value]:
        return [words[k] for k in self.given["outputs"]]


def _summed(space: Space, word: dict[str, Any], words: Sequence[Value]) -> Value:
    total: Value = word.get("start", 0)
    # Of a sum whose low bits pass beside the adder, the hardware takes floors part by part.
    for k, weight in sorted(word["sum"], key=lambda term: term[1] & -term[1]):
        if "shift" not in word:
            space.cut(total, words[k] * weight)
        total = total + words[k] * weight
    shift, rounding = word.get("shift", 0), word.get("round", "down")
    if shift and rounding == "even":
        odd = space.of(lambda a: a & 1, space.floor(total, shift))
        half = 1 << shift - 1
        up, down = space.floor(total + half, shift), space.floor(total + (half - 1), shift)
        code = space.choose(odd, up, down)
    else:
        code = space.floor(total + (1 << shift - 1 if shift and rounding == "up" else 0), shift)
    if "clip" in word:
        code = space.clip(code, *word["clip"])
    return code * (1 << word.get("left", 0))


def looked_up(table: dict[str, Any]) -> Callable[[Any], Any]:
    """The table as a function of codes."""
    if "values" in table:
        values, first = np.array(table["values"], dtype=np.int64), table["first"]

        def value(a: Any) -> Any:
            places = np.asarray(a) - first
            if (places < 0).any() or (places >= len(values)).any():
                raise UnsupportedError("the network looks up a code that its table does not have")
            return values[places]

        return value
    intercepts, slopes = (np.array(table[k], dtype=np.int64) for k in ("intercepts", "slopes"))
    span, both, shift = 1 << table["segment"], table["both"], table["shift"]
    segments = len(slopes) // (1 + both)

    def line(q: Any) -> Any:
        segment = np.minimum(np.where(q >= 0, q, -q - 1) // span, segments - 1)
        segment = segment + np.where(q < 0, segments, 0) if both else segment
        one = np.where(q >= 0, 1 << shift, -(1 << shift))
        total = intercepts[segment] * one + slopes[segment] * (q % span - span // 2)
        return (
            np.clip(total + (1 << shift >> 1) >> shift, *table["clip"])
            if "clip" in table
            else total
        )

    return line
