"""The clock in which a lane uses each field of a step."""

from dataclasses import dataclass

from golden.engine.pipeline import Pipeline


@dataclass(frozen=True)
class LanePipeline(Pipeline):
    """The pipeline of an engine with several multipliers.

    A weight and a word of the table come from the same memory, so no register need wait for the
    table. A result is ready two clocks sooner than with ``Pipeline``.

    With ``memory_registers`` there is one behind the program, one behind the operands and one
    behind the words of each lane's memory.
    """

    @property
    def address(self) -> int:
        """The address of the operand is valid."""
        return 0

    @property
    def place(self) -> int:
        """The address of the weight is valid; with the word that was read it is that of a lane."""
        return self.operand

    @property
    def beside(self) -> int:
        """The number of the counter in the clock of ``place``, which addresses the weight."""
        return self.place + 1 + self.memory_registers

    @property
    def weight(self) -> int:
        """The coefficient is valid, and so is the operand that the kind has selected."""
        return self.operand + 1 + self.memory_registers

    @property
    def start(self) -> int:
        """Two clocks before the product is added, because the flag passes two registers first."""
        return self.weight

    @property
    def gather(self) -> int:
        """One clock before the product, or the sum of another lane in its place, is added."""
        return self.weight + 1

    @property
    def done(self) -> int:
        """The clock in which the sum is valid, three registers after weight and operand."""
        return self.weight + 3
