"""The clock in which a lane uses each field of a step."""

from dataclasses import dataclass

from golden.engine.pipeline import Pipeline


@dataclass(frozen=True)
class LanePipeline(Pipeline):
    """The pipeline of an engine with several multipliers.

    A weight and a word of the table come from the same memory, so no register need wait for the
    table. A result is ready two clocks sooner than with ``Pipeline``.

    With ``memory_registers`` there is one behind the program and one behind the operands. The words
    of a lane's memory go straight into the register of the multiplier.
    """

    @property
    def place(self) -> int:
        """The address of the weight is valid; with the word that was read it is that of a lane."""
        return self.operand

    @property
    def weight(self) -> int:
        """The coefficient is valid, and so is the operand that the kind has selected."""
        return self.operand + 1

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
