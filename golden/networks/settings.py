"""The settings of a design's hardware, as the section ``[hardware]`` of a scene gives them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from golden.numbers.precision import EXACT, Precision


@dataclass(frozen=True)
class Settings:
    """Everything on which the hardware of a network depends, except its weights.

    activation: A name of ``SCHEMES``.
    activation_options: The options of the activation that are set.
    options: The options of the design that are set.
    lean: Whether to leave out what the weights make useless: hidden nodes, segments of activations,
        and terms of a sum. The results are the same either way.
    met: For each network the largest magnitudes on recorded frames (``golden.engine.ranges``);
        empty where no frames are known.
    reached: For each network the least and the largest sum of each node of its last hidden layer on
        recorded frames, where these nodes have functions; else empty.
    """

    precision: Precision = EXACT
    activation: str = EXACT.activation
    activation_options: Mapping[str, object] = field(default_factory=dict)
    options: Mapping[str, object] = field(default_factory=dict)
    lean: bool = True
    met: Sequence[Sequence[float]] = ()
    reached: Sequence[Sequence[tuple[float, float]]] = ()


# The exact precision with its own activation, and the default of every option.
DEFAULTS = Settings()
