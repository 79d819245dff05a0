"""Verilog that remembers, for properties to compare with, and properties that many blocks share."""

from __future__ import annotations

from golden.block import Block
from tb.sign_off.properties import Property


def ago(name: str, signal: str, clocks: int) -> str:
    """``name[n]``, n below ``clocks``: ``signal`` n + 1 clocks ago, 0 if a reset came since."""
    return f"""
        reg [{clocks - 1}:0] {name} = 0;
        always @(posedge clk) {name} <= rst ? 0 : {{{name}, {signal}}};
    """


def pipeline(
    twin: Block,
    refuted_by: tuple[tuple[str, str], ...],
    valid: str = "in_valid",
    last: str = "",
) -> Property:
    """A block that gives a result for each item, a fixed number of clocks later.

    Parameters
    ----------
    twin : Block
        Its latency is what is proved.
    refuted_by : tuple
        Broken copies.
    valid, last : str
        What makes ``out_valid`` and ``out_last`` high; without ``last`` there is no such port.
    """
    late = twin.latency - 1
    states = [f"out_valid == valid_ago[{late}]"]
    watch = ago("valid_ago", valid, twin.latency)
    if last:
        states.append(f"out_last == last_ago[{late}]")
        watch += ago("last_ago", last, twin.latency)
    flags = "out_valid and out_last are" if last else "out_valid is"
    own = "in_valid and in_last" if last else "in_valid"
    return Property(
        name="one for each",
        sentence=f"{flags} just what {own} was {twin.latency} clocks before, unless a reset came "
        "between: no item is lost and none is made up.",
        states=tuple(states),
        watch=watch,
        reached=("out_valid", "!out_valid"),
        refuted_by=refuted_by,
        clocks=twin.latency + 3,
        induction=twin.latency + 1,
    )


def frames(inputs: int, spacing: int = 0) -> str:
    """What docs/streams.md says of frames, clock by clock.

    ``taken``: the sample belongs to a frame that is not yet known to be wrong; ``good``: it makes a
    frame whole; ``wrong``: it gives a frame away, ``spacing`` clocks from the last good one where
    there is a least distance.
    """
    return f"""
        reg [15:0] place = 0;
        reg skipping = 0;
        reg [15:0] closed = 0;
        wire taken = in_valid && !skipping;
        wire final_place = place == {inputs - 1};
        wire good = taken && final_place && in_last && closed == 0;
        wire wrong = taken && (final_place || in_last) && !good;
        always @(posedge clk) begin
            if (taken) place <= final_place || in_last ? 0 : place + 1;
            if (in_valid) skipping <= !in_last && (skipping || final_place);
            closed <= good ? {max(spacing - 1, 0)} : closed == 0 ? 0 : closed - 1;
            if (rst) begin
                place <= 0;
                skipping <= 0;
                closed <= 0;
            end
        end
    """
