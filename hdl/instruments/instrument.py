"""Instrument: a network and the profile that is drawn from its outputs."""

from myhdl import always_comb, always_seq, block

from golden.instruments.instrument import Instrument
from golden.precision import SIGNAL
from hdl.common.lookup import hardware, latency
from hdl.common.signals import fixed, flag, unsigned
from hdl.common.stream import catch_word, position, stream_ports
from hdl.visualisation.load_profile import load_profile


@block
def instrument(
    clk,
    rst,
    in_valid,
    in_data,
    in_last,
    out_valid,
    out_data,
    out_last,
    frame_error,
    profile_valid,
    profile_x,
    profile_y,
    profile_last,
    *,
    spec: Instrument,
):
    """A frame of samples in; a frame of outputs and the load along the beam out (Figure 5.25).

    Parameters
    ----------
    in_valid, in_data, in_last, out_valid, out_data, out_last, frame_error
        Those of the network.
    profile_valid, profile_x, profile_y, profile_last : bool, signed Fix(14,13) twice, bool
        A point, i_p and f, which stays until the next; ``profile_last`` with the last of a ramp.
    spec : Instrument

    Notes
    -----
    Latency that of the network, to the first output. The first point stands 1 clock and the latency
    of load_profile after the last output, or later where a ramp is still being drawn. Reset clears
    every flag and counter.
    """
    outputs = spec.outputs
    result_valid, result, result_last = flag(), fixed(SIGNAL), flag()
    complete = flag()
    count = unsigned(outputs.bit_length())
    words = [fixed(SIGNAL) for _ in spec.results]

    @always_comb
    def show():
        out_valid.next = result_valid
        out_data.next = result
        out_last.next = result_last

    @always_seq(clk.posedge, reset=rst)
    def finish():
        complete.next = result_valid and result_last

    return (
        hardware(spec.network)(
            clk,
            rst,
            in_valid,
            in_data,
            in_last,
            result_valid,
            result,
            result_last,
            frame_error,
            spec=spec.network,
        ),
        show,
        position(clk, rst, result_valid, result_last, count, stop=outputs),
        [
            catch_word(clk, result_valid, count, result, words[i], slot=slot)
            for i, slot in enumerate(spec.results)
        ],
        finish,
        load_profile(
            clk,
            rst,
            complete,
            *words,
            profile_valid,
            profile_x,
            profile_y,
            profile_last,
            spec=spec.load_profile,
        ),
    )


instrument.latency = lambda spec: latency(spec.network)
instrument.ports = lambda spec: (
    *stream_ports(spec.network),
    flag(),
    fixed(SIGNAL),
    fixed(SIGNAL),
    flag(),
)
