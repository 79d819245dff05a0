"""bipartite: tanh from two tables, without a multiplier."""

from collections import Counter
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from golden.activation.activation_block import TABLE_WORDS, ActivationBlock
from golden.activation.bipartite_table import (
    CORRECTED_WIDTH,
    FINE_WIDTH,
    FORMATS,
    MAGNITUDE_WIDTH,
    RESULT,
    TOP,
    BipartiteFormat,
    BipartiteTable,
    bipartite_table,
)
from golden.activation.scheme import Option, Scheme, require_exact
from golden.common.block import Block
from golden.common.port import CLOCKED, Port, group, input_port, output_port
from golden.numbers.fixed import Codes, Fix
from golden.numbers.precision import EXACT, Precision
from golden.trained.dense import tanh

# The default of where the tables are stored.
MEMORY = "block_ram"
# The nodes of a pair.
NODES = 2


@dataclass(frozen=True)
class Bipartite(ActivationBlock):
    """r = tanh(q) as the sum of a base and a correction from two tables (Das Sarma, Matula 1995).

    A code stands for the middle of its step: a code c of q or of r stands for (c + 1/2) 2**-14. Let
    the sign s of q be all ones where q is below 0. Then the magnitude is q xor s, and r =
    floor((base(magnitude) xor s) + correction(magnitude, q)).

    in_fmt, out_fmt: Formats of q and r: any format with 14 fraction bits, and Fix(15,14).
    memory: Where the tables are stored: "block_ram", or "logic" for smaller tables in LUTs.
    reach_width: Bits of the largest magnitude that the neuron can reach; words beyond it are left
        out. More than 17 where q can reach 8, from where on the result is the largest.

    The sum is exact and never overflows. The function is monotone and, in terms of its codes, odd:
    the result of a complement is the complement of the result.

    Over all 262144 codes of Fix(18,14) (tests/test_schemes.py): with "block_ram" every result is
    within 0.708 units of 2**-13 of tanh(q), and 23416 results are not the nearest code. With
    "logic" these figures are 4.497 units and 90322 results.

    A magnitude beyond the neuron's reach gets the result of some other magnitude.
    """

    block = "bipartite"
    half_codes = True
    # The clocks are those of q, which may come straight from an adder; of a block RAM, or of an
    # address; of the word; and of the sum.
    latency = 4
    memory: str
    reach_width: int

    def __post_init__(self) -> None:
        known = f"one of {', '.join(FORMATS)}"
        self.require(self.memory in FORMATS, f"memory={self.memory!r}", known)
        self.require(
            (self.in_fmt.frac, self.out_fmt) == (EXACT.hidden_fmt.frac, RESULT),
            f"in_fmt={self.in_fmt} and out_fmt={self.out_fmt}",
            f"{EXACT.hidden_fmt.frac} fraction bits and {RESULT}",
        )
        self.check(reach_width=(self.formats.group_width + 1, self.in_fmt.width - 1))

    @property
    def formats(self) -> BipartiteFormat:
        """Segments, groups and formats of the chosen tables."""
        return FORMATS[self.memory]

    @property
    def table(self) -> BipartiteTable:
        """The table with the words of every magnitude below 8."""
        return bipartite_table(self.formats)

    @property
    def bases(self) -> tuple[int, ...]:
        """The bases that are kept."""
        kept = 1 << (self.reach_width - self.formats.segment_width)
        return self.table.bases[:kept]

    @property
    def corrections(self) -> tuple[int, ...]:
        """The corrections that are kept."""
        groups_width = self.reach_width - self.formats.group_width
        return self.table.corrections[: 1 << (groups_width + self.formats.offset_width)]

    @property
    def wide(self) -> bool:
        """Whether the neuron reaches 2, where the wide segments begin."""
        return self.reach_width > FINE_WIDTH

    @property
    def saturates(self) -> bool:
        """Whether the neuron reaches 8."""
        return self.reach_width > MAGNITUDE_WIDTH

    def taking(self, width: int) -> Self:
        """The same activation for a q of ``width`` bits; every bit counts, and 8 saturates."""
        return replace(
            self,
            in_fmt=Fix(width, self.in_fmt.frac),
            reach_width=width - 1,
            variant=f"{self.memory}{width - 1}",
        )

    def words_within(self, reach_width: int) -> int:
        """Words of both tables for magnitudes of so many bits."""
        mag = np.arange(1 << reach_width)
        base, slope = self.formats.addresses(mag, mag)
        return len(np.unique(base)) + len(np.unique(slope))

    def parts_left_out(self) -> Counter[str]:
        reached = self.words_within(min(self.reach_width, MAGNITUDE_WIDTH))
        return +Counter({TABLE_WORDS: self.words_within(MAGNITUDE_WIDTH) - reached})

    @property
    def marks(self) -> tuple[int, ...]:
        widths = FINE_WIDTH, CORRECTED_WIDTH, MAGNITUDE_WIDTH
        return tuple((1 << width) - 1 for width in widths if width < self.reach_width)

    @property
    def word_codes(self) -> Codes:
        """Codes of either sign at which each bit of every word within reach changes the result.

        A low bit that no sum with a word of the other table carries into the result has no such
        code: whatever it is, every result stays the same.
        """
        half = np.arange(1 << min(self.reach_width, MAGNITUDE_WIDTH))
        mag, sign = np.tile(half, 2), np.repeat([0, -1], len(half))
        base_addr, slope_addr = self.formats.addresses(mag ^ sign, mag)
        base = np.take(self.table.bases, base_addr) ^ sign
        correction = np.take(self.table.corrections, slope_addr)
        flips = [1 << bit for bit in range(self.table.correction_width)]
        # The highest bit of a correction is its sign.
        flips[-1] = -flips[-1]
        changed = [
            *((base_addr, base ^ 1 << bit, correction) for bit in range(self.formats.base_width)),
            *((slope_addr, base, correction ^ flip) for flip in flips),
        ]
        result = base + correction >> self.formats.frac
        found: list[Codes] = []
        for address, bases, corrections in changed:
            shown = np.flatnonzero(bases + corrections >> self.formats.frac != result)
            found.append(shown[np.unique(address[shown], return_index=True)[1]])
        codes = (mag ^ sign)[np.unique(np.concatenate(found))]
        return np.unique(np.concatenate([codes, ~codes]))

    def quantities(self, *inputs: Codes) -> dict[str, Codes]:
        (data,) = inputs
        return {"magnitude": data ^ (data >> self.in_fmt.width)}

    def compute(self, data: Codes) -> Codes:
        sign = data >> self.in_fmt.width
        whole = data ^ sign
        mag = whole & (1 << min(self.reach_width, MAGNITUDE_WIDTH)) - 1
        # Magnitudes from 8 on are treated like those from 6 on, for all of which the result is the
        # largest.
        mag = np.where(whole >> MAGNITUDE_WIDTH if self.saturates else 0, mag | TOP, mag)
        base_addr, slope_addr = self.formats.addresses(mag ^ sign, mag)
        base = np.take(self.table.bases, base_addr)
        correction = np.take(self.table.corrections, slope_addr)
        return np.asarray(((base ^ sign) + correction) >> self.formats.frac)


def bipartite_for(precision: Precision, factor: int, reach: int, memory: str = MEMORY) -> Bipartite:
    """The bipartite activation for a neuron whose magnitudes go up to ``reach``."""
    require_exact("bipartite", precision, factor)
    top = min(reach, precision.hidden_fmt.high)
    reach_width = max(top.bit_length(), FORMATS[memory].group_width + 1)
    return Bipartite(
        precision.hidden_fmt, RESULT, memory, reach_width, variant=f"{memory}{reach_width}"
    )


@dataclass(frozen=True)
class BipartitePair(Block):
    """Two nodes share one ``Bipartite`` activation, whose tables have a read port for each.

    activation: The activation of both nodes, with "block_ram", because a LUT has no second port.
    """

    block = "bipartite_pair"
    part_of = "adder_graph"
    area = "activation"
    activation: Bipartite

    def __post_init__(self) -> None:
        memory = self.activation.memory
        self.require(memory == "block_ram", f"memory={memory!r}", "block_ram")

    @property
    def ports(self) -> tuple[Port, ...]:
        node = self.activation
        return (
            *CLOCKED,
            input_port("in_valid", "`in_data` holds a code of either node"),
            *group(input_port("in_data", "q of node *", node.in_fmt), NODES),
            output_port("out_valid", "`out_data` holds a result of either node"),
            *group(output_port("out_data", "r of node *", node.out_fmt), NODES),
        )

    @property
    def latency(self) -> int:
        return self.activation.latency


SCHEME = Scheme(
    tanh,
    bipartite_for,
    {"memory": Option(MEMORY, tuple(FORMATS))},
    precisions=(EXACT,),
    half_codes=Bipartite.half_codes,
)
