"""Proved properties of serial_engine; see prove_engine."""

from golden.engine.fields import get
from golden.engine.formats import SAMPLE_SHIFT
from golden.engine.graph import Kind
from golden.engine.replay import CLEAR, ONE_PLANE
from golden.engine.serial_program import BEFORE, LEAVES, NOTHING
from golden.engine.serial_program import ENDS as ENDS_FRAME
from golden.engine.tanh_table import ENDS
from tb.common.watch import table
from tb.networks.prove_engine import Steps, built_in


def properties(twin):
    return built_in(twin, replayed_steps(twin), place="place")


def replayed_steps(twin):
    """The words are read pass by pass, and each pass of a plane knows its clocks."""
    program, memory = twin.program, twin.replay_memory
    begin, words, busy = memory.begin, len(program.words), twin.busy
    # Addresses are counted modulo the words of the memory.
    width = memory.addr_width
    one, span = f"{width}'d1", 1 << width
    # In the first clock nothing is computed yet.
    nothing = [0] * (busy + 1)
    places, planes, _ = memory.places([0] + [1] * busy, nothing, nothing)
    steps = program.instructions
    starts = [n for n, step in enumerate(steps) if step.first] + [words - 1]
    # For each word: the first word of its neuron, and of the next one.
    own = [begin + max(start for start in starts if start <= n) for n in range(words)]
    other = [(begin + min([s for s in starts if s > n] or [words])) % span for n in range(words)]
    told = {
        clock: get(memory.contents[place], BEFORE)
        for clock, (place, plane) in enumerate(zip(places, planes, strict=True))
        if clock and plane == CLEAR and get(memory.contents[place], BEFORE) != NOTHING
    }
    here, unit = "u_replay_memory_0", "serial_steps0"
    watch = f"""
        reg [{width - 1}:0] fetched_from;
        always @(posedge clk) fetched_from <= {here}.address;
        wire [15:0] word_of_program = fetched_from - {begin};
        wire [{width - 1}:0] own = own_start(word_of_program), other = next_start(word_of_program);
        wire [4:0] number = plane_at(since);
        wire [1:0] kind = {unit}_kind;
        function [1:0] told_at(input [15:0] n);
            case (n)
                {" ".join(f"{clock}: told_at = {value};" for clock, value in told.items())}
                default: told_at = {NOTHING};
            endcase
        endfunction
    """
    watch += table("place_at", places, width) + table("plane_at", planes, 5)
    watch += table("own_start", own, width) + table("next_start", other, width)
    return Steps(
        f"While a frame is computed, each step comes from one of the {words} words of the "
        "program, in the order of the passes. After the last word there is no step.",
        begin,
        watch,
        (
            "since == 0 || fetched_from == place_at(since)",
            f"since == 0 || {unit}_word == {here}.memory[fetched_from]",
            f"since == 0 || {here}.counter == fetched_from + {one}",
            f"since != 0 || ({here}.place == {1 << CLEAR} && {here}.sort == 3)",
            f"since != 0 || {here}.base == {begin}",
            f"{here}.second == {here}.base + {one}",
            f"since == 0 || {here}.place == 1 << number",
            f"since == 0 || {here}.sort == (number == {CLEAR} ? 3 : number == {ONE_PLANE} ? 1 "
            f": number < {SAMPLE_SHIFT} ? 2 : 0)",
            f"since == 0 || {here}.base == (number == 0 ? other : own)",
            f"since == 0 || number >= {ONE_PLANE} "
            f"|| ({here}.following == other && {here}.beside == other + {one})",
            f"{unit}_waits == (since == 0 ? 0 : told_at(since - 1))",
            f"{unit}_late == (since < 2 ? 0 : told_at(since - 2))",
            f"{unit}_later == (since < 3 ? 0 : told_at(since - 3))",
            f"store == (since > 3 && told_at(since - 4) != {NOTHING})",
            f"leaves == (since > 3 && told_at(since - 4) >= {LEAVES})",
            f"ends == (since > 3 && told_at(since - 4) == {ENDS_FRAME})",
        ),
        # An operand counts from the first plane on in which one of its bits can be set.
        f"(kind == {Kind.WORD} ? number == {CLEAR} || {unit}_weight == 0 "
        f": kind == {Kind.DISTANCE} ? number >= {max(ENDS)} "
        f": kind == {Kind.ONE} || number > {ONE_PLANE})",
        ((r"(if \(stands\) begin\s+base <=) \d+", r"\1 0"),),
    )
