"""Proved properties of multiple, whatever comes on its stream."""

from tb.common.properties import Property
from tb.common.watch import ago, frames, network

# A case in which the least distance of frames is more than their length.
ALSO = ("wide-multiple",)


def properties(twin):
    controllers = [f"u_hybrid_{n}.u_input_controller_0" for n in range(twin.outputs)]
    inputs, spacing = twin.input_controller.inputs, twin.input_controller.spacing
    slowest = max(member.latency for member in twin.networks)
    together, delays = [], []
    for n, member in enumerate(twin.networks):
        early = slowest - member.latency
        together.append(f"valid_{n}_ago[{early - 1}]" if early else f"result_valid_{n}")
        delays.append(ago(f"valid_{n}_ago", f"result_valid_{n}", early) if early else "")
    helps = [f"place == {controllers[0]}.count && skipping == {controllers[0]}.dropping"]
    helps += [f"place < {inputs}", "!skipping || place == 0"]
    helps += [f"{c}.count == place && {c}.dropping == skipping" for c in controllers]
    helps += [f"{c}.remaining == closed" for c in controllers] if spacing else []
    return [
        *network(
            twin,
            controllers[0],
            wrong=(
                (r"\.in_last\(in_last\)", ".in_last(in_last && in_data[0])"),
                (r"frame_error <= broken", "frame_error <= (broken && in_last)"),
            ),
            good=(
                (r"accept && complete && in_last", "accept && complete"),
                (r"remaining <= 3", "remaining <= 2"),
                (r"delay3_taps\[1\] <= 0;", ""),
            ),
            helps=tuple(helps),
        ),
        Property(
            name="results side by side",
            sentence="Each network gives its result of a frame as many clocks before the slowest "
            "network as its delay makes up for. So outputs of two frames are never gathered "
            "together.",
            states=tuple(f"{flag} == u_output_collector_0.in_valid" for flag in together),
            watch=frames(inputs, spacing) + "".join(delays),
            helps=tuple(helps),
            reached=("u_output_collector_0.in_valid",),
            refuted_by=(
                (r"(u_hybrid_1 \([^;]+?\.in_valid\(in_valid)", r"\1 && in_data[0]"),
                (r"(u_hybrid_2 \([^;]+?\.rst\()rst", r"\g<1>rst && in_valid"),
            ),
            clocks=slowest + 6,
            induction=slowest + 2,
        ),
    ]
