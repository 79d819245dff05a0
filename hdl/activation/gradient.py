"""The modified Gradient activation: tanh in segments, with one multiplier for all of them."""

from myhdl import block

from golden.activation.gradient import Gradient
from hdl.activation.abs_unit import abs_unit
from hdl.activation.comparator_bank import comparator_bank
from hdl.activation.g_memory import g_memory
from hdl.activation.grad_eqn import grad_eqn
from hdl.activation.i_memory import i_memory
from hdl.activation.sign_retriever import sign_retriever
from hdl.common.delay import delay
from hdl.common.signals import Stream, flag, unsigned


@block
def gradient(clk, rst, in_: Stream, out: Stream, *, spec: Gradient):
    """Activation of ``in_data`` six clocks later (thesis section 5.4.3, Figure 5.10).

    One multiplier. Latency 6 clocks: ABS 1, comparator bank 1, GRAD_EQN 3, sign retriever 1; the
    memories are read between registers. One result a clock. Reset clears the valid flags.
    """
    mag_width = spec.abs_unit.mag_width
    mag_valid, addr_valid, sum_valid = flag(), flag(), flag()
    mag, segment_mag = unsigned(mag_width), unsigned(mag_width)
    negative, negative_late = flag(), flag()
    magnitude = Stream(valid=mag_valid, mag=mag, negative=negative)
    addr = unsigned(spec.comparator_bank.addr_width)
    coeff = unsigned(spec.g_memory.width)
    intercept = unsigned(spec.i_memory.width)
    result = unsigned(spec.out_fmt.width - 1)
    segment = Stream(valid=addr_valid, addr=addr, mag=segment_mag, coeff=coeff, intercept=intercept)
    unsigned_result = Stream(valid=sum_valid, mag=result, negative=negative_late)
    clocks = spec.comparator_bank.latency + spec.grad_eqn.latency

    return (
        abs_unit(clk, rst, in_, magnitude, spec=spec.abs_unit),
        comparator_bank(clk, rst, magnitude, segment, spec=spec.comparator_bank),
        g_memory(addr, coeff, spec=spec.g_memory),
        i_memory(addr, intercept, spec=spec.i_memory),
        grad_eqn(clk, rst, segment, Stream(valid=sum_valid, data=result), spec=spec.grad_eqn),
        delay(clk, None, negative, negative_late, clocks=clocks),
        sign_retriever(clk, rst, unsigned_result, out, spec=spec.sign_retriever),
    )
