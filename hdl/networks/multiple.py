"""Multiple: independent networks side by side, one for each output."""

from myhdl import block

from golden.networks.multiple import Multiple
from golden.numbers.precision import SIGNAL
from hdl.common.delay import delay
from hdl.common.lookup import hardware
from hdl.common.signals import Stream, Words, fixed, flag
from hdl.layers.output_collector import output_collector


@block
def multiple(clk, rst, in_: Stream, out: Stream, *, frame_error, spec: Multiple):
    """A frame of samples in, a frame with one output of each network out (section 3.12).

    Latency from the last sample to the first output: that of the slowest network and 1 clock; the
    results of the others wait for it. Reset clears every flag and counter.
    """
    outputs = spec.outputs
    clocks = [network.latency for network in spec.networks]
    slowest = clocks.index(max(clocks))
    result_valid = Words(outputs, flag)
    result = Words(outputs, lambda: fixed(SIGNAL))
    aligned = Words(outputs, lambda: fixed(SIGNAL))
    result_last = Words(outputs, flag)
    broken = Words(outputs, flag)

    def destination(i):
        """Where network i puts its result: the slowest ones need no delay."""
        return result[i] if clocks[i] < clocks[slowest] else aligned[i]

    networks = [
        hardware(network)(
            clk,
            rst,
            in_,
            Stream(valid=result_valid[i], data=destination(i), last=result_last[i]),
            # All controllers judge the same frames, so the error of one of them is enough.
            frame_error=frame_error if i == 0 else broken[i],
            spec=network,
        )
        for i, network in enumerate(spec.networks)
    ]
    delays = [
        delay(clk, None, result[i], aligned[i], clocks=clocks[slowest] - clocks[i])
        for i in range(outputs)
        if clocks[i] < clocks[slowest]
    ]
    return (
        networks,
        delays,
        output_collector(
            clk,
            rst,
            Stream(valid=result_valid[slowest], data=aligned),
            out,
            spec=spec.output_collector,
        ),
    )
