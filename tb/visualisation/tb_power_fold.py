"""power_fold against its twin: every P with t at its ends, about 1, about saturation, and between.

They come as close as it takes them, with gaps and resets, and closer.
"""

import numpy as np

from golden.visualisation.power_fold import border_data
from tb.common.case_library import cases
from tb.common.properties import Property
from tb.common.recorded_frames import recorded_test
from tb.common.stream import early_test, suite

CASES = cases("drawn")

PARTS = 256


def pairs(bench):
    twin = bench.twin
    powers = np.arange(1, twin.max_power + 1)
    one, most = 1 << twin.in_frac, (1 << twin.in_width) - 1
    near = (
        np.concatenate([[0, one, most], border_data(twin)])[:, np.newaxis] + np.arange(-2, 3)
    ).ravel()
    step = (most + 1) // PARTS
    spread = np.arange(0, most + 1, step) + bench.rng.integers(0, step, PARTS)
    t = np.concatenate([near[(near >= 0) & (near <= most)], spread])
    return {"in_data": np.tile(t, len(powers)), "in_power": np.repeat(powers, len(t))}


what_recorded_frames_bring = recorded_test(__name__)
sweep, gaps_and_resets = suite(__name__, pairs, at_once=1024)
early = early_test(__name__, pairs)


def properties(twin):
    most, late = twin.max_power - 1, twin.latency
    return [
        Property(
            name="one power for each",
            sentence=f"out_valid is high {late} clocks after an in_valid that neither another nor "
            "a reset has followed by then, and in no other clock. The product, the sum with the "
            "half that rounds it, and the rounded power are those of whole numbers: no bit is lost "
            "on the way to the accumulator. It is multiplied P - 1 times, and for P from 1 to "
            f"{twin.max_power} no result comes while multiplications are left.",
            states=(
                f"out_valid == (age == {late - 1})",
                "whole_rounded == $signed(requantise1_rounded)",
                "whole_kept == kept",
                "whole_first == first",
                "!out_valid || !right || uses == 0",
            ),
            watch=f"""
                // Clocks since the last in_valid; 255 where a reset came since or very many have.
                reg [7:0] age = 255;
                // Whether the last P, if one came since a reset, was from 1 to the largest one.
                reg right = 0;
                always @(posedge clk) begin
                    age <= rst ? 255 : in_valid ? 0 : age == 255 ? 255 : age + 1;
                    right <= !rst && (in_valid ? in_power >= 1 && in_power <= {most + 1} : right);
                end
                wire signed [63:0] whole_rounded = $signed({{30'b0, product}})
                    + 64'sd{(1 << twin.in_frac) >> 1};
                wire signed [63:0] whole_power = whole_rounded >>> {twin.in_frac};
                wire signed [63:0] most = 64'sd{(1 << twin.out_width) - 1};
                wire signed [63:0] whole_kept = whole_power > most ? most : whole_power;
                wire signed [63:0] whole_t = ($signed({{47'b0, in_data}})
                    + 64'sd{(1 << twin.in_frac - twin.out_frac) >> 1})
                    >>> {twin.in_frac - twin.out_frac};
                wire signed [63:0] whole_first = whole_t > most ? most : whole_t;
            """,
            helps=(
                f"remaining == (age < {late - 1} ? {late - 1} - age : 0)",
                f"!right || uses <= {most}",
                "!out_valid || remaining == 0",
                "!right || remaining == 0 || 2 * uses <= remaining + remaining[0]",
                "!right || remaining != 0 || uses == 0",
            ),
            # The output of the multiplier is free: this holds for every product that fits.
            free=("product",),
            reached=("out_valid && right",),
            refuted_by=(
                (r"remaining <= 10", "remaining <= 11"),
                (r"&& \(!in_valid\)\)", ")"),
                (r"remaining <= \(remaining - 1\)", "remaining <= (remaining - 3)"),
                (
                    r"wire signed \[35:0\] requantise1_rounded",
                    "wire signed [33:0] requantise1_rounded",
                ),
                (r"requantise1_kept > 131071", "requantise1_kept > 131072"),
                (r"uses <= \(in_power - 1\)", "uses <= in_power"),
                (r"\(remaining\[0\] &&", "((remaining[1:0] == 0) &&"),
            ),
            clocks=late + 6,
        )
    ]
