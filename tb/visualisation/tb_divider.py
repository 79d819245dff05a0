"""divider against its twin: extremes, random pairs, and those about the border of saturation.

They come as close as it takes them, with gaps and resets, and closer; a quotient stays.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.properties import Property
from tb.common.recorded_frames import recorded_test
from tb.common.stimulus import spread
from tb.common.stream import early_test, suite

CASES = cases("profiles")


def extremes(bits):
    top = (1 << bits) - 1
    return np.array([0, 1, 2, 3, 5, top // 2, top // 2 + 1, top - 1, top])


def pairs(bench):
    twin, rng = bench.twin, bench.rng
    most, widest = (1 << twin.distance_width) - 1, (1 << twin.width_width) - 1
    # A comparison with 0 that ignores a bit takes a width with only that bit for 0.
    some = np.union1d(extremes(twin.width_width), 1 << np.arange(twin.width_width))
    grid = np.meshgrid(extremes(twin.distance_width), some)
    widths = np.sort(rng.integers(1, widest + 1, 400))
    # The first quotient that saturates has distance * gain / width = 2 ** integer bits.
    border = (widths << (twin.out_width - twin.out_frac + twin.gain_frac)) // twin.gain
    near = border + rng.integers(-1, 3, 400)
    about, at, quotients = twin.about_border
    closest = np.argsort(np.abs(quotients - (1 << twin.out_width)), kind="stable")
    closest = np.concatenate(
        [
            closest[beyond[closest]][:20]
            for beyond in (quotients >> twin.out_width > 0, quotients >> twin.out_width == 0)
        ]
    )
    distances = [grid[0].ravel(), np.clip(near, 0, most), about[closest]]
    distances.append(rng.integers(0, most + 1, 2000))
    every = [grid[1].ravel(), widths, at[closest], rng.integers(0, widest + 1, 2000)]
    return {"in_distance": np.concatenate(distances), "in_width": np.concatenate(every)}


what_recorded_frames_bring = recorded_test(__name__)
sweep, gaps_and_resets = suite(__name__, pairs, at_once=1024)
early = early_test(__name__, pairs)


@cocotb.test()
async def stays(dut):
    """Check that a quotient stays until ``out_width`` clocks before the next one."""
    bench = Bench(dut)
    twin, rng, count = bench.twin, bench.rng, 200
    every = pairs(bench)
    order = rng.integers(0, len(every["in_width"]), count)
    items = {name: values[order] for name, values in every.items()}
    pause = rng.integers(twin.interval - 1, 3 * twin.interval, count)
    drive = spread(rng, items, "in_valid", gap=0.0, tail=bench.latency + 4, pause=pause)
    recording = await bench.play(drive, ["out_valid", "out_data"])
    left = recording.rows("out_valid")
    clocks = np.diff(left, append=recording.clocks + twin.out_width) - twin.out_width
    first = np.repeat(left, clocks)
    rows = first + np.arange(len(first)) - np.repeat(np.cumsum(clocks) - clocks, clocks)
    got, expected = (recording.unsigned("out_data", at) for at in (rows, first))
    bench.compare("out_data", got, expected, clock=rows)
    bench.finish(at_least=10 * count)


def properties(twin):
    late = twin.latency
    return [
        Property(
            name="digits of one quotient",
            sentence=f"out_valid is high {late} clocks after an in_valid that is not followed by "
            f"another one within {late - 2} clocks or by a reset, and in no other clock. While "
            "digits are found, the remainder is below the divisor, and their difference keeps "
            "every bit, so that no step loses a bit. The numerator has room for every distance.",
            states=(
                f"out_valid == (age == {late - 2})",
                "remaining == 0 || load || remainder < divisor",
                "whole_trial == $signed(trial)",
                "whole_product == product",
            ),
            watch=f"""
                // Clocks since the one after the last in_valid; 255 where a reset came since.
                reg begun = 0;
                reg [7:0] age = 255;
                always @(posedge clk) begin
                    begun <= !rst && in_valid;
                    age <= rst ? 255 : begun ? 0 : age == 255 ? 255 : age + 1;
                end
                wire signed [63:0] whole_trial = $signed({{32'b0, shifted}})
                    - $signed({{32'b0, divisor}});
                wire [63:0] whole_product = in_distance * 64'd{twin.gain};
            """,
            helps=(
                "load == begun",
                f"remaining == (age < {late - 2} ? {late - 2} - age : 0)",
                "remaining == 0 || load || divisor != 0",
            ),
            reached=("out_valid", "out_valid && begun"),
            refuted_by=(
                (r"remaining <= 17", "remaining <= 16"),
                (r"&& \(!load\)\)", ")"),
                (r"remaining <= \(remaining - 1\)", "remaining <= (remaining - 2)"),
                (r"if \(fits\)", "if (!fits)"),
                (r"divisor <= 1;", "divisor <= 0;"),
                (r"wire \[16:0\] product", "wire [15:0] product"),
            ),
            clocks=late + 6,
        )
    ]
