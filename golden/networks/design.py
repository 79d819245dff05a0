"""What all designs have in common: each turns one trained network into hardware."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Self

from golden.fixed import Codes
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

    A subclass in ``golden.networks`` is found without being registered
    (``golden.networks.designs``).

    Attributes
    ----------
    arrangements : tuple of str
        The arrangements in which a scene may use it.
    precisions : tuple of str
        The precisions for which it is made.
    known_activations : tuple of str
        The activations that it can compute; empty for all.
    half_codes : bool
        Whether it accepts activations whose codes stand for the middle of their step.
    options : tuple of str
        Keys of the section ``[hardware]`` that belong to this design alone.
    min_interval : int
        Clocks from one frame to the next that the receiver of the outputs needs.
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
        """Build the design of a trained network.

        Parameters
        ----------
        constants : Constants
        variant : str
            Distinguishes it from other networks of the same design.
        """
        raise NotImplementedError

    @classmethod
    def of(
        cls,
        mlp: Mlp,
        precision: Precision,
        activation: str,
        options: Mapping[str, object] | None = None,
        variant: str = "",
        lean: bool = True,
        hardware: Mapping[str, object] | None = None,
    ) -> Self:
        """Build the design of a network with real weights; see ``constants_of``.

        ``hardware`` holds the design's own ``options`` that a scene sets.
        """
        return cls.from_constants(constants_of(mlp, precision, activation, options, lean), variant)

    @classmethod
    def of_several(
        cls,
        arrangement: str,
        mlps: Sequence[Mlp],
        lean: bool = True,
        hardware: Mapping[str, object] | None = None,
        activation_options: Mapping[str, object] | None = None,
    ) -> Network | None:
        """All networks of a scene as one network, for a design that arranges them itself."""
        return None

    @property
    def hidden_weights(self) -> list[Sequence[int]]:
        """A code for each input of each hidden sum; the signs tell what drives it to its limits."""
        return [node.weights for node in self.exact_layers.hidden]

    @property
    def exact_layers(self) -> ExactLayers:
        """The computation of the design without any sharing, folding or dropped bits."""
        raise NotImplementedError

    def exact(self, frames: Codes) -> Codes:
        """Output codes, computed layer by layer in integers of unlimited width."""
        return self.exact_layers.process(frames)

    def error_bounds(self, mlp: Mlp, precision: Precision, sensors: int) -> Real:
        """How far each output can be from saturating real arithmetic, in real units.

        Parameters
        ----------
        mlp : Mlp
            The network from which this design was made, with all of its hidden nodes built.
        precision : Precision
        sensors : int
            Number of inputs that are samples; the inputs behind them are outputs of earlier
            networks.
        """
        return two_layer_bounds(mlp, precision, self.exact_layers.activations)
