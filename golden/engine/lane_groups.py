"""Shares the neurons of a scene out to the lanes of an engine.

All lanes do the same step in the same clock: they read the same address of their memories, and each
has a weight of its own. A value is in one of two places: every lane holds it, or one lane does.

- A neuron whose operands every lane holds is computed by one lane, and the lanes beside it compute
  others of its layer. They are a *group*, and each lane stores its own result.
- A neuron whose operands are spread over the lanes is *joined*: each lane adds up the products of
  the operands that it holds, then the sums of all lanes are added, and every lane stores the
  result. So is an output, and a constant.
- A neuron that takes nothing but the result of one neuron, such as its tanh, is computed where that
  result is: by the same lane, or by all lanes alike.

Neurons whose results go through different functions are in different groups, because a step looks
up one function in all lanes.

The groups are the neurons of a graph again, which ``golden.engine.schedule`` puts in order.
"""

from collections import Counter
from dataclasses import dataclass, field, replace
from functools import cached_property

from golden.engine.graph import Graph, Kind, Neuron, Term
from golden.engine.pipeline import Pipeline
from golden.engine.schedule import Step, schedule
from golden.trained.function import Function

# Up to so many lanes, each adds the sum of one other lane at most.
CHAIN = 4

Pairs = tuple[tuple[int, int], ...]


def reduction_steps(lanes: int) -> tuple[Pairs, ...]:
    """The steps that add up the sums of all lanes in the first one.

    In each step some lanes add the sum of another lane to their own. These are pairs of lanes, the
    one that adds first. Few lanes do it one after the other, from the last lane on, so that none
    has to choose among others. More lanes do it in a tree, which takes fewer steps.
    """
    if lanes <= CHAIN:
        return tuple(((lane, lane + 1),) for lane in reversed(range(lanes - 1)))
    found = []
    distance = 1
    while distance < lanes:
        firsts = range(0, lanes - distance, 2 * distance)
        found.append(tuple((lane, lane + distance) for lane in firsts))
        distance *= 2
    return tuple(found)


def partners(lane: int, lanes: int) -> dict[int, int]:
    """The lanes whose sums a lane adds, by the numbers of the steps, which follow each other."""
    steps = enumerate(reduction_steps(lanes))
    return {step: other for step, pairs in steps for first, other in pairs if first == lane}


@dataclass(frozen=True)
class Group:
    """Neurons that the lanes compute in the same steps.

    members: The neuron of each lane, from the first on. Lanes beyond them have weights of 0. If the
        group is ``joined`` or ``alike``, all lanes compute the only one.
    joined: Whether the sums of all lanes are added.
    alike: Whether every lane computes the same.
    """

    members: tuple[int, ...]
    joined: bool = False
    alike: bool = False


@dataclass(frozen=True)
class LaneGraph:
    """The groups of a scene, as a graph.

    graph: A neuron for each group. The weight of a term is the number of an element of ``weights``.
    weights: Codes, one for each lane. In the first element all are 0.
    """

    lanes: int
    graph: Graph
    groups: tuple[Group, ...]
    weights: tuple[tuple[int, ...], ...]

    @property
    def gathers(self) -> list[int]:
        """For each group, the steps that add up the sums of lanes."""
        steps = len(reduction_steps(self.lanes))
        return [steps * group.joined for group in self.groups]

    def schedule(self, pipeline: Pipeline) -> list[Step]:
        """All steps in the order of the program."""
        return schedule(self.graph, pipeline, self.gathers)


@dataclass
class _Shared:
    """What is known while neurons are shared out."""

    graph: Graph
    lanes: int
    groups: list[Group] = field(default_factory=list)
    # For each neuron its group and its lane; the lane is -1 where all lanes hold the result.
    place: dict[int, tuple[int, int]] = field(default_factory=dict)
    # The last group of a layer, by what tells layers apart.
    opened: dict[tuple[object, ...], int] = field(default_factory=dict)

    @cached_property
    def behind(self) -> dict[int, Function]:
        """For each neuron that a function is looked up for, the function."""
        inputs, neurons = self.graph.inputs, self.graph.neurons
        return {n.terms[0].source - inputs: n.function for n in neurons if n.looks_up}

    def lane_of(self, source: int) -> int:
        """The lane that holds a value; -1 for all."""
        return -1 if source < self.graph.inputs else self.place[source - self.graph.inputs][1]

    def add(self, number: int, group: Group) -> None:
        """A group of its own for a neuron whose result every lane holds."""
        self.place[number] = len(self.groups), -1
        self.groups.append(group)

    def join(self, number: int, layer: tuple[object, ...], lane: int = -1) -> None:
        """Take a neuron into the last group of its layer, or into a new one if there is no room."""
        opened = self.opened.get(layer)
        members = self.groups[opened].members if opened is not None else ()
        if opened is None or (lane < 0 and len(members) == self.lanes):
            opened, members = len(self.groups), ()
            self.opened[layer] = opened
            self.groups.append(Group(()))
        wanted = len(members) if lane < 0 else lane
        members += (-1,) * (wanted + 1 - len(members))
        changed = (*members[:wanted], number, *members[wanted + 1 :])
        self.groups[opened] = Group(changed)
        self.place[number] = opened, wanted


def assign_to_lanes(graph: Graph, lanes: int, every: bool = False) -> LaneGraph:
    """Share the neurons of a graph out to lanes.

    Unless ``every`` lane is there already, there are no more lanes than any group fills.
    """
    found = _Shared(graph, lanes)
    for number, neuron in enumerate(graph.neurons):
        _share(found, number, neuron)
    if not every:
        lanes = found.lanes = max(len(group.members) for group in found.groups)
    weights: dict[tuple[int, ...], int] = {(0,) * lanes: 0}
    made = [_neuron(found, place, weights) for place in range(len(found.groups))]
    whole = replace(graph, neurons=tuple(made))
    return LaneGraph(lanes, whole, tuple(found.groups), tuple(weights))


def _share(found: _Shared, number: int, neuron: Neuron) -> None:
    inputs = found.graph.inputs
    sources = {term.source for term in neuron.terms if term.source >= 0}
    alone = next(iter(sources)) if len(sources) == 1 else -1
    # A neuron of one operand that comes right after it belongs to the same node.
    follows = alone >= inputs and (neuron.looks_up or alone == inputs + number - 1)
    if follows and not neuron.output:
        group, lane = found.place[alone - inputs]
        if lane < 0:
            found.add(number, Group((number,), alike=True))
        else:
            kind = neuron.looks_up, neuron.relu, neuron.function
            found.join(number, (group, *kind, found.behind.get(number)), lane)
    elif neuron.output or not sources or any(found.lane_of(source) >= 0 for source in sources):
        found.add(number, Group((number,), joined=True))
    else:
        # Neurons of a layer take the same values, of which a weight of 0 leaves some out.
        layer = max(sources) if max(sources) >= inputs else -1
        found.join(number, (layer, neuron.relu, found.behind.get(number)))


def _neuron(found: _Shared, place: int, weights: dict[tuple[int, ...], int]) -> Neuron:
    """A group as a neuron; it adds what it needs to the ``weights``."""
    graph, group = found.graph, found.groups[place]
    members = [(lane, graph.neurons[n]) for lane, n in enumerate(group.members) if n >= 0]
    names = [neuron.name for _, neuron in members]
    terms: list[Term] = []
    columns: dict[tuple[Kind, int, Function], list[list[int]]] = {}
    for lane, neuron in members:
        met: Counter[tuple[Kind, int, Function, int]] = Counter()
        for term in neuron.terms:
            source, home = term.source, found.lane_of(term.source)
            if source >= graph.inputs:
                source = graph.inputs + found.place[source - graph.inputs][0]
            at = home if group.joined and home >= 0 else lane
            # A weight of several parts takes several steps.
            key = term.kind, source, term.function
            row = met[*key, at]
            met[*key, at] += 1
            rows = columns.setdefault(key, [])
            if row == len(rows):
                rows.append([0] * found.lanes)
            for column in range(found.lanes) if group.alike else (at,):
                rows[row][column] = term.weight
    first = members[0][1]
    for (kind, source, function), rows in columns.items():
        for weight in map(tuple, rows):
            place = weights.setdefault(weight, len(weights))
            terms.append(Term(kind, source, place, function))
    name = names[0] if len(names) == 1 else f"{names[0]} and {len(names) - 1} more"
    return replace(first, name=name, terms=tuple(terms))
