"""Proved properties of input_integral, for all samples."""

from tb.common.properties import Property

# A case in which products are truncated.
ALSO = ("wide-thesis",)


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
    known = (
        "clocks <= 2",
        f"clocks < 1 || at_1 < {inputs}",
        f"clocks < 2 || at_2 < {inputs}",
    )
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
