"""Readout: holds the outputs of a network, draws the profile from them, and finds the largest."""

from myhdl import always_comb, always_seq, block

from golden.instruments.readout import Readout
from golden.numbers.precision import SIGNAL
from hdl.common import ops
from hdl.common.lookup import hardware
from hdl.common.signals import Stream, Words, fixed, flag, unsigned
from hdl.common.stream import catch_word, position
from hdl.layers.argmax import argmax
from hdl.visualisation.load_profile import load_profile


@block
def draw(clk, rst, results: Stream, words, profile, *, drawing):
    """Draws the profile from the words, beginning in the clock after the last of them came."""
    complete = flag()
    load, position, width, shape = (words[slot] for slot in drawing.results)

    @always_seq(clk.posedge, reset=rst)
    def finish():
        complete.next = results.valid and results.last

    return finish, load_profile(
        clk,
        rst,
        Stream(valid=complete, load=load, position=position, width=width, shape=shape),
        profile,
        spec=drawing.load_profile,
    )


@block
def readout(
    clk,
    rst,
    in_: Stream,
    out: Stream,
    *,
    frame_error,
    held,
    winner: Stream,
    profile,
    load=None,
    image=None,
    target: Stream = None,
    learn=None,
    learn_error=None,
    theta: Stream = None,
    spec: Readout,
):
    """A frame of samples in; its outputs as a frame, held, and drawn (Figures 5.12 and 5.25).

    Latency that of the network, to the first output. An output is held from the clock after it
    stood on ``out_data``. The first point stands 1 clock and the latency of load_profile after the
    last output, or later where a ramp is still being drawn. Reset clears every flag and counter.
    """
    outputs = spec.outputs
    result_valid, result, result_last = flag(), fixed(SIGNAL), flag()
    results = Stream(valid=result_valid, data=result, last=result_last)
    count = unsigned(outputs.bit_length())
    words = Words(outputs, lambda: fixed(SIGNAL))

    @always_comb
    def show():
        out.valid.next = result_valid
        out.data.next = result
        out.last.next = result_last

    inner = {"load": load, "image": image} if spec.image else {}
    if spec.network.lesson_ports:
        inner = {"target": target, "learn": learn, "learn_error": learn_error, "theta": theta}
    parts = [
        hardware(spec.network)(
            clk, rst, in_, results, frame_error=frame_error, **inner, spec=spec.network
        ),
        show,
    ]
    if spec.holds:
        parts += [
            position(clk, rst, results, count, stop=outputs),
            [catch_word(clk, results, count, words[i], slot=i) for i in range(outputs)],
            [ops.widen(words[i], held[i]) for i in range(outputs)],
        ]
    if spec.argmax is not None:
        parts.append(argmax(clk, rst, results, winner, spec=spec.argmax))
    if spec.load_profile is not None:
        parts.append(draw(clk, rst, results, words, profile, drawing=spec))
    return parts
