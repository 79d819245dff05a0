"""output_integral against its twin: corners, ends and borders of each sum, and recorded frames.

Each comes with every output row, as CONTROLLER 2 makes them, back to back and with gaps and resets.
"""

from dataclasses import dataclass

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import PARTS
from tb.common.properties import Property
from tb.common.recorded_frames import check_recorded, recorded_inputs
from tb.common.stimulus import border_frames, corner_frames, extreme_frames, rounding_frames
from tb.common.stream import check_stream
from tb.common.watch import pipeline

CASES = PARTS


def rows_of(twin, frames):
    """Each output row with its ``last`` and the activations, for every frame."""
    rows = np.tile(np.arange(twin.outputs), len(frames))
    last = (rows == twin.outputs - 1).astype(np.int64)
    activations = np.repeat(frames, twin.outputs, axis=0).T
    return {"in_addr": rows, "in_last": last} | {f"in_r_{j}": r for j, r in enumerate(activations)}


def expected(twin):
    def of_rows(addr, last, *activations):
        results = twin.process(np.stack(activations, axis=-1))
        return results[np.arange(len(addr)), addr], last

    return of_rows


async def check(bench, items, gap, resets):
    await check_stream(bench, items, expected(bench.twin), gap, resets)
    bench.finish(at_least=len(items["in_addr"]) // bench.twin.outputs)


def stimuli(bench, count=1000):
    """Rows and activations, as the block takes them, with ``count`` random frames among them."""
    fmt = bench.twin.in_fmt
    random = bench.rng.integers(fmt.low, fmt.high + 1, (count, bench.twin.hidden))
    ends = extreme_frames(fmt, bench.twin.weights)
    twin = bench.twin
    borders, _ = border_frames(bench.rng, twin, twin.weights, twin.biases, twin.factors)
    rounding, _ = rounding_frames(bench.rng, twin, twin.weights, twin.biases, twin.factors)
    frames = np.concatenate([corner_frames(fmt, twin.hidden), ends, borders, rounding, random])
    return rows_of(twin, frames)


@cocotb.test()
async def back_to_back(dut):
    bench = Bench(dut)
    await check(bench, stimuli(bench), gap=0.0, resets=False)


@cocotb.test()
async def what_recorded_frames_bring(dut):
    bench = Bench(dut)
    (frames,) = recorded_inputs(bench)
    await check_recorded(bench, expected(bench.twin), rows_of(bench.twin, frames))


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    await check(bench, stimuli(bench, count=400), gap=0.3, resets=True)


def properties(twin):
    return [
        pipeline(
            twin,
            (
                (r"delay3_taps\[0\] <= in_last", "delay3_taps[0] <= (in_last && in_valid)"),
                (r"delay3_taps\[1\] <= 0;", ""),
                (r"out_valid <= delay2_taps\[\(5 - 1\)\]", "out_valid <= delay2_taps[3]"),
            ),
            last="in_last",
        ),
        *no_overflow(twin),
    ]


def no_overflow(twin):
    """The property that products and their sums stay within the bounds of the twin."""
    low, high = twin.in_fmt.low, twin.in_fmt.high
    terms = [*(f"weigh{n}_term" for n in range(twin.hidden)), "bias"]
    registers = tree(terms, "total")
    # A row reaches the products after two clocks, and one more level of the adder tree per clock.
    clocks = 2 + registers[-1].clock
    rows = [f"reg [{twin.addr_width - 1}:0] row_{n};" for n in range(1, clocks + 1)]
    rows += [
        f"always @(posedge clk) row_{n} <= {f'row_{n - 1}' if n > 1 else 'in_addr'};"
        for n in range(1, clocks + 1)
    ]
    watch = "\n".join(rows)
    valid_row = {f"Rows are 0 to {twin.outputs - 1}.": f"in_addr < {twin.outputs}"}

    def ends(term, row):
        """The least and the largest value of a term."""
        if term == twin.hidden:
            return (twin.biases[row] << twin.bias_shift,) * 2
        return sorted((twin.weights[row][term] * r) >> twin.product_shift for r in (low, high))

    def within(name, members, clock):
        """The condition that a signal is within the bounds of a sum of these terms of its row."""
        bounds = [
            (sum(ends(t, row)[0] for t in members), sum(ends(t, row)[1] for t in members))
            for row in range(twin.outputs)
        ]
        return " && ".join(
            f"(row_{clock} != {row} || ($signed({name}) >= 64'sd0 + ({least}) "
            f"&& $signed({name}) <= 64'sd0 + ({most})))"
            for row, (least, most) in enumerate(bounds)
        )

    products = {
        f"{name} is one that its weight and an activation can give.": within(name, (n,), 2)
        for n, name in enumerate(terms)
    }
    sums = [within(r.name, r.terms, 2 + r.clock) for r in registers]
    counted = f"""
        reg [3:0] clocks = 0;
        always @(posedge clk) if (clocks != {clocks}) clocks <= clocks + 1;
    """
    fetched = [
        f"clocks < 1 || row_1 != {row} || $signed({name}) == {code}"
        for row in range(twin.outputs)
        for name, code in (
            *((f"weigh{n}_weight", code) for n, code in enumerate(twin.weights[row])),
            ("bias_term0_bias", twin.biases[row]),
        )
    ]
    exact = []
    for r in registers:
        added = " + ".join(f"64'sd0 + {name}" for name in r.added)
        watch += f"\nreg signed [63:0] whole_{r.name};"
        watch += f"\nalways @(posedge clk) whole_{r.name} <= {added};"
        exact.append(f"$signed({r.name}) == whole_{r.name}")
    return [
        Property(
            name="products",
            sentence="Each product, and the bias, is one that the twin's weight of its row and an "
            "activation can give.",
            states=tuple(f"clocks < 2 || ({text})" for text in products.values()),
            watch=watch + counted,
            assumes=valid_row,
            helps=(f"clocks <= {clocks}", f"clocks < 1 || row_1 < {twin.outputs}", *fetched),
            reached=("clocks == 2",),
            refuted_by=(
                (r"0: weigh0_word = ", "0: weigh0_word = 100000 + "),
                (r"bias_term0_wide << 13", "bias_term0_wide << 12"),
            ),
            clocks=4,
        ),
        Property(
            name="no overflow",
            sentence="No sum of the adder tree loses a bit, and the whole sum stays within the "
            "limits that the twin gives for its row, whatever the products are.",
            states=(*(f"!settled || {text}" for text in exact), f"!settled || ({sums[-1]})"),
            watch=watch + counted + f"wire settled = clocks == {clocks};",
            assumes={**products, **valid_row},
            helps=(
                f"clocks <= {clocks}",
                *(f"clocks < {n} || row_{n} < {twin.outputs}" for n in range(1, clocks + 1)),
                *(f"clocks < {2 + r.clock} || ({s})" for r, s in zip(registers, sums, strict=True)),
            ),
            free=tuple(terms),
            reached=("settled",),
            refuted_by=(
                (r"signed \[31:0\] total", "signed [30:0] total"),
                (
                    r"signed \[31:0\] adder_tree0_add_pair0_total",
                    "signed [29:0] adder_tree0_add_pair0_total",
                ),
            ),
            clocks=clocks + 2,
        ),
    ]


@dataclass(frozen=True)
class Register:
    """One register of the tree.

    added: The registers that it adds, or the one that it delays.
    terms: The numbers of the terms of the whole sum that it contains.
    clock: How many clocks it stands behind the terms.
    """

    name: str
    added: tuple[str, ...]
    terms: tuple[int, ...]
    clock: int


def tree(terms: list[str], total: str) -> list[Register]:
    """All registers in the order of their clocks; ``total`` is the last one."""
    level = [Register(name, (), (n,), 0) for n, name in enumerate(terms)]
    found: list[Register] = []
    pairs = delays = 0
    while len(level) > 1:
        above = []
        for n in range(0, len(level), 2):
            pair = level[n : n + 2]
            if len(pair) == 1:
                name = f"adder_tree0_delay{delays}_data_late"
                delays += 1
            else:
                name = total if len(level) == 2 else f"adder_tree0_add_pair{pairs}_total"
                pairs += 1
            above.append(
                Register(
                    name,
                    tuple(part.name for part in pair),
                    tuple(term for part in pair for term in part.terms),
                    pair[0].clock + 1,
                )
            )
        found += above
        level = above
    return found
