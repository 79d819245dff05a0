"""Parallel: a network of two layers that does every multiplication at once."""

from myhdl import block

from golden.networks.parallel import Parallel
from golden.numbers.precision import SIGNAL
from hdl.common.delay import connect, delay
from hdl.common.lookup import hardware
from hdl.common.signals import Stream, Words, fixed, flag, unsigned
from hdl.layers.input_controller import input_controller
from hdl.layers.neuron import neuron


@block
def late(clk, rst, data, data_late, *, clocks: int):
    """As ``delay``, but with 0 clocks it is a connection."""
    return delay(clk, rst, data, data_late, clocks=clocks) if clocks else connect(data, data_late)


@block
def parallel(clk, rst, in_: Stream, out: Stream, *, frame_error, spec: Parallel):
    """A frame of samples in one clock, all outputs in another (thesis section 5.2).

    Latency: ``spec.latency`` clocks, a frame every ``spec.interval`` clocks. Reset clears
    every flag and counter.
    """
    hidden = len(spec.activations)
    in_fmt = spec.activations[0].in_fmt
    controller = spec.input_controller
    addr = unsigned(controller.addr_width)
    last, preset, accumulate, accepted, whole, q_valid = (flag() for _ in range(6))
    q = Words(hidden, lambda: fixed(in_fmt))
    r = Words(hidden, lambda: fixed(SIGNAL))
    r_valid = Words(hidden, flag)

    return (
        # A frame is one element, which is the last of its frame. The two ports take two signals: if
        # they shared one, the exported entity would read only one of its ports.
        connect(in_.valid, last),
        input_controller(
            clk,
            rst,
            Stream(valid=in_.valid, last=last),
            addr=addr,
            preset=preset,
            accumulate=accumulate,
            capture=accepted,
            out_valid=whole,
            frame_error=frame_error,
            spec=controller,
        ),
        [neuron(clk, in_.data, q[j], spec=part) for j, part in enumerate(spec.hidden_neurons)],
        # A neuron has at least three stages, as many as the controller has up to ``capture``.
        late(
            clk,
            rst,
            accepted,
            q_valid,
            clocks=spec.hidden_neurons[0].latency - controller.latency + 1,
        ),
        [
            hardware(activation)(
                clk,
                rst,
                Stream(valid=q_valid, data=q[j]),
                Stream(valid=r_valid[j], data=r[j]),
                spec=activation,
            )
            for j, activation in enumerate(spec.activations)
        ],
        [neuron(clk, r, out.data[i], spec=part) for i, part in enumerate(spec.output_neurons)],
        delay(clk, rst, r_valid[0], out.valid, clocks=spec.output_neurons[0].latency),
    )
