"""Hybrid: a network of two layers, folded over its inputs and over its outputs."""

from myhdl import block

from golden.networks.hybrid import Hybrid
from hdl.common.lookup import hardware
from hdl.common.signals import Stream, Words, fixed, flag, unsigned
from hdl.layers.input_controller import input_controller
from hdl.layers.input_integral import input_integral
from hdl.layers.output_controller import output_controller
from hdl.layers.output_integral import output_integral


@block
def hybrid(clk, rst, in_: Stream, out: Stream, *, frame_error, spec: Hybrid):
    """A frame of sensor samples in, a frame of outputs out (thesis section 5.4, Figure 5.8).

    Latency from the last sample to the first output: ``spec.latency`` clocks; a frame may
    follow the last after ``spec.interval`` clocks. Reset clears every flag and counter.
    """
    hidden = len(spec.activations)
    in_fmt = spec.activations[0].in_fmt
    addr = unsigned(spec.input_controller.addr_width)
    preset, accumulate, capture, q_valid = flag(), flag(), flag(), flag()
    q = Words(hidden, lambda: fixed(in_fmt))
    r = Words(hidden, lambda: fixed(spec.output_integral.in_fmt))
    r_valid = Words(hidden, flag)
    row = unsigned(spec.output_controller.addr_width)
    row_valid, row_last = flag(), flag()
    rows = Stream(valid=row_valid, last=row_last, addr=row, r=r)

    return (
        input_controller(
            clk,
            rst,
            in_,
            addr=addr,
            preset=preset,
            accumulate=accumulate,
            capture=capture,
            out_valid=q_valid,
            frame_error=frame_error,
            spec=spec.input_controller,
        ),
        input_integral(
            clk,
            in_data=in_.data,
            addr=addr,
            preset=preset,
            accumulate=accumulate,
            capture=capture,
            out_q=q,
            spec=spec.input_integral,
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
        output_controller(
            clk, rst, rows, in_valid=r_valid[0], addr=row, spec=spec.output_controller
        ),
        output_integral(clk, rst, rows, out, spec=spec.output_integral),
    )
