"""Windowed: a network that also takes samples of past frames."""

from myhdl import block

from golden.networks.windowed import Windowed
from golden.numbers.precision import SIGNAL
from hdl.common.lookup import hardware
from hdl.common.signals import Stream, fixed, flag
from hdl.sensing.frame_window import frame_window


@block
def windowed(clk, rst, in_: Stream, out: Stream, *, frame_error, spec: Windowed):
    """A frame of samples in, a frame of outputs of it and of past ones out.

    Latency from the last sample to the first output: that of the frame window, the frame that it
    sends, and that of the network. The first ``spec.past`` good frames after a reset yield no
    outputs. Reset clears every flag and counter.
    """
    valid, data, last = flag(), fixed(SIGNAL), flag()
    samples = Stream(valid=valid, data=data, last=last)
    # This stays open, because the frame window sends no frame that the network refuses.
    broken = flag()
    return (
        frame_window(clk, rst, in_, samples, frame_error=frame_error, spec=spec.frame_window),
        hardware(spec.network)(clk, rst, samples, out, frame_error=broken, spec=spec.network),
    )
