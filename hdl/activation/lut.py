"""The look-up table activation: tanh is read from a table of 128 values."""

from myhdl import always, block

from golden.activation.lut import Lut
from hdl.activation.abs_unit import abs_unit
from hdl.activation.comparator_bank import comparator_bank
from hdl.activation.sign_retriever import sign_retriever
from hdl.common import ops
from hdl.common.delay import delay
from hdl.common.requantise import scale
from hdl.common.rom import rom
from hdl.common.signals import Stream, flag, unsigned


@block
def lut(clk, rst, in_: Stream, out: Stream, *, spec: Lut):
    """Activation of ``in_data`` four clocks later (thesis section 4.5.2.3.4).

    One multiplication by a constant. Latency 4 clocks: ABS 1, address and comparator 1, table 1,
    sign retriever 1. One result a clock. Reset clears the valid flags.
    """
    mag_width = spec.abs_unit.mag_width
    shift = spec.scale_shift
    high = spec.out_fmt.high
    addr_width = spec.addr_width
    product_width = max(mag_width + spec.scale.bit_length(), shift + addr_width)
    mag_valid, segment_valid, word_valid = flag(), flag(), flag()
    mag, late_mag = unsigned(mag_width), unsigned(mag_width)
    negative, negative_late = flag(), flag()
    magnitude = Stream(valid=mag_valid, mag=mag, negative=negative)
    beyond = unsigned(1)
    product, product_late = unsigned(product_width), unsigned(product_width)
    addr = unsigned(addr_width)
    word, result = unsigned(spec.out_fmt.width - 1), unsigned(spec.out_fmt.width - 1)
    segment = Stream(valid=segment_valid, addr=beyond, mag=late_mag)
    unsigned_result = Stream(valid=word_valid, mag=result, negative=negative_late)
    top = shift + addr_width

    @always(clk.posedge)
    def keep_product():
        product_late.next = product

    @always(clk.posedge)
    def choose():
        if beyond == 1:
            result.next = high
        else:
            result.next = word

    return (
        abs_unit(clk, rst, in_, magnitude, spec=spec.abs_unit),
        comparator_bank(clk, rst, magnitude, segment, spec=spec.comparator_bank),
        scale(mag, product, factor=spec.scale),
        keep_product,
        ops.bits(product_late, top, shift, addr),
        rom(addr, word, words=spec.words, meanings=spec.out_fmt.texts(spec.words)),
        choose,
        delay(clk, rst, segment_valid, word_valid, clocks=1),
        delay(clk, None, negative, negative_late, clocks=2),
        sign_retriever(clk, rst, unsigned_result, out, spec=spec.sign_retriever),
    )
