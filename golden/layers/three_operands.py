"""Sums of three operands in place of two sums, for FPGAs whose adders take three.

A LUT of six inputs and its carry add three bits and a carry of lower weight, so that a sum of three
operands needs no more LUTs than one of two (M. Kumm, M. Hardieck, J. Willkomm, P. Zipf and U.
Meyer-Baese, Multiple constant multiplication with ternary adders, FPL 2013). How the pairs of sums
are chosen is ours.
"""

from collections import defaultdict

from golden.layers.shift_add import Node, Operand, ShiftAdd, Sum, beside, renumbered, steps_of


def fused(graph: ShiftAdd) -> ShiftAdd:
    """The same rows, with sums of three operands where that saves the most bits of adders.

    A sum takes in an operand that is a sum of two and that nothing else uses. It takes in one at
    most, and none if it is taken in itself. Sums and their only users form trees, so the choice
    that saves the most is found exactly, from the leaves up. Numbers and errors at all nodes that
    remain are what they were, because a sum with one user keeps exactly the bits that this needs.
    """
    inner = _choice(graph)
    nodes: list[Node] = list(graph.nodes)
    for place, operand in inner.items():
        nodes[place] = _merged(graph, place, operand)
    gone = set(inner.values())
    kept = [place for place in range(len(nodes)) if place not in gone]
    return renumbered(graph.ends, nodes, graph.lows, graph.rows, kept)


def _merged(graph: ShiftAdd, place: int, operand: int) -> Sum:
    """The sum at ``place`` with the operands of one of its operands in place of that."""
    node, inner = graph.nodes[place], graph.nodes[operand]
    assert isinstance(node, Sum)
    assert isinstance(inner, Sum)
    found: list[Operand] = []
    for one in node.operands:
        if one.node == operand:
            found += [
                Operand(o.node, o.shift + one.shift, o.sign * one.sign) for o in inner.operands
            ]
        else:
            found.append(one)
    return Sum(tuple(sorted(found, key=lambda one: (one.shift, one.node, one.sign))))


def saving_of(graph: ShiftAdd, place: int, operand: int) -> int:
    """Bits of adders that are saved if the sum at ``place`` takes in an operand."""
    merged, low = _merged(graph, place, operand), graph.lows[place]
    bits = graph.widths[place] - beside(merged, steps_of(merged, graph.lows, low))
    return graph.bits(place) + graph.bits(operand) - bits


def _choice(graph: ShiftAdd) -> dict[int, int]:
    """For each sum that takes in an operand, that operand."""
    users: dict[int, list[int]] = defaultdict(list)
    for place, node in enumerate(graph.nodes):
        if isinstance(node, Sum):
            for one in node.operands:
                users[one.node].append(place)
    # The results of the block use the nodes of rows.
    for row in graph.rows:
        users[row.node] += [-1, -1]
    inner: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for place, node in enumerate(graph.nodes):
        if isinstance(node, Sum) and len(users[place]) == 1:
            (user,) = users[place]
            inner[user].append((place, saving_of(graph, user, place)))
    # The most that can be saved in the tree below a node, if it takes in none, and in any case.
    alone, best, chosen = [0] * len(graph.nodes), [0] * len(graph.nodes), {}
    for place in range(len(graph.nodes)):
        alone[place] = best[place] = sum(best[below] for below, _ in inner[place])
        for below, saving in inner[place]:
            total = alone[place] - best[below] + alone[below] + saving
            if total > best[place]:
                best[place], chosen[place] = total, below
    found: dict[int, int] = {}
    for place in sorted(chosen, reverse=True):
        if place not in found.values():
            found[place] = chosen[place]
    return found
