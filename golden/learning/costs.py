"""What a rule would add to an engine, estimated before anything is built.

Two of the parts exist as blocks, or are like one that does: a quotient by subtraction is the
``divider`` of the visualisation, of 67 LUTs, and a square root by subtraction has the same adder
and registers. The others are counted by hand: a LUT of four inputs for each bit that is chosen.
"""

from collections.abc import Iterable

# LUTs of the engine of ``digit`` as it is built (Virtex-II).
ENGINE = 137
# By name of a part: LUTs.
PARTS = {
    # Its bits take the place of those of a weight; the memory has a second copy to read them from.
    "second word": 18,
    # The address of a word that is written comes from the program, not only from a counter.
    "place to write": 10,
    # Placements and passes are counted, and the flag of a step that does not fit is held.
    "counters": 36,
    "quotient": 67,
    "square root": 67,
    # The lowest bits of a sum are stored too, and a sum begins with two words.
    "two words": 36,
    # The same words of the program serve each output, so the program calls and returns.
    "call": 20,
    "random signs": 8,
}
# What every rule needs: a sample times a gain is a product of two words.
EVERY = ("second word", "place to write", "counters")


def luts(parts: Iterable[str]) -> int:
    """LUTs of an engine with these parts, and with those that every rule needs."""
    return ENGINE + sum(PARTS[part] for part in (*EVERY, *parts))


def equation_steps(sensors: int, earlier: int, nodes: int) -> int:
    """Steps of the equation of one output: correction, network, error, squares, derivatives, row.

    sensors, earlier, nodes: Samples, outputs of earlier networks, and hidden nodes of its network.
    """
    correction = 5 * sensors
    network = nodes * (sensors + earlier + 1) + 2 * nodes + nodes + 1
    error = 2
    derivatives = nodes + sensors * (nodes + 1)
    row = 3 * sensors
    return correction + network + error + derivatives + row


def lms_steps(unknowns: int) -> int:
    """Steps of one equation for LMS with a constant step: the step, and theta."""
    return 1 + 2 * unknowns


def kaczmarz_steps(unknowns: int) -> int:
    """Steps of one equation: ``row . row`` and r^2, a quotient, and theta."""
    return unknowns + 1 + 1 + 2 * unknowns


def square_root_steps(unknowns: int) -> int:
    """Steps of one equation for ``golden.learning.recursive`` with words of 18 bits.

    Error in a later pass 3 n + 1; v and f 2 n^2; d^2 n + 1, and d; quotients 2 n + 2; theta 2 n;
    d / (d + r) f / d n; S 2 n^2.
    """
    return 4 * unknowns**2 + 9 * unknowns + 5
