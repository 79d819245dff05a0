"""How the Verilog test bench sends and reads a frame: ``styles`` says the same in VHDL."""

from collections.abc import Callable
from dataclasses import dataclass
from string import Template

from golden.networks.network import Network
from tactus.export.handover.styles import (
    SpiText,
    converter_send,
    parallel_check,
    parallel_send,
    spi_send,
    stream_send,
)


@dataclass(frozen=True)
class VerilogStyle:
    """Verilog that fills the gaps in the text of the test bench.

    variables, begin: Declarations of the module, and their first values.
    check, send: For a design: what is checked in each clock, and how a frame is sent.
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


def _stream_check(taken: str, data: str, last: str) -> str:
    return _STREAM_CHECK.substitute(taken=taken, data=data, last=last)


def _scan_check(design: Network) -> str:
    # The sequencer goes on after the last frame, so outputs beyond that frame are not checked.
    return _stream_check("out_valid === 1'b1 && received < due", "out_data", "out_last")


# The styles, by the ``stream`` of the network.
VERILOG_STYLES = {
    "serial": VerilogStyle(
        _STREAM_VARIABLES,
        _STREAM_BEGIN,
        lambda design: _stream_check("out_valid === 1'b1", "out_data", "out_last"),
        stream_send(_STREAM_SEND),
    ),
    "words": VerilogStyle(
        "    integer level;\n",
        "",
        parallel_check(
            _PARALLEL_CHECK, Template("out_data_$n === results[received * outputs + $n]"), "&&"
        ),
        parallel_send(
            _PARALLEL_SEND,
            Template("            in_data_$n = samples[frame * inputs + $n];"),
            Template("            in_data_$n = ~in_data_$n;"),
        ),
    ),
    "axi_stream": VerilogStyle(
        _AXIS_VARIABLES,
        f"{_STREAM_BEGIN}        ticks = 0;\n        taking = 0;\n",
        lambda design: (
            _AXIS_CHECK
            + _stream_check("taking && m_axis_tvalid === 1'b1", "m_axis_tdata", "m_axis_tlast")
        ),
        lambda design: _AXIS_SEND,
    ),
    "converter": VerilogStyle(
        _STREAM_VARIABLES, _STREAM_BEGIN, _scan_check, converter_send(_CONVERTER_SEND)
    ),
    "spi": VerilogStyle(
        _SPI_VARIABLES,
        _SPI_BEGIN,
        _scan_check,
        spi_send(
            SpiText(
                _SPI_SEND,
                Template("                            $asked: channel = $channel;"),
                _AGAIN,
                _TURNED,
                "edges == {}",
                " || ",
                "0",
            )
        ),
    ),
}
