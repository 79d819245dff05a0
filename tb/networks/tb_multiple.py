"""multiple, networks side by side, against its twin: the tests of tb/common/network.py.

Of many random frames, those with the least and the largest output of each network come too.
"""

import cocotb
import numpy as np

from golden.numbers.precision import SIGNAL
from tb.common import watch
from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.network import TESTS, check, pauses, random_elements, whole_frames
from tb.common.properties import Property
from tb.common.watch import ago, frames

CASES = cases("multiples")
# A case in which the least distance of frames is more than their length.
PROVED = ("wide-multiple",)

# How many frames are searched for the least and the largest outputs, and how many of each are
# played.
MANY, ENDS = 1 << 16, 4

recorded, corners_and_random, wrong_lengths, resets_in_mid_frame, reset_at_every_clock = TESTS


@cocotb.test()
async def ends_of_outputs(dut):
    """Play the least and the largest outputs, so that each output changes its sign if it can."""
    bench = Bench(dut)
    frames = random_elements(bench, MANY * bench.twin.inputs).reshape(MANY, -1)
    at_rail = bench.rng.random(frames.shape) < 0.5
    frames[at_rail] = bench.rng.choice([SIGNAL.low, SIGNAL.high], at_rail.sum())
    order = np.argsort(bench.twin.process(frames), axis=0, kind="stable")
    ends = frames[np.concatenate([order[:ENDS], order[-ENDS:]]).ravel()]
    elements, last = whole_frames(bench, ends)
    await check(bench, elements, last, gap=0.0, pause=pauses(bench, last, closest=True))
    bench.finish(at_least=len(ends) * bench.twin.outputs)


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
        *watch.network(
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
