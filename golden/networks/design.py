"""What all designs have in common: each turns one trained network into hardware."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, ClassVar, Self

import numpy as np

from golden.input_error import InputError
from golden.networks.network import Network
from golden.networks.settings import DEFAULTS, Settings
from golden.numbers.precision import PRECISIONS
from golden.trained.dense import Trained, layers_of
from golden.trained.function import table_names
from golden.trained.mlp import Mlp

# The words of the largest program, each for a weight. Nothing larger was ever exported.
MOST_WEIGHTS = 1 << 18

# A message names the functions of a layer if there are fewer than these.
MOST_NAMED = 4


@dataclass(frozen=True)
class Design(Network):
    """A network of two layers in one form of hardware; a scene names it by its ``block``.

    A subclass in ``golden.networks`` is found without being registered
    (``golden.networks.designs``).

    arrangements: The arrangements in which a scene may use it.
    together: The arrangements for which one design holds all networks.
    precisions: The precisions for which it is made.
    known_activations: The activations that it can compute; empty for all.
    activation_choices: Whether a scene may set options of the activation.
    half_codes: Whether it accepts activations whose codes stand for the middle of their step.
    learned_functions: Whether it takes networks of learned functions, and no others.
    coarse: Whether its words have only the bits that a scene gives them, so that its outputs are
        further from the networks than those of other designs.
    decides_itself: Whether it finds the largest output where a scene asks for it. A design whose
        outputs come one after the other leaves that to the readout.
    most_nodes: The most samples, hidden nodes and outputs of a network together; None for no limit.
    options: Keys of the section ``[hardware]`` that belong to this design alone.
    min_interval: Clocks from one frame to the next that the receiver of the outputs needs.
    useless_nodes: Hidden nodes that are not built, because no output uses them.
    """

    arrangements: ClassVar[tuple[str, ...]] = ()
    together: ClassVar[tuple[str, ...]] = ()
    precisions: ClassVar[tuple[str, ...]] = tuple(PRECISIONS)
    known_activations: ClassVar[tuple[str, ...]] = ()
    activation_choices: ClassVar[bool] = True
    half_codes: ClassVar[bool] = False
    learned_functions: ClassVar[bool] = False
    coarse: ClassVar[bool] = False
    decides_itself: ClassVar[bool] = False
    most_nodes: ClassVar[int | None] = None
    options: ClassVar[tuple[str, ...]] = ()
    min_interval: int = field(default=1, kw_only=True)
    useless_nodes: int = field(default=0, kw_only=True)

    @classmethod
    def of(
        cls,
        networks: Sequence[Trained],
        settings: Settings = DEFAULTS,
        arrangement: str = "single",
        variant: str = "",
    ) -> Self:
        """The design of trained networks.

        networks: One network, or all networks of an arrangement in ``together``.
        arrangement: How the networks are connected.
        variant: A name that distinguishes it from other networks of the same design.
        """
        asked = (
            ("precision", [settings.precision.name], cls.precisions),
            ("activation", [settings.activation], cls.known_activations),
            ("hardware", settings.options, cls.options or ("none",)),
        )
        for key, got, known in asked:
            for name in got:
                if known and name not in known:
                    raise InputError(
                        f"{cls.block}: {key}: got {name!r}, expected {' or '.join(known)}"
                    )
        if settings.activation_options and not cls.activation_choices:
            raise InputError(
                f"{cls.block}: activation_options: got {', '.join(settings.activation_options)}, "
                f"expected none: its {settings.activation} has one form"
            )
        for network in networks:
            cls._refuse_large(network)
        return cls.build(networks, settings, arrangement, variant)

    @classmethod
    def _refuse_large(cls, network: Trained) -> None:
        """Refuse what cannot be built, before minutes pass in which its weights are quantised.

        Only weights and nodes count that are not left out.
        """
        layers = layers_of(network)
        count = sum(np.count_nonzero(layer.weights) for layer in layers)
        nodes = sum(int((a.weights.any(1) & b.weights.any(0)).sum()) for a, b in pairwise(layers))
        nodes += network.shape[0] + network.shape[-1]
        for got, most, name in (
            (count, MOST_WEIGHTS, "weights"),
            (nodes, cls.most_nodes, "samples, hidden nodes and outputs"),
        ):
            if most is not None and got > most:
                shape = ":".join(map(str, network.shape))
                raise InputError(
                    f"{cls.block}: got {got} {name} of a {shape} network, expected {most} at most"
                )

    @classmethod
    def build(
        cls, networks: Sequence[Trained], settings: Settings, arrangement: str, variant: str
    ) -> Self:
        """Make the design for ``of``, from settings that are already checked."""
        raise NotImplementedError

    @classmethod
    def word_error(cls, _inputs: int, _options: Mapping[str, Any]) -> float:
        """How far the word of a hidden sum of learned functions is from the sum.

        It is a root mean square, as a part of the range of the sum. Training keeps the outputs
        from magnifying it. With 0, words are as good as exact.
        """
        return 0.0

    @classmethod
    def plain(cls, networks: Sequence[Trained]) -> list[Mlp]:
        """The networks, for a design whose networks all have one hidden layer of tanh."""
        found = []
        for network in networks:
            if not isinstance(network, Mlp):
                several = ((kind, len(table_names(kind))) for kind in network.activations)
                kinds = [kind if n < MOST_NAMED else f"{n} functions" for kind, n in several]
                raise InputError(
                    f"hardware.design: got {cls.block!r} for hidden layers of "
                    f"{', '.join(kinds) or 'none'}, expected 'engine', which takes "
                    "any, or a network of one hidden layer of tanh"
                )
            found.append(network)
        return found
