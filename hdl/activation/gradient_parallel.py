"""The Gradient activation as first drawn: tanh in segments, with a multiplier for each segment."""

from myhdl import always_comb, block

from golden.activation.gradient_parallel import GradientParallel
from hdl.activation.abs_unit import abs_unit
from hdl.activation.comparator_bank import comparator_bank
from hdl.activation.grad_eqn import grad_eqn
from hdl.activation.sign_retriever import sign_retriever
from hdl.common.delay import delay
from hdl.common.signals import Stream, Words, flag, unsigned


@block
def enable(addr, coeff, intercept, *, segment: int, words):
    """The constants of ``segment``, or 0 while ``addr`` names another segment."""
    gradient, constant_term = words

    @always_comb
    def choose():
        if addr == segment:
            coeff.next = gradient
            intercept.next = constant_term
        else:
            coeff.next = 0
            intercept.next = 0

    return choose


@block
def threshold_unit(addr, data, *, segment: int, high: int):
    """``data`` is the largest result where ``addr`` is beyond the last segment, otherwise 0."""

    @always_comb
    def choose():
        if addr == segment:
            data.next = high
        else:
            data.next = 0

    return choose


@block
def add(left, right, total):
    """The sum of two numbers, one of which is 0, so that nothing carries and no adder is needed."""

    @always_comb
    def merge():
        total.next = left | right

    return merge


@block
def gradient_parallel(clk, rst, in_: Stream, out: Stream, *, spec: GradientParallel):
    """Activation of ``in_data`` six clocks later (thesis section 4.5.2.3.1, Figure 4.16).

    One multiplier for each segment that the neuron can reach. Latency 6 clocks: ABS 1, comparator
    bank 1, gradient operation 3, sign retriever 1. One result a clock. Reset clears the valid
    flags.
    """
    bank, line = spec.comparator_bank, spec.grad_eqn
    mag_width = spec.abs_unit.mag_width
    count = len(spec.segments)
    result_width = spec.out_fmt.width - 1
    mag_valid, addr_valid = flag(), flag()
    mag, segment_mag = unsigned(mag_width), unsigned(mag_width)
    negative, negative_late = flag(), flag()
    magnitude = Stream(valid=mag_valid, mag=mag, negative=negative)
    addr = unsigned(bank.addr_width)
    coeff = Words(count, lambda: unsigned(spec.table.coeff_width))
    intercept = Words(count, lambda: unsigned(spec.intercept_width))
    valid = Words(count, flag)
    result = Words(count, lambda: unsigned(result_width))
    terms = [result[n] for n in range(count)]
    if spec.saturates:
        addr_late, limit = unsigned(bank.addr_width), unsigned(result_width)
        terms.append(limit)
    total = Words(len(terms) - 1, lambda: unsigned(result_width))
    sums = [terms[0], *(total[n] for n in range(len(total)))]
    unsigned_result = Stream(valid=valid[0], mag=sums[-1], negative=negative_late)

    clocks = line.latency
    saturate = []
    if spec.saturates:
        saturate = [
            delay(clk, None, addr, addr_late, clocks=clocks),
            threshold_unit(addr_late, limit, segment=count, high=spec.out_fmt.high),
        ]
    return (
        abs_unit(clk, rst, in_, magnitude, spec=spec.abs_unit),
        comparator_bank(
            clk, rst, magnitude, Stream(valid=addr_valid, addr=addr, mag=segment_mag), spec=bank
        ),
        [
            enable(addr, coeff[n], intercept[n], segment=n, words=spec.segments[n])
            for n in range(count)
        ],
        [
            grad_eqn(
                clk,
                rst,
                Stream(valid=addr_valid, mag=segment_mag, coeff=coeff[n], intercept=intercept[n]),
                Stream(valid=valid[n], data=result[n]),
                spec=line,
            )
            for n in range(count)
        ],
        saturate,
        [add(sums[n], terms[n + 1], total[n]) for n in range(len(total))],
        delay(clk, None, negative, negative_late, clocks=bank.latency + clocks),
        sign_retriever(clk, rst, unsigned_result, out, spec=spec.sign_retriever),
    )
