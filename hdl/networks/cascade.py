"""Cascade: each network sees the samples and the outputs of the networks before it."""

from myhdl import block

from golden.networks.cascade import Cascade
from golden.numbers.precision import SIGNAL
from hdl.common.lookup import hardware
from hdl.common.signals import Stream, Words, fixed, flag
from hdl.common.stream import catch, late_stream, window
from hdl.layers.input_controller import good_frame, judge
from hdl.layers.output_collector import output_collector
from hdl.sensing.stream_multiplexer import stream_multiplexer


@block
def stage(clk, rst, in_: Stream, following: Stream, *, network, multiplexer):
    """One network, and the stream for the next one, in which the result stands in its slot."""
    seen_valid, seen_last = flag(), flag()
    result_valid, result = flag(), fixed(SIGNAL)
    late_valid, late_data, late_last = flag(), fixed(SIGNAL), flag()
    # These stay open: each frame has one output, and errors of parts of frames do not matter.
    result_last, broken = flag(), flag()
    seen = Stream(valid=seen_valid, data=in_.data, last=seen_last)
    late = Stream(valid=late_valid, data=late_data, last=late_last)

    return (
        window(clk, rst, in_, seen, elements=network.inputs),
        hardware(network)(
            clk,
            rst,
            seen,
            Stream(valid=result_valid, data=result, last=result_last),
            frame_error=broken,
            spec=network,
        ),
        late_stream(clk, rst, in_, late, clocks=network.latency),
        stream_multiplexer(
            clk, rst, late, following, result_valid=result_valid, result=result, spec=multiplexer
        ),
    )


@block
def store(clk, rst, in_: Stream, good: Stream, *, frame_error, controller, collector):
    """Passes good frames on, one element a clock; a wrong frame only gives its error."""
    words = Words(collector.outputs, lambda: fixed(SIGNAL))
    complete = flag()
    return (
        good_frame(
            clk, rst, in_, words, good=complete, frame_error=frame_error, controller=controller
        ),
        output_collector(clk, rst, Stream(valid=complete, data=words), good, spec=collector),
    )


@block
def cascade(clk, rst, in_: Stream, out: Stream, *, frame_error, spec: Cascade):
    """A frame of samples and free slots in, a frame of outputs out (section 5.5, Figure 5.12).

    Network i works on the samples and the first i slots of its stream. That stream is then
    delayed by the network's latency, so that the result is there when its slot comes, however
    long the sender pauses between elements, and is put into the slot: the next network's stream.
    Latency from the last element to the first output: ``spec.latency`` clocks; a frame may
    follow the last after ``spec.interval`` clocks. Reset clears every flag and counter.
    """
    final = spec.outputs - 1
    # Stream i, counted from 0, holds the results up to that of network i.
    valid, data, last = Words(final, flag), Words(final, lambda: fixed(SIGNAL)), Words(final, flag)
    tail_valid, tail_data, tail_last = flag(), fixed(SIGNAL), flag()
    gathered_valid = flag()
    gathered = Words(spec.outputs, lambda: fixed(SIGNAL))
    # These stay open: the collector closes the frame, and of the judge only the error is used.
    final_last, broken, complete = flag(), flag(), flag()
    # The earlier outputs pass by in the last network's stream. That is delayed by one clock less
    # than the network's latency, because a word that is caught is there one clock later.
    wait = spec.networks[final].latency - 1

    controller, collector = spec.input_controller, spec.frame_store
    if collector is None:
        first = in_
        front = judge(clk, rst, in_, good=complete, frame_error=frame_error, controller=controller)
    else:
        first_data, first_last, first_valid = fixed(SIGNAL), flag(), flag()
        first = Stream(valid=first_valid, data=first_data, last=first_last)
        front = store(
            clk,
            rst,
            in_,
            first,
            frame_error=frame_error,
            controller=controller,
            collector=collector,
        )
    # What each network sees.
    streams = [first, *(Stream(valid=valid[i], data=data[i], last=last[i]) for i in range(final))]
    tail = Stream(valid=tail_valid, data=tail_data, last=tail_last)

    return (
        front,
        [
            stage(
                clk,
                rst,
                streams[i],
                streams[i + 1],
                network=spec.networks[i],
                multiplexer=spec.multiplexers[i],
            )
            for i in range(final)
        ],
        hardware(spec.networks[final])(
            clk,
            rst,
            streams[final],
            Stream(valid=gathered_valid, data=gathered[final], last=final_last),
            frame_error=broken,
            spec=spec.networks[final],
        ),
        late_stream(clk, rst, streams[final], tail, clocks=wait),
        catch(clk, rst, tail, gathered, first=spec.inputs, slots=final),
        output_collector(
            clk, rst, Stream(valid=gathered_valid, data=gathered), out, spec=spec.output_collector
        ),
    )
