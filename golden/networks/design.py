"""What all designs have in common: each turns one trained network into hardware."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, ClassVar, Self

import numpy as np

from golden.activation.activation_block import ActivationBlock
from golden.common.block import Block
from golden.common.port import Port
from golden.input_error import InputError
from golden.layers.argmax import ArgmaxTree
from golden.layers.input_controller import InputController
from golden.networks.network import Network
from golden.numbers.precision import EXACT, PRECISIONS, SIGNAL, Precision
from golden.trained.dense import DenseNetwork
from golden.trained.function import table_names


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
    known_activations: The activations that it can compute; empty for all but those whose codes
        stand for the middle of their step.
    activation_choices: Whether a scene may set options of the activation.
    learned_functions: Whether it takes networks of learned functions, and no others. Its words have
        only the bits that a scene gives them, so its outputs are further from the networks than
        those of other designs.
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
    learned_functions: ClassVar[bool] = False
    decides_itself: ClassVar[bool] = False
    most_nodes: ClassVar[int | None] = None
    options: ClassVar[tuple[str, ...]] = ()
    min_interval: int = field(default=1, kw_only=True)
    useless_nodes: int = field(default=0, kw_only=True)

    @classmethod
    def of(
        cls,
        networks: Sequence[DenseNetwork],
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
        for network in networks:
            cls._refuse_large(network)
        return cls.build(networks, settings, arrangement, variant)

    @classmethod
    def _refuse_large(cls, network: DenseNetwork) -> None:
        """Refuse what cannot be built, before minutes pass in which its weights are quantised.

        Only weights and nodes count that are not left out.
        """
        layers = network.layers
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

    def check_latencies(self, activations: Sequence[Block]) -> None:
        """All activations must answer in the same clock."""
        clocks = sorted({one.latency for one in activations})
        self.require(len(clocks) == 1, f"activations of latencies {clocks}", "one latency")

    @classmethod
    def build(
        cls, networks: Sequence[DenseNetwork], settings: Settings, arrangement: str, variant: str
    ) -> Self:
        """Make the design for ``of``, from settings that are already checked."""
        raise NotImplementedError

    def left_out_of(self, activations: Sequence[ActivationBlock] = ()) -> list[str]:
        """Texts about what all activations lack together, and about nodes that are not built."""
        counts = sum((one.parts_left_out() for one in activations), Counter[str]())
        texts = [f"{n} {what}" for what, n in sorted(counts.items())]
        if self.useless_nodes:
            texts.append(f"{self.useless_nodes} hidden nodes whose weights to the outputs are 0")
        return texts

    @classmethod
    def word_error(cls, _inputs: int, _options: Mapping[str, Any]) -> float:
        """How far the word of a hidden sum of learned functions is from the sum.

        It is a root mean square, as a part of the range of the sum. Training keeps the outputs
        from magnifying it. With 0, words are as good as exact.
        """
        return 0.0

    @classmethod
    def plain(cls, networks: Sequence[DenseNetwork]) -> list[DenseNetwork]:
        """The networks, for a design whose networks all have one hidden layer of tanh."""
        found = []
        for network in networks:
            if not network.plain:
                several = ((kind, len(table_names(kind))) for kind in network.activations)
                kinds = [kind if n < MOST_NAMED else f"{n} functions" for kind, n in several]
                raise InputError(
                    f"hardware.design: got {cls.block!r} for hidden layers of "
                    f"{', '.join(kinds) or 'none'}, expected 'engine', which takes "
                    "any, or a network of one hidden layer of tanh"
                )
            found.append(network)
        return found


@dataclass(frozen=True)
class AtOnce(Design):
    """A design that takes a frame in one clock and gives all its outputs in another.

    decides: Whether there are the index and the margin of the largest output.
    """

    arrangements = together = ("single", "multiple")
    precisions = (EXACT.name,)
    decides_itself = True
    stream = "words"
    decides: bool = field(default=False, kw_only=True)

    def __post_init__(self) -> None:
        _ = self.argmax

    @property
    def argmax(self) -> ArgmaxTree | None:
        return ArgmaxTree(SIGNAL, self.outputs) if self.decides else None

    @property
    def ports(self) -> tuple[Port, ...]:
        winner = self.argmax.serial.result_ports("winner") if self.argmax else ()
        return (*super().ports, *winner)

    @property
    def unreachable(self) -> dict[str, str]:
        return {"frame_error=1": "a frame a clock is never too close"}

    @property
    def interval(self) -> int:
        return self.min_interval

    @property
    def input_controller(self) -> InputController:
        """A frame is one element and always good, so no hardware decides about it."""
        return InputController(1, 0)
