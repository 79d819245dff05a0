"""In which clock each field of a step is used: the registers between the engine's memories."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Pipeline:
    """Clocks of a step, counted from the one in which the operand's address is there.

    A field that is used k clocks later stands k words later in the program, so control needs no
    registers of its own.

    Parameters
    ----------
    memory_registers : int
        Registers behind each memory, 0 or 1: for faster clocks.
    """

    memory_registers: int = 0

    @property
    def operand(self) -> int:
        """The word that was read is there: its kind chooses the multiplier's operand."""
        return 1 + self.memory_registers

    @property
    def table(self) -> int:
        """Clocks from a segment's address to the table's word.

        Behind registers there is another one, because the word must also be none.
        """
        return 1 + 2 * self.memory_registers

    @property
    def weight(self) -> int:
        """The word of the table is there, a clock behind its address, and the weight is chosen."""
        return self.operand + 1 + self.table

    @property
    def start(self) -> int:
        """One clock before the product is there: the flag has a register before the adder."""
        return self.weight + 2

    @property
    def done(self) -> int:
        """The sum is there, four registers behind weight and operand."""
        return self.weight + 4

    @property
    def mark(self) -> int:
        """One clock before that: what becomes of the sum has registers too."""
        return self.done - 1

    @property
    def result(self) -> int:
        """The rounded result is there, and goes to the operand memory."""
        return self.done + 1

    @property
    def result_ready(self) -> int:
        """Steps from a neuron's last term to the first that reads its result."""
        return self.result + 1

    @property
    def run(self) -> int:
        """Clocks from the last sample until the program runs.

        Words that a reset left on their way have passed by then.
        """
        return 1 + self.memory_registers

    @property
    def begin(self) -> int:
        """Clocks from the last sample until its frame's first step.

        The word of that step stands ready; the second comes with the counter's first step.
        """
        return self.run + self.memory_registers

    @property
    def sample_ready(self) -> int:
        """The first step that reads the last sample, which is written two clocks after it came."""
        return max(0, 2 - self.begin)

    @property
    def padding(self) -> int:
        """Words without effect behind the last one, in the memory of a program.

        One more is read until the program stands, and has no effect whatever it holds.
        """
        return 2 + self.memory_registers

    @property
    def free(self) -> int:
        """Clocks from a frame's last output until a sample is taken again."""
        return 1


@dataclass(frozen=True)
class SerialPipeline(Pipeline):
    """The same without a multiplier: a register stands between a coefficient and the sum.

    A neuron's words are read more than once, so all fields of a step stand in one word, and
    registers carry them to the clock of their use.
    """

    @property
    def done(self) -> int:
        """The sum is there, behind the coefficient's register and its own."""
        return self.weight + 2
