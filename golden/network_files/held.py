"""What a network file holds, whichever form it has."""

from __future__ import annotations

from dataclasses import dataclass

from golden.dense import LEAK, Quantiser
from golden.real import Real


@dataclass(frozen=True)
class Held:
    """The arrays of a file, not yet checked against each other.

    Parameters
    ----------
    arrays : dict
        ``w1`` and ``b1`` of the first layer, and so on; nodes stand in the rows of the weights.
    activations : tuple of str
        That of each layer, all but the last, which is linear.
    leaks : tuple of float
        Of the same layers, the slope of "leaky_relu" below 0; empty where there is none.
    quantisers : tuple of Quantiser or None
        Of the same layers; empty where there is none.
    """

    arrays: dict[str, Real]
    activations: tuple[str, ...] = ("tanh",)
    leaks: tuple[float, ...] = ()
    quantisers: tuple[Quantiser | None, ...] = ()

    @property
    def names(self) -> list[str]:
        """Those of the arrays that there must be, layer by layer."""
        return [f"{kind}{n + 1}" for n in range(len(self.activations) + 1) for kind in "wb"]

    def leak(self, layer: int) -> float:
        """The slope of a layer's "leaky_relu" below 0."""
        return self.leaks[layer] if self.leaks else LEAK

    def quantiser(self, layer: int) -> Quantiser | None:
        """What stands behind the activation of a layer; the last has none."""
        return self.quantisers[layer] if layer < len(self.quantisers) else None
