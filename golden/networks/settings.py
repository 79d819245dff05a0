"""What is chosen of a design's hardware, as the section ``[hardware]`` of a scene names it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from golden.precision import EXACT, Precision


@dataclass(frozen=True)
class Settings:
    """Everything beside the weights that the hardware of a network depends on.

    Attributes
    ----------
    precision : Precision
    activation : str
        A name of ``SCHEMES``.
    activation_options : mapping
        What is chosen of the activation's options.
    options : mapping
        What is chosen of the design's own ``options``.
    lean : bool
        Leave out what the weights make useless: hidden nodes, segments of activations, terms of a
        sum. Results are the same either way.
    """

    precision: Precision = EXACT
    activation: str = EXACT.activation
    activation_options: Mapping[str, object] = field(default_factory=dict)
    options: Mapping[str, object] = field(default_factory=dict)
    lean: bool = True


# The exact precision with its own activation, and every option as a design has it.
DEFAULTS = Settings()
