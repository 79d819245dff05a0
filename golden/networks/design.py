"""What every design has in common: hardware that one trained network becomes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Self

from golden.dense import Trained
from golden.fixed import Codes
from golden.input_error import InputError
from golden.mlp import Mlp
from golden.networks.bounds import two_layer_bounds
from golden.networks.constants import Constants, constants_of
from golden.networks.exact import ExactLayers
from golden.networks.network import Network
from golden.precision import PRECISIONS, Precision
from golden.real import Real


@dataclass(frozen=True)
class Design(Network):
    """A network of two layers in one form of hardware; a scene names it by its ``block``.

    A subclass in ``golden.networks`` is found by itself (``golden.networks.designs``).

    Attributes
    ----------
    arrangements : tuple of str
        Those in which a scene may use it.
    precisions : tuple of str
        Those that it is made for.
    known_activations : tuple of str
        Those that it computes; empty for all.
    half_codes : bool
        Whether it takes activations whose codes stand for the middle of their step.
    options : tuple of str
        Keys of the section ``[hardware]`` that are about this design alone.
    min_interval : int
        Clocks that whoever takes the outputs needs from one frame to the next.
    useless_nodes : int
        Hidden nodes that are not built, because no output uses them.
    """

    arrangements: ClassVar[tuple[str, ...]] = ()
    precisions: ClassVar[tuple[str, ...]] = tuple(PRECISIONS)
    known_activations: ClassVar[tuple[str, ...]] = ()
    half_codes: ClassVar[bool] = False
    options: ClassVar[tuple[str, ...]] = ()
    min_interval: int = field(default=1, kw_only=True)
    useless_nodes: int = field(default=0, kw_only=True)

    @classmethod
    def from_constants(cls, constants: Constants, variant: str = "") -> Self:
        """The design of a trained network.

        Parameters
        ----------
        constants : Constants
        variant : str
            Tells it from other networks of the same design.
        """
        raise NotImplementedError

    @classmethod
    def of(
        cls,
        network: Trained,
        precision: Precision,
        activation: str,
        options: Mapping[str, object] | None = None,
        variant: str = "",
        lean: bool = True,
        hardware: Mapping[str, object] | None = None,
    ) -> Self:
        """The design of a network in real weights; see ``constants_of``.

        ``hardware`` has what a scene chooses of the design's own ``options``.

        Raises
        ------
        InputError
            See ``plain``.
        """
        constants = constants_of(cls.plain(network), precision, activation, options, lean)
        return cls.from_constants(constants, variant)

    @classmethod
    def plain(cls, network: Trained) -> Mlp:
        """The network, for a design that takes no other than one hidden layer of tanh.

        Raises
        ------
        InputError
            For another one.
        """
        if not isinstance(network, Mlp):
            raise InputError(
                f"hardware.design: got {cls.block!r} for hidden layers of "
                f"{', '.join(network.activations)}, expected 'engine', which takes any, or a "
                "network of one hidden layer of tanh"
            )
        return network

    @classmethod
    def of_several(
        cls,
        arrangement: str,
        networks: Sequence[Trained],
        lean: bool = True,
        hardware: Mapping[str, object] | None = None,
        activation_options: Mapping[str, object] | None = None,
    ) -> Network | None:
        """All networks of a scene as one, for a design that arranges them by itself."""
        return None

    @property
    def hidden_weights(self) -> list[Sequence[int]]:
        """A code for each input of each hidden sum; their signs tell what drives it to an end."""
        return [node.weights for node in self.exact_layers.hidden]

    @property
    def exact_layers(self) -> ExactLayers:
        """What it computes, without anything that is shared, folded or cut."""
        raise NotImplementedError

    def exact(self, frames: Codes) -> Codes:
        """Output codes as integers of any width compute them, layer by layer."""
        return self.exact_layers.process(frames)

    def error_bounds(self, mlp: Mlp, precision: Precision, sensors: int) -> Real:
        """How far each output can be from real arithmetic that saturates, in real units.

        Parameters
        ----------
        mlp : Mlp
            The network that this is the design of, all of its hidden nodes built.
        precision : Precision
        sensors : int
            Inputs that are samples; those behind them are outputs of earlier networks.
        """
        return two_layer_bounds(mlp, precision, self.exact_layers.activations)
