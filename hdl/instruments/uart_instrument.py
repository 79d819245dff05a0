"""UART instrument: a converter instrument with a serial line to a computer."""

from myhdl import always_comb, always_seq, block

from golden.instruments.uart_instrument import UartInstrument
from golden.numbers.precision import SIGNAL
from hdl.common import ops
from hdl.common.signals import Group, Stream, fixed, flag, unsigned
from hdl.common.stream import next_point
from hdl.instruments.readout import readout
from hdl.link.image_receiver import image_receiver
from hdl.link.lesson_receiver import lesson_receiver
from hdl.link.packet_sender import packet_sender
from hdl.link.uart_receiver import uart_receiver
from hdl.link.uart_transmitter import uart_transmitter
from hdl.sensing.converter_reader import converter_reader
from hdl.visualisation.pulse_density import pulse_density


@block
def show_profile(inner, profile):
    """``profile`` is ``inner``. It is made of output ports, which VHDL cannot read."""

    @always_comb
    def show():
        profile.valid.next = inner.valid
        profile.x.next = inner.x
        profile.y.next = inner.y
        profile.last.next = inner.last

    return show


@block
def show_winner(inner, winner):
    """``winner`` is ``inner``. It is made of output ports, which VHDL cannot read."""

    @always_comb
    def show():
        winner.valid.next = inner.valid
        winner.index.next = inner.index
        winner.margin.next = inner.margin

    return show


@block
def end_of_frame(results, ends):
    """``ends`` is high when the last output of a frame leaves."""
    return ops.both(results.valid, results.last, ends)


@block
def either(first, second, told):
    """``told`` is high when either is."""
    return ops.either(first, second, told)


@block
def slow_profile(clk, rst, profile, dac, *, design: UartInstrument):
    """One point of each profile as densities of ones; the next profile gives the next point."""
    points, density = design.readout.load_profile.ramp.points, design.pulse_density
    ended = flag()
    number, x, y = unsigned(max(1, (points - 1).bit_length())), fixed(SIGNAL), fixed(SIGNAL)

    @always_seq(clk.posedge, reset=rst)
    def end():
        ended.next = profile.last

    return (
        end,
        next_point(clk, rst, profile, shown=ended, number=number, x=x, y=y, points=points),
        pulse_density(clk, rst, x, dac.x, spec=density),
        pulse_density(clk, rst, y, dac.y, spec=density),
    )


@block
def uart_instrument(
    clk,
    rst,
    out: Stream,
    *,
    miso,
    sclk,
    cs_n,
    mosi,
    rx,
    tx,
    dac,
    converter_error,
    held,
    winner: Stream,
    profile,
    spec: UartInstrument,
):
    """Bits of a converter in, results out, and packets on a line.

    Latency from the last bit of a scan to the first output: that of converter_reader, a clock for
    each further element of a frame, and that of readout. A frame every scan, and none while
    ``converter_error`` is up. A bit of the line takes ``spec.divisor`` clocks. Reset starts a scan,
    clears every flag and counter, and forgets a loaded image.
    """
    valid, data, last, missing = flag(), fixed(SIGNAL), flag(), flag()
    samples = Stream(valid=valid, data=data, last=last)
    result_valid, result, result_last = flag(), fixed(SIGNAL), flag()
    results = Stream(valid=result_valid, data=result, last=result_last)
    broken, unsound, wrong = flag(), flag(), flag()
    byte_valid, byte_data, byte_ready = flag(), unsigned(8), flag()
    packets = Stream(valid=byte_valid, data=byte_data, ready=byte_ready)
    load, image, drawn, decided = Group(), Group(), Group(), Stream()
    wires = {"miso": miso, "sclk": sclk, "cs_n": cs_n, "mosi": mosi}
    # Without a reload no frame is refused.
    told, lessons = {}, {}
    parts = []

    if spec.readout.load_profile is not None:
        drawn = Stream(valid=flag(), x=fixed(SIGNAL), y=fixed(SIGNAL), last=flag())
        parts.append(show_profile(drawn, profile))
    if spec.readout.argmax is not None:
        index, margin = spec.readout.argmax.index_fmt, spec.readout.argmax.margin_fmt
        decided = Stream(valid=flag(), index=unsigned(index.width), margin=unsigned(margin.width))
        parts.append(show_winner(decided, winner))
    if spec.analogue:
        parts.append(slow_profile(clk, rst, drawn, dac, design=spec))
    if spec.hears:
        heard_valid, heard = flag(), unsigned(8)
        received = Stream(valid=heard_valid, data=heard)
    if spec.reload:
        load = Stream(valid=flag(), data=unsigned(8), last=flag(), ready=flag())
        image = Group(error=unsound)
        told = {"frame_error": broken, "image_error": unsound, "line_error": wrong}
        parts += [
            uart_receiver(clk, rst, received, rx=rx, line_error=wrong, spec=spec.uart_receiver),
            image_receiver(clk, rst, received, load, spec=spec.image_receiver),
        ]
    if spec.learns:
        target = Stream(
            valid=flag(), data=fixed(SIGNAL), last=flag(), theta=flag(), ready=flag(), error=flag()
        )
        theta = Stream(valid=flag(), data=fixed(SIGNAL))
        learn, refused, misread, lost, frame_end = (flag() for _ in range(5))
        lessons = {"target": target, "learn": learn, "learn_error": refused, "theta": theta}
        told = {
            "line_error": wrong,
            "lesson_error": lost,
            "learn_error": refused,
            "learning": learn,
            "theta": theta,
        }
        parts += [
            uart_receiver(clk, rst, received, rx=rx, line_error=wrong, spec=spec.uart_receiver),
            lesson_receiver(
                clk,
                rst,
                received,
                target,
                frame_end=frame_end,
                learn=learn,
                lesson_error=misread,
                spec=spec.lesson_receiver,
            ),
            end_of_frame(results, frame_end),
            either(misread, target.error, lost),
        ]

    @always_comb
    def show():
        converter_error.next = missing
        out.valid.next = result_valid
        out.data.next = result
        out.last.next = result_last

    return (
        converter_reader(
            clk, rst, samples, **wires, converter_error=missing, spec=spec.converter_reader
        ),
        readout(
            clk,
            rst,
            samples,
            results,
            frame_error=broken,
            held=held,
            winner=decided,
            profile=drawn,
            load=load,
            image=image,
            **lessons,
            spec=spec.readout,
        ),
        packet_sender(
            clk,
            rst,
            samples,
            results,
            packets,
            converter_error=missing,
            **told,
            winner=decided,
            profile=drawn,
            spec=spec.packet_sender,
        ),
        uart_transmitter(clk, rst, packets, tx=tx, spec=spec.uart_transmitter),
        show,
        parts,
    )
