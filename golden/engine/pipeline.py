"""The clock in which each field of a step is used, given the registers between memories."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Pipeline:
    """Clocks of a step, counted from the clock in which the address of its operand is valid.

    A field that is used k clocks later is stored k words later in the program, so the control path
    needs no registers of its own.

    memory_registers: Registers behind the program, behind the operands and behind the words of each
        lane's memory, 0 or 1; with 1 the engine reaches a faster clock.
    """

    memory_registers: int = 0

    @property
    def address(self) -> int:
        """The address of the operand is valid."""
        return 0

    @property
    def operand(self) -> int:
        """The word that was read is valid, and its kind selects the operand of the multiplier."""
        return 1 + self.memory_registers

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

    @property
    def mark(self) -> int:
        """One clock before `done`, because the flags for the finished sum pass a register first."""
        return self.done - 1

    @property
    def result(self) -> int:
        """The rounded result is valid and is written to the operand memory."""
        return self.done + 1

    @property
    def result_ready(self) -> int:
        """Steps from the last term of a neuron to the first step that can read its result."""
        return self.result + 1

    @property
    def run(self) -> int:
        """Clocks from the last sample until the program runs.

        By then the words that a reset left in the pipeline have passed.
        """
        return 1 + self.memory_registers

    @property
    def begin(self) -> int:
        """Clocks from the last sample until the first step of its frame.

        The word of that step has been read before; the second word comes when the counter makes its
        first step.
        """
        return self.run + self.memory_registers

    @property
    def sample_ready(self) -> int:
        """First step that can read the last sample, written two clocks after it comes."""
        return max(0, 2 - self.begin)

    @property
    def padding(self) -> int:
        """Words without effect that follow the last word in the memory of a program.

        One more word is read until the program stops; it has no effect, whatever it contains.
        """
        return 2 + self.memory_registers

    @property
    def free(self) -> int:
        """Clocks from the last output of a frame until a sample is accepted again."""
        return 1
