"""Converter instrument: turns the bits of a converter on an SPI into results."""

from myhdl import block

from golden.instruments.converter_instrument import ConverterInstrument
from golden.numbers.precision import SIGNAL
from hdl.common.signals import Stream, fixed, flag
from hdl.instruments.readout import readout
from hdl.sensing.converter_reader import converter_reader


@block
def converter_instrument(
    clk,
    rst,
    out: Stream,
    *,
    miso,
    sclk,
    cs_n,
    mosi,
    converter_error,
    held,
    winner: Stream,
    profile,
    spec: ConverterInstrument,
):
    """Bits of a converter in, results out.

    Latency from the last bit of a scan to the first output: that of converter_reader, a clock for
    each further element of a frame, and that of readout. A frame every scan, and none while
    ``converter_error`` is up. There is no frame_error: frames have the right length, at distances
    that the twin has checked. Reset starts a scan and clears every flag and counter.
    """
    valid, data, last = flag(), fixed(SIGNAL), flag()
    samples = Stream(valid=valid, data=data, last=last)
    wires = {"miso": miso, "sclk": sclk, "cs_n": cs_n, "mosi": mosi}
    shown = {"held": held, "winner": winner, "profile": profile}
    # This stays open: every frame has the right length and distance.
    broken = flag()
    return (
        converter_reader(
            clk, rst, samples, **wires, converter_error=converter_error, spec=spec.converter_reader
        ),
        readout(clk, rst, samples, out, frame_error=broken, **shown, spec=spec.readout),
    )
