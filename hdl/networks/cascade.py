"""Cascade: each network sees the samples and the outputs of the networks before it."""

from myhdl import block

from golden.networks.cascade import Cascade
from golden.precision import SIGNAL
from hdl.common.delay import delay
from hdl.common.lookup import latency
from hdl.common.signals import Words, fixed, flag, unsigned
from hdl.common.stream import catch, window
from hdl.layers.input_controller import input_controller
from hdl.layers.output_collector import output_collector
from hdl.networks.hybrid import hybrid
from hdl.sensing.stream_multiplexer import stream_multiplexer


@block
def cascade(
    clk,
    rst,
    in_valid,
    in_data,
    in_last,
    out_valid,
    out_data,
    out_last,
    frame_error,
    *,
    spec: Cascade,
):
    """A frame of samples and free slots in, a frame of outputs out (section 5.5, Figure 5.12).

    Parameters
    ----------
    in_valid, in_data, in_last : bool, signed Fix(14,13), bool
        One element a clock at most: ``spec.inputs`` samples, then one free slot, whatever it
        holds, for each output but the last. ``in_last`` closes the last of them.
    out_valid, out_data, out_last : bool, signed Fix(14,13), bool
        One output a clock, in the order of the networks.
    frame_error : bool
        One clock long for each frame of the wrong length, which yields no result.
    spec : Cascade

    Notes
    -----
    Network i works on the first ``spec.inputs + i`` elements of its stream. That stream is then
    delayed by the network's latency, so that the result is there when its slot comes, however
    long the sender pauses between elements, and is put into the slot: the next network's stream.
    Latency from the last element to the first output: ``cascade.latency(spec)`` clocks; frames may
    follow without a gap. Reset clears every flag and counter.
    """
    samples, outputs = spec.inputs, spec.outputs
    final = outputs - 1
    clocks = [latency(network) for network in spec.networks]
    # Stream i + 1, which has the results up to that of network i.
    valid, data, last = Words(final, flag), Words(final, lambda: fixed(SIGNAL)), Words(final, flag)
    late_valid, late_last = Words(final, flag), Words(final, flag)
    late_data = Words(final, lambda: fixed(SIGNAL))
    seen_valid, seen_last = Words(final, flag), Words(final, flag)
    result_valid, result = Words(final, flag), Words(final, lambda: fixed(SIGNAL))
    # Left open: ends of frames of one output, errors of parts of frames, and all but the judgement
    # of the controller that sees whole frames.
    result_last, broken = Words(outputs, flag), Words(outputs, flag)
    addr = unsigned(spec.input_controller.addr_width)
    preset, accumulate, capture, complete = flag(), flag(), flag(), flag()
    tail_valid, tail_last, tail_data = flag(), flag(), fixed(SIGNAL)
    gathered_valid = flag()
    gathered = Words(outputs, lambda: fixed(SIGNAL))

    def stream(i):
        """What network i sees, with the elements after its own."""
        return (valid[i - 1], data[i - 1], last[i - 1]) if i else (in_valid, in_data, in_last)

    stages = []
    for i in range(final):
        stream_valid, stream_data, stream_last = stream(i)
        stages += [
            window(
                clk,
                rst,
                stream_valid,
                stream_last,
                seen_valid[i],
                seen_last[i],
                elements=samples + i,
            ),
            hybrid(
                clk,
                rst,
                seen_valid[i],
                stream_data,
                seen_last[i],
                result_valid[i],
                result[i],
                result_last[i],
                broken[i],
                spec=spec.networks[i],
            ),
            delay(clk, rst, stream_valid, late_valid[i], clocks=clocks[i]),
            delay(clk, None, stream_data, late_data[i], clocks=clocks[i]),
            delay(clk, rst, stream_last, late_last[i], clocks=clocks[i]),
            stream_multiplexer(
                clk,
                rst,
                late_valid[i],
                late_data[i],
                late_last[i],
                result_valid[i],
                result[i],
                valid[i],
                data[i],
                last[i],
                spec=spec.multiplexers[i],
            ),
        ]
    final_valid, final_data, final_last = stream(final)
    ending = hybrid(
        clk,
        rst,
        final_valid,
        final_data,
        final_last,
        gathered_valid,
        gathered[final],
        result_last[final],
        broken[final],
        spec=spec.networks[final],
    )
    # The earlier outputs pass by in the last network's stream. One clock short of its latency,
    # because a word caught is there a clock later.
    wait = clocks[final] - 1
    tail = [
        delay(clk, rst, final_valid, tail_valid, clocks=wait),
        delay(clk, None, final_data, tail_data, clocks=wait),
        delay(clk, rst, final_last, tail_last, clocks=wait),
        catch(clk, rst, tail_valid, tail_data, tail_last, gathered, first=samples, slots=final),
    ]
    judge = input_controller(
        clk,
        rst,
        in_valid,
        in_last,
        addr,
        preset,
        accumulate,
        capture,
        complete,
        frame_error,
        spec=spec.input_controller,
    )
    return (
        judge,
        stages,
        ending,
        tail,
        output_collector(
            clk,
            rst,
            gathered_valid,
            gathered,
            out_valid,
            out_data,
            out_last,
            spec=spec.output_collector,
        ),
    )


cascade.latency = lambda spec: sum(
    latency(part) for part in (*spec.networks, *spec.multiplexers, spec.output_collector)
)
