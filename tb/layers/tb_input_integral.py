"""input_integral against its twin: corners, ends and borders of each sum, and recorded frames.

Control signals come as CONTROLLER 1 makes them, in no other order.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench, Recording
from tb.common.case_library import PARTS
from tb.common.properties import Property
from tb.common.recorded_frames import recorded_inputs
from tb.common.stimulus import border_frames, corner_frames, extreme_frames, rounding_frames, spread

CASES = PARTS
# A case in which products are truncated.
PROVED = ("wide-thesis",)


def stimuli(bench):
    """The frames that are played, as the twin takes them."""
    twin, fmt = bench.twin, bench.twin.in_fmt
    random = bench.rng.integers(fmt.low, fmt.high + 1, (300, twin.inputs))
    ends = extreme_frames(fmt, twin.weights)
    borders, _ = border_frames(bench.rng, twin, twin.weights, twin.biases)
    rounding, _ = rounding_frames(bench.rng, twin, twin.weights, twin.biases)
    corners = corner_frames(fmt, twin.inputs)
    return np.concatenate([corners, ends, borders, rounding, random, *recorded_inputs(bench)])


@cocotb.test()
async def frames(dut):
    bench = Bench(dut)
    twin, inputs = bench.twin, bench.twin.inputs
    driven = stimuli(bench)
    addr = np.tile(np.arange(inputs), (len(driven), 1))
    ports = [f"out_q_{j}" for j in range(bench.twin.hidden)]
    for gap in (0.0, 0.4):
        drive = node_timeline(bench.rng, {"in_data": driven, "addr": addr}, gap)
        recording = await bench.play(drive, ports)
        samples, held = captured_rows(recording, inputs)
        bench.compare("addr", recording.unsigned("addr", samples.ravel()), addr.ravel())
        seen = recording.signed("in_data", samples.ravel()).reshape(samples.shape)
        expected = twin.process(seen)
        for quantity, sums in twin.quantities(seen).items():
            bench.meet(quantity, sums)
        # Each sum is compared in its first clock and in the last clock before the next sum.
        for rows in (held, np.append(held[1:] - 1, recording.clocks - 1)):
            got = np.stack([recording.signed(port, rows) for port in ports], axis=-1)
            bench.compare("out_q", got, expected, frame=seen)
    bench.finish(at_least=4 * len(driven))


def node_timeline(rng: np.random.Generator, items: dict[str, np.ndarray], gap: float):
    """Good frames as columns: the samples, what comes with them, and the control signals.

    items: For each port its values, shape (frames, inputs), which stand in the clock of the sample.
    gap: Probability of an idle clock before each sample.
    """
    count, inputs = items["in_data"].shape
    columns = {name: values.ravel() for name, values in items.items()}
    place = np.tile(np.arange(inputs), count)
    drive = spread(rng, columns | {"place": place}, "valid", gap, tail=6)
    valid, place = drive.pop("valid").astype(bool), drive.pop("place")
    drive["accumulate"] = np.roll(valid, 2).astype(np.int64)
    drive["preset"] = np.roll(valid & (place == 0), 2).astype(np.int64)
    drive["capture"] = np.roll(valid & (place == inputs - 1), 3).astype(np.int64)
    return drive


def captured_rows(recording: Recording, inputs: int):
    """The rows of the samples, shape (frames, inputs), and the rows from which sums are held.

    A product enters the accumulator two clocks after its sample. ``capture`` takes the sum that the
    accumulator holds.
    """
    entered = recording.rows("accumulate") - 2
    first = recording.rows("preset") - 2
    assert np.array_equal(entered[::inputs], first), "preset does not open every frame"
    return entered.reshape(-1, inputs), recording.rows("capture") + 1


def properties(twin):
    low, high = twin.in_fmt.low, twin.in_fmt.high
    inputs, hidden = twin.inputs, twin.hidden

    def within(name, bounds):
        least, most = bounds
        whole = f"$signed({name})"
        return f"({whole} >= 64'sd0 + ({least}) && {whole} <= 64'sd0 + ({most}))"

    def reach(node, samples):
        """The least and the largest sum of the bias and so many samples."""
        start = twin.biases[node] << twin.bias_shift
        terms = [
            sorted((weight * x) >> twin.product_shift for x in (low, high))
            for weight in twin.weights[node][:samples]
        ]
        return tuple(start + sum(term[end] for term in terms) for end in (0, 1))

    # The position of a sample, one clock later beside its operands and two beside its product.
    watch = f"""
        reg [1:0] clocks = 0;
        reg [{twin.addr_width - 1}:0] at_1, at_2;
        reg [15:0] added = 0;
        always @(posedge clk) begin
            if (clocks != 2) clocks <= clocks + 1;
            at_1 <= addr;
            at_2 <= at_1;
            if (accumulate) added <= at_2 + 16'd1;
        end
    """
    in_frame = {f"Positions are 0 to {inputs - 1}.": f"addr < {inputs}"}
    products = {
        f"The product of node {node} is one that a sample and its weight can give.": (
            "clocks < 2 || ("
            + " && ".join(
                f"(at_2 != {k} || {within(f'u_input_node_{node}.product', ends)})"
                for k, weight in enumerate(twin.weights[node])
                for ends in [sorted(weight * x for x in (low, high))]
            )
            + ")"
        )
        for node in range(hidden)
    }
    controls = {
        "Products are added in the order of their positions, the first of a frame with preset.": (
            "!accumulate || (clocks == 2 && preset == (at_2 == 0) && (at_2 == 0 || at_2 == added))"
        )
    }
    known = ("clocks <= 2", f"clocks < 1 || at_1 < {inputs}", f"clocks < 2 || at_2 < {inputs}")
    return [
        Property(
            name="products",
            sentence="Each product is one that the twin's weight of its position and a sample can "
            "give.",
            states=tuple(products.values()),
            watch=watch,
            assumes=in_frame,
            helps=(
                *known,
                *(
                    f"clocks < 1 || at_1 != {k} || $signed(u_input_node_{node}.factor) == {weight}"
                    for node in range(hidden)
                    for k, weight in enumerate(twin.weights[node])
                ),
            ),
            reached=("clocks == 2",),
            refuted_by=(
                (r"0: weight_0 = .*;", f"0: weight_0 = {twin.coeff_fmt.high};"),
                (r"product <= \(sample \* factor\)", "product <= ((sample * factor) << 1)"),
            ),
            clocks=4,
        ),
        Property(
            name="no overflow",
            sentence="No sum of a node loses a bit, and the sum of a frame stays within the limits "
            "that the twin gives for the node, whatever the products are.",
            states=tuple(
                text
                for node in range(hidden)
                for part in [f"u_input_node_{node}"]
                for text in (
                    f"$signed({part}.start) == {twin.biases[node] << twin.bias_shift}",
                    f"!accumulate || $signed({part}.total) "
                    f"== 64'sd0 + $signed({part}.base) + $signed({part}.term)",
                    f"added != {inputs} || {within(f'{part}.acc', reach(node, inputs))}",
                )
            ),
            watch=watch,
            assumes={**in_frame, **products, **controls},
            helps=(
                *known,
                f"added <= {inputs}",
                *(
                    f"added != {n} || {within(f'u_input_node_{node}.acc', reach(node, n))}"
                    for node in range(hidden)
                    for n in range(1, inputs)
                ),
            ),
            free=tuple(f"u_input_node_{node}.product" for node in range(hidden)),
            reached=(f"added == {inputs}",),
            refuted_by=(
                (r"signed \[\d+:0\] total", f"signed [{twin.acc_width - 2}:0] total"),
                (r"bias_word << \d+", "bias_word >> 1"),
                (r"if \(accumulate\)", "if (1)"),
                (r"if \(preset\)", "if (0)"),
            ),
            clocks=8,
        ),
    ]
