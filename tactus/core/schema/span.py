"""The range in which a number may lie."""

import math
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Span:
    """The numbers between two ends, each of which may be missing. NaN and infinities never fit.

    least, most: Ends that are part of the range.
    above, below: Ends that are not part of the range.
    """

    least: float | None = None
    most: float | None = None
    above: float | None = None
    below: float | None = None

    def holds(self, value: float) -> bool:
        """Whether a number lies in the range."""
        return (
            math.isfinite(value)
            and (self.least is None or value >= self.least)
            and (self.most is None or value <= self.most)
            and (self.above is None or value > self.above)
            and (self.below is None or value < self.below)
        )

    def __str__(self) -> str:
        if self.least is not None:
            if self.most is None and self.below is None:
                return f"{self.least:g} or more"
            most = f"{self.most:.10g}" if self.below is None else f"below {self.below:g}"
            return f"{self.least:g} to {most}"
        ends = {"above {:g}": self.above, "below {:g}": self.below, "{:.10g} at most": self.most}
        return " and ".join(text.format(end) for text, end in ends.items() if end is not None)

    def schema(self) -> dict[str, Any]:
        """This range as a JSON schema."""
        words = {
            "minimum": self.least,
            "maximum": self.most,
            "exclusiveMinimum": self.above,
            "exclusiveMaximum": self.below,
        }
        return {word: end for word, end in words.items() if end is not None}
