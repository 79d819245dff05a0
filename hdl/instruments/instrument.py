"""Instrument: turns the codes of a converter behind an analogue multiplexer into results."""

from myhdl import block

from golden.instruments.instrument import Instrument
from golden.numbers.precision import SIGNAL
from hdl.common.signals import Stream, fixed, flag
from hdl.instruments.readout import readout
from hdl.sensing.scan_sequencer import scan_sequencer


@block
def instrument(
    clk, rst, out: Stream, *, adc, address, held, winner: Stream, profile, spec: Instrument
):
    """Codes of a converter in, results out (Figures 5.5, 5.12 and 5.25).

    Latency from the code of the last sample to the first output: 1 clock and that of readout. A
    frame every scan. There is no frame_error: the sequencer makes frames of the right length, at
    distances that its twin has checked. Reset starts a scan and clears every flag and counter.
    """
    valid, data, last = flag(), fixed(SIGNAL), flag()
    samples = Stream(valid=valid, data=data, last=last)
    shown = {"held": held, "winner": winner, "profile": profile}
    # This stays open: every frame has the right length and distance.
    broken = flag()
    return (
        scan_sequencer(clk, rst, samples, adc=adc, address=address, spec=spec.scan_sequencer),
        readout(clk, rst, samples, out, frame_error=broken, **shown, spec=spec.readout),
    )
