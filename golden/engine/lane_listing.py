"""The program of an engine with several multipliers as a text for a person to read."""

from collections.abc import Sequence

from golden.engine.formats import ONE, coeff_frac
from golden.engine.graph import Graph, Kind
from golden.engine.lane_groups import LaneGraph
from golden.engine.lane_program import LaneProgram
from golden.engine.listing import operand_text, tables
from golden.engine.pipeline import Pipeline
from golden.engine.schedule import Step

_COLUMNS = ("step", "neurons", "operand", "address", "weight of each lane", "then")
_ALONE = ("step", "neuron", "operand", "address", "weight", "then")


def lane_listing(graph: Graph, program: LaneProgram) -> list[str]:
    """The program as text, with a line for every step, and the path that bounds its clocks."""
    shared = program.shared
    rows: list[Sequence[str]] = [_COLUMNS if program.lanes > 1 else _ALONE]
    kept = graph.inputs
    for n, (step, code) in enumerate(
        zip(program.scheduled(graph), program.lane_steps, strict=True)
    ):
        waits = step.neuron < 0
        then = ""
        if step.last:
            then = f"kept at {kept}" + " by all lanes" * (
                shared.groups[step.neuron].joined and program.lanes > 1
            )
            kept += 1
        if code.output:
            then += f", leaves in clock {program.clock(n)}"
        operand = "sums of other lanes" if code.gather else operand_text(shared.graph, step)
        named = waits or code.gather or step.term.kind is Kind.ONE
        rows.append(
            (
                str(n),
                "" if waits else shared.graph.neurons[step.neuron].name,
                operand,
                "" if named else str(code.source),
                "" if waits or code.gather else weights_text(shared, step),
                then,
            )
        )
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = [
        "  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]
    return [*tables(graph, program), *lines, "", *path_text(shared, program.pipeline)]


def weights_text(shared: LaneGraph, step: Step) -> str:
    """The weights of the lanes as decimal numbers."""
    term = step.term
    if term.kind in (Kind.INTERCEPT, Kind.DISTANCE):
        return "intercept of the table" if term.kind is Kind.INTERCEPT else "slope of the table"
    operand = ONE if term.kind is Kind.ONE else shared.graph.format_of(term.source)
    unit = 2 ** coeff_frac(shared.graph.neurons[step.neuron].result, operand)
    return " ".join(f"{weight / unit:.6g}" for weight in shared.weights[term.weight])


def critical_path(shared: LaneGraph, pipeline: Pipeline) -> tuple[int, list[str]]:
    """The clock before which no order of the steps ends, and the neurons that bound it.

    Each group here begins its steps as soon as their operands are there, as if it had lanes of its
    own. So the last result cannot leave sooner, however the steps are ordered.
    """
    graph = shared.graph
    ready = dict.fromkeys(range(-1, graph.inputs), 0)
    ready[graph.inputs - 1] = pipeline.sample_ready
    before: dict[int, int] = {}
    ends: list[int] = []
    for number in range(len(graph.neurons)):
        plan = shared.plan(graph, number, ready, 0)
        ends.append(plan.end)
        ready[graph.inputs + number] = plan.end - 1 + pipeline.result_ready
        latest = max((t.source for t in graph.neurons[number].terms), key=lambda s: ready[s])
        before[number] = latest - graph.inputs
    at = max(range(len(ends)), key=ends.__getitem__)
    names = []
    clock = pipeline.begin + ends[at] - 1 + pipeline.result
    while at >= 0:
        names.append(graph.neurons[at].name)
        at = before[at]
    return clock, names[::-1]


def path_text(shared: LaneGraph, pipeline: Pipeline) -> list[str]:
    """What bounds the clocks of a frame, as lines of text."""
    clock, names = critical_path(shared, pipeline)
    return [
        f"No order of these steps gives the last output before clock {clock}, because each of "
        "these needs the one before:",
        *(f"  {name}" for name in names),
    ]
