"""How the Verilog test bench sends and reads a frame: ``styles`` says the same in VHDL."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from string import Template

from golden.instruments.converter_instrument import ConverterInstrument
from golden.networks.network import Network
from golden.sensing.converter_parts import TWOS


@dataclass(frozen=True)
class VerilogStyle:
    """Verilog that fills the gaps in the text of the test bench.

    Attributes
    ----------
    variables, begin : str
        Declarations of the module, and their first values.
    check, send : callable
        For a design: what is checked in each clock, and how a frame is sent.
    """

    variables: str
    begin: str
    check: Callable[[Network], str]
    send: Callable[[Network], str]


_STREAM_VARIABLES = """\
    // Outputs of the frame that is coming out, and how many of them are right.
    integer place, correct;
    integer level;
"""
_STREAM_BEGIN = """\
        place = 0;
        correct = 0;
"""

_STREAM_CHECK = Template("""\
            if ($taken) begin
                if (received < due && place < outputs)
                    if ($data === results[received * outputs + place]) correct = correct + 1;
                place = place + 1;
                if ($last === 1'b1) begin
                    if (place == outputs && correct == outputs) matched = matched + 1;
                    else $$display("frame %0d differs", received);
                    received = received + 1;
                    place = 0;
                    correct = 0;
                end
            end""")

# Between valid elements the data is another code, which must not matter. The same holds for what
# stands in the slots of a cascade.
_STREAM_SEND = Template("""\
            for (element = 0; element <= $last; element = element + 1) begin
                pause = element == 0 ? $spacing : 0;
                if (gaps) pause = pause + (3 * frame + 5 * element) % 4;
                idle(pause);
                if (element < inputs) in_data = samples[frame * inputs + element];
                in_last = element == $last;
                in_valid = 1;
                tick;
                in_valid = 0;
                in_last = 0;
                in_data = ~in_data;
            end""")

_AXIS_VARIABLES = f"""\
{_STREAM_VARIABLES}\
    // With gaps, outputs are taken in one clock of three.
    integer ticks;
    reg taking;
"""

# Ready is set for the next rising edge. No output of the network changes before that edge.
_AXIS_CHECK = """\
            ticks = ticks + 1;
            taking = !gaps || ticks % 3 == 0;
            m_axis_tready = taking;
"""

# A network that never takes a sample must not hang the test bench.
_AXIS_SEND = """\
            for (element = 0; element < inputs; element = element + 1) begin
                if (gaps) idle((3 * frame + 5 * element) % 4);
                s_axis_tdata = samples[frame * inputs + element];
                s_axis_tlast = element == inputs - 1;
                s_axis_tvalid = 1;
                waiting = 0;
                while (waiting < 3 * settle && s_axis_tready !== 1'b1) begin
                    tick;
                    waiting = waiting + 1;
                end
                tick;
                s_axis_tvalid = 0;
                s_axis_tlast = 0;
                s_axis_tdata = ~s_axis_tdata;
            end"""

_PARALLEL_CHECK = Template("""\
            if (out_valid === 1'b1) begin
                if (received < due) begin
                    if ($equal) matched = matched + 1;
                    else $$display("frame %0d differs", received);
                end
                received = received + 1;
            end""")

_PARALLEL_SEND = Template("""\
            pause = $spacing;
            if (gaps) pause = pause + (3 * frame) % 4;
            idle(pause);
$data
            in_valid = 1;
            tick;
            in_valid = 0;
$other""")

# The converter gives the code of the sensor that the multiplexer has selected.
_CONVERTER_SEND = Template("""\
            for (element = 0; element <= $last; element = element + 1) begin
                adc = samples[frame * inputs + address];
                if (gaps && element % $slot != $sample) adc = ~samples[frame * inputs];
                tick;
            end""")

_SPI_VARIABLES = f"""\
{_STREAM_VARIABLES}\
    // A transfer: its clocks, what is asked for, the code that answers, and its bit.
    integer edges, asked, channel, code;
    reg next_bit, was;
"""
_SPI_BEGIN = f"""\
{_STREAM_BEGIN}\
        edges = 0;
        asked = 0;
        channel = 0;
        code = 0;
        next_bit = 1;
        was = 0;
"""

# The converter takes a bit when sclk rises and sends one when it falls.
_SPI_SEND = Template("""\
            for (element = 0; element <= $final; element = element + 1) begin
                if (cs_n === 1'b1) begin
                    edges = 0;
                    asked = 0;
                    miso = 1;
                end else if (sclk === 1'b1 && !was) begin
                    edges = edges + 1;
                    miso = next_bit;
                    if (edges <= $asking) asked = 2 * asked + (mosi === 1'b1);
                    if (edges == $asking) begin
                        case (asked)
$commands
                            default: begin
                                $$display("no such command");
                                complete = 0;
                            end
                        endcase
                        code = (samples[frame * inputs + channel] + $middle) / $step * $times;
                        if (code > $most) code = $most;
$turned                    end
                end else if (sclk === 1'b0 && was) begin
                    next_bit = !(edges >= $before);
                    if (edges >= $before && edges < $last) next_bit = code >> ($last - 1 - edges);
$again                    if ($zero) next_bit = 0;
                    miso = gaps ? !next_bit : next_bit;
                end
                was = sclk === 1'b1;
                tick;
            end""")

_AGAIN = Template("""\
                    if (edges >= $last && ((code >> (edges + 1 - $last)) & 1)) next_bit = 1;
""")

_TURNED = Template("""\
                        code = (code + $half) % $span;
""")


def _spi_send(design: Network) -> str:
    assert isinstance(design, ConverterInstrument)
    reader = design.converter_reader
    part, middle = reader.part, 1 << (reader.fmt.width - 1)
    step, times = 1 << max(0, -reader.shift), 1 << max(0, reader.shift)
    return _SPI_SEND.substitute(
        final=reader.scan_clocks - 1,
        asking=len(part.commands[0]),
        commands="\n".join(
            f"                            {int(part.commands[n], 2)}: channel = {n};"
            for n in range(reader.inputs)
        ),
        middle=middle + step // 2,
        step=step,
        times=times,
        most=(1 << part.bits) - 1,
        turned=_TURNED.substitute(half=1 << (part.bits - 1), span=1 << part.bits)
        if part.coding == TWOS
        else "",
        before=part.first - 1,
        last=part.last,
        again=_AGAIN.substitute(last=part.last) if part.mirrored else "",
        zero=" || ".join(f"edges == {clock - 1}" for clock in part.zeros) or "0",
    )


def _converter_send(design: Network) -> str:
    scan = design.scanner
    assert scan is not None
    return _CONVERTER_SEND.substitute(
        last=scan.scan_clocks - 1, slot=scan.slot_clocks, sample=scan.sample_clock
    )


def _stream_send(design: Network) -> str:
    elements = design.input_controller.inputs
    return _STREAM_SEND.substitute(last=elements - 1, spacing=design.interval - elements)


def _parallel_check(design: Network) -> str:
    equal = (f"out_data_{i} === results[received * outputs + {i}]" for i in range(design.outputs))
    return _PARALLEL_CHECK.substitute(equal=("\n" + 24 * " " + "&& ").join(equal))


def _parallel_send(design: Network) -> str:
    ports = [f"in_data_{k}" for k in range(design.inputs)]
    return _PARALLEL_SEND.substitute(
        spacing=design.interval - 1,
        data="\n".join(
            f"            {port} = samples[frame * inputs + {k}];" for k, port in enumerate(ports)
        ),
        other="\n".join(f"            {port} = ~{port};" for port in ports),
    )


def _stream_check(taken: str, data: str, last: str) -> str:
    return _STREAM_CHECK.substitute(taken=taken, data=data, last=last)


def _scan_check(design: Network) -> str:
    # The sequencer goes on after the last frame, so outputs beyond that frame are not checked.
    return _stream_check("out_valid === 1'b1 && received < due", "out_data", "out_last")


_CONVERTER = VerilogStyle(_STREAM_VARIABLES, _STREAM_BEGIN, _scan_check, _converter_send)

# The styles, by the ``stream`` of the network.
VERILOG_STYLES = {
    "serial": VerilogStyle(
        _STREAM_VARIABLES,
        _STREAM_BEGIN,
        lambda design: _stream_check("out_valid === 1'b1", "out_data", "out_last"),
        _stream_send,
    ),
    "words": VerilogStyle("    integer level;\n", "", _parallel_check, _parallel_send),
    "axi_stream": VerilogStyle(
        _AXIS_VARIABLES,
        f"{_STREAM_BEGIN}        ticks = 0;\n        taking = 0;\n",
        lambda design: (
            _AXIS_CHECK
            + _stream_check("taking && m_axis_tvalid === 1'b1", "m_axis_tdata", "m_axis_tlast")
        ),
        lambda design: _AXIS_SEND,
    ),
    "converter": _CONVERTER,
    "spi": VerilogStyle(_SPI_VARIABLES, _SPI_BEGIN, _scan_check, _spi_send),
}
