"""``make listing``: prints the program of a scene's engine, with a line for every step.

For a network without a program, whose products are made by adders, it prints every adder.
"""

from collections.abc import Sequence

from golden.common.block import walk
from golden.engine.formats import HIDDEN
from golden.engine.function_table import codes_of, table_of
from golden.engine.graph import Graph, Kind
from golden.engine.lane_groups import LaneGraph
from golden.engine.lane_program import LaneProgram, operand_text, weight_text
from golden.engine.pipeline import Pipeline
from golden.engine.schedule import one_by_one
from golden.input_error import InputError
from golden.layers.constant_matrix import ConstantMatrix
from golden.layers.shift_add import Constant, Input, ShiftAdd
from golden.learning.program import LessonProgram
from golden.networks.adder_graph import AdderGraph
from golden.networks.engine import Engine
from golden.networks.learning_engine import LearningEngine
from golden.trained.function import TANH
from tactus.core.cli import stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.scene import load_scene

_COLUMNS = ("step", "neurons", "operand", "address", "weight of each lane", "then")
_ALONE = ("step", "neuron", "operand", "address", "weight", "then")


def main() -> None:
    scene = load_scene(arguments_of("listing", __doc__).scene)
    blocks = list(walk(scene.twin()))
    matrices = [block for block in blocks if isinstance(block, ConstantMatrix)]
    if matrices:
        stop_if_dry_run(f"print the adders of {len(matrices)} matrices")
        print("\n\n".join("\n".join(adders(matrix)) for matrix in matrices))
        return
    lessons = [block for block in blocks if isinstance(block, LearningEngine)]
    if lessons:
        stop_if_dry_run(f"print the program of {lessons[0].entity}")
        print("\n".join(lesson_listing(lessons[0].program)))
        return
    engines = [block for block in blocks if isinstance(block, Engine)]
    if not engines:
        raise InputError(
            f"{scene.path}: hardware.design: got {scene.design}, which has no program, expected "
            f"{Engine.block} or {AdderGraph.block}"
        )
    (engine,) = engines
    stop_if_dry_run(f"print the program of {engine.entity}")
    print("\n".join(lane_listing(engine.graph, engine.program)))


def lane_listing(graph: Graph, program: LaneProgram) -> list[str]:
    """The program as text, with a line for every step, and the path that bounds its clocks."""
    shared = program.shared
    rows: list[Sequence[str]] = [_COLUMNS if program.lanes > 1 else _ALONE]
    kept = graph.inputs
    for n, (step, code) in enumerate(zip(program.scheduled, program.steps, strict=True)):
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
                ""
                if waits or code.gather
                else weight_text(shared.graph, step, shared.weights[step.term.weight]),
                then,
            )
        )
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = [
        "  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]
    clock, names = critical_path(shared, program.pipeline)
    path = (
        f"No order of these steps gives the last output before clock {clock}, because each of "
        "these needs the one before:"
    )
    return [*tables(graph, program), *lines, "", path, *(f"  {name}" for name in names)]


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
        ends.append(len(one_by_one(graph, number, ready, 0, shared.gathers[number])))
        ready[graph.inputs + number] = ends[-1] - 1 + pipeline.result_ready
        latest = max((t.source for t in graph.neurons[number].terms), key=lambda s: ready[s])
        before[number] = latest - graph.inputs
    at = max(range(len(ends)), key=ends.__getitem__)
    names = []
    clock = pipeline.begin + ends[at] - 1 + pipeline.result
    while at >= 0:
        names.append(graph.neurons[at].name)
        at = before[at]
    return clock, names[::-1]


def tables(graph: Graph, program: LaneProgram) -> list[str]:
    """A line for every table of the program, with its segments, of which two blocks have two."""
    segment = 2.0 ** (program.segment_width - HIDDEN.frac)
    if not program.table:
        return []
    count = program.segments
    if graph.functions == (TANH,) and program.blocks == 1:
        return [f"tanh in {count} segments of {segment:g}; the last one serves all beyond"]
    found = []
    for function, code in codes_of(graph.functions).items():
        error = table_of(function, program.segment_width).error
        first, own = (code >> 1) * count, count * (1 + (code & 1))
        found.append(
            f"{function.name} in {own} segments of {segment:g}, from {first} on; error "
            f"{error:.2g} at most"
        )
    return found


def adders(matrix: ConstantMatrix) -> list[str]:
    """A heading, and a line for every node of the graph and for every result.

    The column ``is`` shows whole numbers, with shifts and ``~`` as in Python. ``cut`` is the number
    of low bits that a node or a result lacks compared with its exact sum.
    """
    rows = [("node", "cut", "is")]
    for number, cut in enumerate(matrix.graph.lows):
        rows.append((f"n{number}", str(cut), _text(matrix.graph, number)))
    for i, row in enumerate(matrix.graph.rows):
        drop = matrix.drop(row)
        node = f"{'~' if row.minus else ''}n{row.node}"
        moved = f"{node} {'>>' if drop >= 0 else '<<'} {abs(drop)}"
        finish = matrix.row_finishes[i]
        if finish.even:
            tie = f"{node} % {1 << max(0, drop)} == 0"
            moved = f"({moved}) - (({moved}) & 1) * ({tie})"
        if finish.rectified:
            moved = f"({moved}) * ({node} >= 0)"
        rows.append((f"out_data_{i}", str(matrix.out_shift), moved))
    name, cut = (max(map(len, column)) for column in list(zip(*rows, strict=True))[:2])
    low, high = matrix.out_fmt.low, matrix.out_fmt.high
    return [
        f"{matrix.entity}: no result needs places below {matrix.place}; out_data is {low} to "
        f"{high} and saturates",
        *(f"{a:{name}}  {b:>{cut}}  {c}" for a, b, c in rows),
    ]


def _text(graph: ShiftAdd, number: int) -> str:
    node = graph.nodes[number]
    if isinstance(node, Input):
        return f"in_data_{node.number}"
    if isinstance(node, Constant):
        return str(node.value)
    found = []
    for one, step in zip(node.operands, graph.steps(number), strict=True):
        text = f"n{one.node}"
        if step.cut:
            text = f"({text} >> {step.cut})"
        elif step.move:
            text = f"({text} << {step.move})"
        found.append((one.sign, text))
    # One that is added comes first.
    (_, first), *rest = sorted(found, key=lambda item: -item[0])
    return " ".join([first, *(f"{'+' if sign > 0 else '-'} {text}" for sign, text in rest)])


def lesson_listing(program: LessonProgram) -> list[str]:
    """The words behind the table, and which part begins where.

    A part is computed from its first word on. The words before it say where its first results go.
    """
    frame, keep, *equations = program.lengths
    texts = [
        f"frame, {frame} steps",
        f"keep a placement, {keep} steps",
        f"all equations, {program.begun_alike} steps, then a jump to the rest of one",
        *(
            f"the rest of equation {k + 1}, {steps - program.begun_alike} steps"
            for k, steps in enumerate(equations)
        ),
    ]
    begun = dict(zip(program.starts, texts, strict=True))
    lines = [f"words 0 to {program.table.segments - 1}: the table of tanh"]
    for address in range(program.table.segments, len(program.notes)):
        if address in begun:
            lines.append(f"{begun[address]}:")
        lines.append(f"{address:>5}  {program.notes[address]}")
    return lines
