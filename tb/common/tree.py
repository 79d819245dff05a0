"""The registers of an adder tree of hdl/common, which proofs about its sums need."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Register:
    """One register of the tree.

    added: The registers that it adds, or the one that it delays.
    terms: The numbers of the terms of the whole sum that it contains.
    clock: How many clocks it stands behind the terms.
    """

    name: str
    added: tuple[str, ...]
    terms: tuple[int, ...]
    clock: int


def tree(terms: list[str], total: str) -> list[Register]:
    """All registers in the order of their clocks; ``total`` is the last one."""
    level = [Register(name, (), (n,), 0) for n, name in enumerate(terms)]
    found: list[Register] = []
    pairs = delays = 0
    while len(level) > 1:
        above = []
        for n in range(0, len(level), 2):
            pair = level[n : n + 2]
            if len(pair) == 1:
                name = f"adder_tree0_delay{delays}_data_late"
                delays += 1
            else:
                name = total if len(level) == 2 else f"adder_tree0_add_pair{pairs}_total"
                pairs += 1
            above.append(
                Register(
                    name,
                    tuple(part.name for part in pair),
                    tuple(term for part in pair for term in part.terms),
                    pair[0].clock + 1,
                )
            )
        found += above
        level = above
    return found
