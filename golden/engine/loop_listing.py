"""The loop of an engine with several multipliers as a text for a person to read."""

from collections.abc import Sequence

from golden.engine.graph import Graph, Kind
from golden.engine.lane_listing import weights_text
from golden.engine.listing import operand_text, tables
from golden.engine.loop_program import LoopProgram
from golden.engine.loop_schedule import sizes_of

_COLUMNS = ("word", "began", "neurons", "operand", "address", "weight of each lane", "then")


def loop_listing(graph: Graph, program: LoopProgram) -> list[str]:
    """The loop as text, with a line for every word, and what it keeps of the frames before."""
    length = program.loop.length
    rows: list[list[str]] = [list(_COLUMNS)]
    rows += [[str(n), *[""] * (len(_COLUMNS) - 1)] for n in range(length)]
    for t, (step, code) in enumerate(
        zip(program.scheduled(graph), program.lane_steps, strict=True)
    ):
        if step.neuron < 0:
            continue
        neuron = program.shared.graph.neurons[step.neuron]
        then = []
        if code.store:
            kept = program.address(t + program.pipeline.mark)
            then.append(f"kept at {kept}" + " by all lanes" * bool(code.together))
        if code.output:
            then.append(f"leaves in clock {program.clock(t)}")
        reads = not code.gather and step.term.kind is not Kind.ONE
        rows[1 + t % length] = [
            str(t % length),
            _ago(t // length),
            neuron.name,
            "sums of other lanes" if code.gather else operand_text(program.shared.graph, step),
            str(code.source) if reads else "",
            "" if code.gather else weights_text(program.shared, step),
            ", ".join(then),
        ]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = [
        "  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]
    return [*tables(graph, program), *lines, "", *_facts(program)]


def _ago(loops: int) -> str:
    """When the frame of a step began."""
    return "now" if not loops else f"{loops} loop{'s' * (loops > 1)} ago"


def _facts(program: LoopProgram) -> Sequence[str]:
    loop = program.loop
    steps = sum(sizes_of(loop.shared))
    later = len(loop.begins) - loop.stored
    copies = ", ".join(map(str, loop.copies))
    return (
        f"{steps} of {loop.length} words compute. Samples are stored by the words {copies}.",
        f"A frame is computed for {program.stages} loops; the memory of operands has room for "
        f"{program.turns}. Outputs that leave later than they are computed: {later}.",
    )
