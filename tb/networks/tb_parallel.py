"""parallel, every multiplication at once, against its twin.

Recorded, corner, extreme and random frames come as close as it takes them, with gaps, closer, with
resets among them, and with one reset at each clock of a frame's way.
"""

import cocotb

from golden.layers.weighted_sum import tree_depth
from tb.common import at_once
from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.properties import Property
from tb.common.watch import ago, frames, pipe

CASES = cases("parallel")
# A case whose activation takes a frame only every few clocks, and one in which products are exact
# and sums are rounded.
PROVED = ("pade-parallel", "wide-parallel")


@cocotb.test()
async def recorded(dut):
    await at_once.recorded(Bench(dut))


@cocotb.test()
async def corners_and_random(dut):
    await at_once.corners_and_random(Bench(dut))


@cocotb.test()
async def too_close(dut):
    """Play frames closer than the design takes them, if it does not take one every clock."""
    bench = Bench(dut)
    pause = bench.rng.integers(0, bench.twin.interval + 1, 400)
    recording, _ = await at_once.check(bench, at_once.random_frames(bench, 400), 0.0, pause)
    errors = recording.rows("frame_error")
    assert bool(len(errors)) == (bench.twin.interval > 1), "frame_error is wrong throughout"
    bench.finish(at_least=20)


@cocotb.test()
async def resets_among_frames(dut):
    bench = Bench(dut)
    await at_once.resets_among_frames(bench, bench.rng.integers(0, bench.twin.interval + 1, 600))


@cocotb.test()
async def reset_at_every_clock(dut):
    await at_once.reset_at_every_clock(Bench(dut))


def properties(twin):
    spacing, late = twin.input_controller.spacing, twin.latency
    controller = "u_input_controller_0"
    helps = [
        "place == 0 && !skipping",
        f"{controller}.count == 0 && !{controller}.dropping",
        f"closed == {f'{controller}.remaining' if spacing else '0'}",
    ]
    # All samples come at once, so a frame is complete in the clock of in_valid.
    watch = frames(1, spacing).replace("in_last", "in_valid")
    no_result = "A frame that comes too early yields none." if spacing else "No frame is refused."
    return [
        Property(
            name="one for each",
            sentence=f"A frame, and nothing else, yields its outputs {late} clocks after it, "
            f"unless a reset came between. {no_result}",
            states=(f"out_valid == good_ago[{late - 1}]",),
            watch=watch + ago("good_ago", "good", late),
            helps=tuple(helps),
            reached=("out_valid", "good_ago == 1"),
            refuted_by=(
                (r"delay1_taps\[0\] <= r_valid_0", "delay1_taps[0] <= (r_valid_0 || out_valid)"),
                (r"(q_valid|taps\[0\]) <= accepted", r"\1 <= whole"),
                (r"(delay1_taps\[0\]) <= 0;", ""),
            ),
            clocks=late + 8,
            induction=late + 2,
        ),
        Property(
            name="frame_error",
            sentence="frame_error is high one clock after each frame that comes less than "
            f"{spacing} clocks after a good one, and in no other clock."
            if spacing
            else "frame_error is never high.",
            states=("frame_error == wrong_ago[0]",),
            watch=watch + ago("wrong_ago", "wrong", 1),
            helps=tuple(helps),
            reached=("frame_error",) if spacing else (),
            refuted_by=(
                (r"frame_error <= broken", "frame_error <= accept"),
                (r" && \(!done\)", ""),
            ),
        ),
    ]


def neuron(twin):
    low, high = twin.out_fmt.low, twin.out_fmt.high
    half = (1 << twin.out_shift) >> 1
    width = twin.in_fmt.width
    # A weight of 0 has no multiplier, but at least one multiplier stays.
    weights = [(k, w) for k, w in enumerate(twin.weights) if w] or [(0, twin.weights[0])]
    depth = tree_depth(len(twin.weights) + 1)
    products = {
        f"Product {n} is one that weight {k} and a sample can give.": f"$signed(weigh{n}_product) "
        f">= 64'sd0 + {ends[0]} && $signed(weigh{n}_product) <= 64'sd0 + {ends[1]}"
        for n, (k, weight) in enumerate(weights)
        for ends in [sorted((weight * twin.in_fmt.low, weight * twin.in_fmt.high))]
    }
    start = twin.bias << twin.bias_shift
    # In pairs, as the adders add: the same sum in another order takes a solver hours.
    level = [*(f"term_{n}" for n in range(len(weights))), f"64'sd0 + ({start})"]
    while len(level) > 1:
        level = [f"({' + '.join(level[n : n + 2])})" for n in range(0, len(level), 2)]
    wires = "\n".join(
        f"wire signed [63:0] whole_{n} = $signed(weigh{n}_product), "
        f"term_{n} = whole_{n} >>> {twin.product_shift};"
        for n in range(len(weights))
    )
    late = int(twin.factor is not None)
    scaled = f"{twin.factor} times the sum 2 clocks before" if late else "the sum one clock before"
    return [
        Property(
            name="products",
            sentence="Each product is that of the twin's weight and its sample, one clock later.",
            states=tuple(
                f"!there[0] || $signed(weigh{n}_product) == $signed(x_{n}_0) * 64'sd1 * {weight}"
                for n, (_, weight) in enumerate(weights)
            ),
            watch="\n".join(
                f"wire signed [{width - 1}:0] x_{n} = in_data_{k};"
                + pipe(f"x_{n}", 1, width, also=n == 0)
                for n, (k, _) in enumerate(weights)
            ),
            reached=("there[0] && x_0_0 == -3",),
            refuted_by=(
                (r"wide \* ", "wide * 3 * "),
                (r"wide = in_data_0", "wide = in_data_0 + 1"),
            ),
            clocks=3,
        ),
        Property(
            name="no overflow",
            sentence=f"No sum loses a bit: {depth} clocks behind the products stands the exact sum "
            "of the bias and all of them, whatever they are.",
            states=(f"!there[{depth}] || $signed(total) == sum_{depth - 1}",),
            watch=wires
            + f"""
                wire signed [63:0] sum = {level[0]};
            """
            + pipe("sum", depth, 64),
            assumes=products,
            free=tuple(f"weigh{n}_product" for n in range(len(weights))),
            reached=(f"there[{depth}] && sum_{depth - 1} > {max(start, 1)}",),
            refuted_by=(
                (r"signed \[\d+:0\] summed", f"signed [{twin.acc_width - 2}:0] summed"),
                (r"constant0_word <= .*;", "constant0_word <= 1;"),
                (r"(\w+_term) \+ (\w+_term)", r"\1 - \2"),
                (
                    r"signed \[\d+:0\] adder_tree0_add_pair0_total",
                    f"signed [{twin.acc_width // 2}:0] adder_tree0_add_pair0_total",
                ),
            ),
            clocks=depth + 2,
            induction=depth + 2,
        ),
        Property(
            name="result",
            sentence=f"The result is {scaled}, rounded half up, or the end of the "
            "result's range where that lies beyond it.",
            states=(f"!there[{late}] || $signed(out_data) == expected_{late}",),
            watch=f"""
                wire signed [63:0] exact = $signed(total) * 64'sd{twin.factor or 1};
                wire signed [63:0] rounds = (exact + 64'sd{half}) >>> {twin.out_shift};
                wire signed [63:0] expected = rounds < {low} ? {low} : rounds > {high} ? {high}
                    : rounds;
            """
            + pipe("expected", late + 1, 64),
            free=("total",),
            reached=(f"there[{late}] && expected_{late} < 0",),
            refuted_by=(
                (r"out_data <= result", "out_data <= -result"),
                *([(r"rounded = \((\w+) \+ \d+", r"rounded = (\1 + 0")] if twin.out_shift else []),
            ),
            clocks=late + 3,
            whole=True,
        ),
    ]


OF_PARTS = {"neuron": neuron}
