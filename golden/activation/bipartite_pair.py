"""bipartite_pair: computes tanh for two nodes with one pair of tables."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.activation.bipartite import Bipartite
from golden.common.block import Block
from golden.common.border import Border
from golden.common.port import CLOCKED, Port, group, input_port, output_port
from golden.input_error import InputError
from golden.numbers.fixed import Codes

NODES = 2


@dataclass(frozen=True)
class BipartitePair(Block):
    """Two nodes share one ``Bipartite`` activation, whose tables have a read port for each.

    activation: The activation of both nodes, with "block_ram", because a LUT has no second port.
    """

    block = "bipartite_pair"
    area = "activation"
    activation: Bipartite

    def __post_init__(self) -> None:
        if self.activation.memory != "block_ram":
            raise InputError(
                f"{self.entity}: got memory={self.activation.memory!r}, expected block_ram"
            )

    @property
    def ports(self) -> tuple[Port, ...]:
        node = self.activation
        return (
            *CLOCKED,
            input_port("in_valid", "`in_data` holds a code of either node"),
            *group(input_port("in_data", "q of node *", node.in_fmt, "in_fmt"), NODES),
            output_port("out_valid", "`out_data` holds a result of either node"),
            *group(output_port("out_data", "r of node *", node.out_fmt, "out_fmt"), NODES),
        )

    @property
    def latency(self) -> int:
        return self.activation.latency

    @property
    def borders(self) -> tuple[Border, ...]:
        return self.activation.borders

    def quantities(self, *inputs: Codes) -> dict[str, Codes]:
        return self.activation.quantities(np.concatenate(inputs))

    def process(self, first: ArrayLike, second: ArrayLike) -> tuple[Codes, Codes]:
        """Activation codes of both nodes, with the shapes of ``first`` and ``second``."""
        return self.activation.process(first), self.activation.process(second)


def pair_for(activation: Bipartite) -> BipartitePair:
    """The pair in which both nodes have this activation."""
    return BipartitePair(activation, variant=activation.variant)
