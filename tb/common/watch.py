"""Verilog that remembers past clocks for properties, and properties that many blocks share."""

import re
from itertools import pairwise
from typing import Any

from golden.common.block import Block
from golden.networks.network import Network
from tb.common.properties import Property


def ago(name: str, signal: str, clocks: int) -> str:
    """``name[n]``, for n below ``clocks``, is ``signal`` n + 1 clocks ago, or 0 after a reset."""
    return f"""
        reg [{clocks - 1}:0] {name} = 0;
        always @(posedge clk) {name} <= rst ? 0 : {{{name}, {signal}}};
    """


def since(name: str, event: str, most: int | str) -> str:
    """``name`` counts the clocks since ``event``, up to ``most``; after a reset it is ``most``."""
    return f"""
        reg [15:0] {name} = 0;
        always @(posedge clk)
            {name} <= rst ? {most} : {event} ? 1 : {name} == {most} ? {name} : {name} + 1;
    """


def check_byte(data: str) -> str:
    """Takes a byte into ``sum``, a CRC-16 with x^16 + x^12 + x^5 + 1, from its highest bit on."""
    return "\n".join(
        f"sum = {{sum[14:0], 1'b0}} ^ (sum[15] ^ {data}[{n}] ? 16'h1021 : 16'h0);"
        for n in reversed(range(8))
    )


def pipeline(twin: Block, refuted_by: tuple[tuple[str, str], ...], last: str = "") -> Property:
    """The block gives a result for each item, a fixed number of clocks later.

    twin: Its latency is proved.
    refuted_by: Broken copies.
    last: The expression that ``out_last`` follows. Without it there is no such port.
    """
    late = twin.latency - 1
    states = [f"out_valid == valid_ago[{late}]"]
    watch = ago("valid_ago", "in_valid", twin.latency)
    if last:
        states.append(f"out_last == last_ago[{late}]")
        watch += ago("last_ago", last, twin.latency)
    flags = "out_valid and out_last are" if last else "out_valid is"
    own = "in_valid and in_last were" if last else "in_valid was"
    clocks = "1 clock" if twin.latency == 1 else f"{twin.latency} clocks"
    return Property(
        name="one for each",
        sentence=f"{flags} exactly what {own} {clocks} before, unless a reset came between. So no "
        "item is lost and none is made up.",
        states=tuple(states),
        watch=watch,
        reached=("out_valid", "!out_valid"),
        refuted_by=refuted_by,
        clocks=twin.latency + 3,
        induction=twin.latency + 1,
    )


def frames(
    inputs: int, spacing: int = 0, valid: str = "in_valid", last: str = "in_last", name: str = ""
) -> str:
    """The rules for frames in docs/streams.md, as signals in each clock.

    ``taken`` says that the sample belongs to a frame that is not yet known to be wrong, ``good``
    that it completes a good frame, and ``wrong`` that it shows a frame to be wrong. Where there is
    a limit, ``spacing`` is the least number of clocks from the last sample of a good frame to that
    of the next one. The names of the signals are these, with ``name`` in front.
    """
    text = f"""
        reg [15:0] @place = 0;
        reg @skipping = 0;
        reg [15:0] @closed = 0;
        wire @taken = {valid} && !@skipping;
        wire @final_place = @place == {inputs - 1};
        wire @good = @taken && @final_place && {last} && @closed == 0;
        wire @wrong = @taken && (@final_place || {last}) && !@good;
        always @(posedge clk) begin
            if (@taken) @place <= @final_place || {last} ? 0 : @place + 1;
            if ({valid}) @skipping <= !{last} && (@skipping || @final_place);
            @closed <= @good ? {max(spacing - 1, 0)} : @closed == 0 ? 0 : @closed - 1;
            if (rst) begin
                @place <= 0;
                @skipping <= 0;
                @closed <= 0;
            end
        end
    """
    return re.sub(r"@(?=[a-z])", name, text)


def sent(network: Network, at: str) -> tuple[str, tuple[str, ...], int]:
    """What holds if a network that is named by its instance never gets a wrong frame.

    It is seen at its ports, because each design judges frames in its own way; that it judges them
    by these rules is proved of the design itself.

    Returns watch: The signals of ``frames``, whose names begin with ``sent_``.
    Returns spacing: Clocks from one last sample to the next.
    """
    spacing = network.busy + 1 if network.busy else network.interval
    valid, last = f"{at}.in_valid", f"{at}.in_last"
    watch = frames(network.input_controller.inputs, spacing, valid, last, "sent_")
    at_rest = (f"!({valid} && sent_closed != 0)",) if network.busy else ()
    return watch, ("!sent_wrong", *at_rest), spacing


def results(outputs: int, begin: str) -> str:
    """``left`` counts the outputs still to come, with this one; the first comes at ``begin``."""
    return f"""
        reg [15:0] due = 0;
        wire [15:0] left = {begin} ? {outputs} : due;
        always @(posedge clk) due <= rst || left == 0 ? 0 : left - 1;
    """


def busy_of(twin: Any, at: str = "") -> tuple[str, ...]:
    """When an engine that takes images is busy, and that this is while its image is whole."""
    if twin.frame_guard.pipeline.run == 1:
        return (f"{at}busy == {at}run",)
    waits = f"{at}u_frame_guard_0.waiting"
    return (
        f"{at}busy == ({at}run || {waits})",
        f"!{at}start || {waits}",
        f"!{at}busy || {at}u_image_loader_0.whole",
    )


def network(
    twin: Network,
    controller: str,
    wrong: tuple[tuple[str, str], ...],
    good: tuple[tuple[str, str], ...],
    helps: tuple[str, ...] = (),
) -> list[Property]:
    """The properties of every network with a stream: what it does with frames.

    controller: The instance that judges frames.
    wrong, good: Broken copies that refute the properties of wrong frames and of good ones.
    helps: See ``Property``.
    """
    judge: Any = twin.input_controller
    inputs, spacing = judge.inputs, judge.spacing
    late, outputs = twin.latency, twin.outputs
    helps = (
        f"place == {controller}.count",
        f"skipping == {controller}.dropping",
        f"place < {inputs}",
        "!skipping || place == 0",
        f"closed == {f'{controller}.remaining' if spacing else '0'}",
        *helps,
    )
    told = frames(inputs, spacing)
    least = f" or that ends less than {spacing} clocks after a good one" if spacing else ""
    return [
        Property(
            name="frame_error",
            sentence="frame_error is high for exactly one clock for each frame that does not have "
            f"{inputs} elements{least}. It comes one clock after the element that shows this.",
            states=("frame_error == wrong_ago[0]",),
            watch=told + ago("wrong_ago", "wrong", 1),
            helps=helps,
            reached=("frame_error", "skipping && in_valid"),
            refuted_by=wrong,
            clocks=12,
        ),
        Property(
            name="outputs of good frames",
            sentence=f"Each good frame yields {outputs} outputs in clocks {late} to "
            f"{late + outputs - 1} after its last element, and out_last comes with the last of "
            "them. Nothing else yields an output: no wrong frame does, and no frame that began "
            "before a reset.",
            states=("out_valid == (left != 0)", "out_last == (left == 1)"),
            watch=told + ago("good_ago", "good", late) + results(outputs, f"good_ago[{late - 1}]"),
            helps=helps,
            reached=("out_last", "left == 1 && good"),
            refuted_by=good,
            clocks=late + outputs + inputs + 2,
            induction=late + outputs + 1,
        ),
    ]


def pipe(signal: str, clocks: int, width: int, also: bool = True) -> str:
    """``signal_n``, for n below ``clocks``, is a signed signal n + 1 clocks ago, without a reset.

    With ``also``, ``there[n]``, for n up to ``clocks``, says that there was such a clock.
    """
    names = [signal, *(f"{signal}_{n}" for n in range(clocks))]
    moves = "\n".join(f"{late} <= {early};" for early, late in pairwise(names))
    text = f"""
        reg signed [{width - 1}:0] {", ".join(names[1:])};
        always @(posedge clk) begin
            {moves}
        end
    """
    return (
        text
        + f"""
        reg [{clocks}:0] there = 0;
        always @(posedge clk) there <= {{there, 1'b1}};
    """
        * also
    )


def frames_computed(inputs: int, busy: int, place: str = "place", taken: str = "taken") -> str:
    """Verilog that watches the stream of samples of a network with a program.

    inputs: The samples of a frame.
    busy: Clocks from the last sample of a frame until the next one may come.
    place, taken: Names that the hardware does not have.
    """
    return f"""
        // Clocks since the last sample of a frame that is computed; 0: there is none.
        reg [15:0] since = 0;
        reg [15:0] {place} = 0;
        reg skipping = 0;
        wire {taken} = in_valid && since == 0 && !skipping;
        wire is_good = {taken} && {place} == {inputs - 1} && in_last;
        wire is_wrong = in_valid && !skipping
            && (since != 0 || in_last != ({place} == {inputs - 1}));
        reg told = 0;
        always @(posedge clk) begin
            since <= rst ? 0 : is_good ? 1 : since == 0 || since == {busy} ? 0 : since + 1;
            if ({taken}) {place} <= is_good || is_wrong ? 0 : {place} + 1;
            if (in_valid) skipping <= !in_last && (skipping || is_wrong);
            told <= !rst && is_wrong;
            if (rst) begin
                {place} <= 0;
                skipping <= 0;
            end
        end
    """
