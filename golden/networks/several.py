"""What the arrangements of several networks share: each network gives one output, in order."""

from dataclasses import dataclass

from golden.input_error import InputError
from golden.layers.output_collector import OutputCollector
from golden.networks.design import Design
from golden.networks.network import Network
from golden.numbers.precision import SIGNAL


@dataclass(frozen=True)
class Several(Network):
    """Networks of one output each; see the subclasses.

    networks: One per output, in the order of the outputs.
    """

    networks: tuple[Design, ...]

    def _inputs_of(self, number: int) -> int:
        """The number of inputs that network ``number`` must have."""
        raise NotImplementedError

    def __post_init__(self) -> None:
        shapes = [(network.inputs, network.outputs) for network in self.networks]
        expected = [(self._inputs_of(i), 1) for i in range(len(shapes))]
        if len(shapes) < 2 or shapes != expected:
            raise InputError(
                f"{self.entity}: got networks of (inputs, outputs) {shapes}, expected two or more: "
                f"{expected}"
            )

    @property
    def inputs(self) -> int:
        return self.networks[0].inputs

    @property
    def outputs(self) -> int:
        return len(self.networks)

    @property
    def members(self) -> tuple[Network, ...]:
        return self.networks

    @property
    def output_collector(self) -> OutputCollector:
        return OutputCollector(SIGNAL, self.outputs)
