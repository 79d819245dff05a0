"""How a test bench sends and reads a frame, for each kind of stream that a network has."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from string import Template

from golden.instruments.converter_instrument import ConverterInstrument
from golden.networks.network import Network
from golden.sensing.converter_parts import TWOS


@dataclass(frozen=True)
class Style:
    """VHDL that fills the gaps in the text of the test bench.

    Attributes
    ----------
    variables : str
        The declarations of the process.
    passes : tuple of str
        All frames are sent twice; these two texts say how.
    check, send : callable
        For a design: what is checked in each clock, and how a frame is sent.
    """

    variables: str
    passes: tuple[str, str]
    check: Callable[[Network], str]
    send: Callable[[Network], str]


_STREAM_VARIABLES = """\
        -- Outputs of the frame that is coming out, and how many of them are right.
        variable place, correct: natural := 0;
"""

_STREAM_CHECK = Template("""\
            if $taken then
                if received < $due and place < outputs then
                    if $data = to_signed(results(received * outputs + place), $data'length)
                    then
                        correct := correct + 1;
                    end if;
                end if;
                place := place + 1;
                if $last = '1' then
                    if place = outputs and correct = outputs then
                        matched := matched + 1;
                    else
                        report "frame " & natural'image(received) & " differs" severity warning;
                    end if;
                    received := received + 1;
                    place := 0;
                    correct := 0;
                end if;
            end if;""")

# Between valid elements the data is another code, which must not matter. The same holds for what
# stands in the slots of a cascade.
_STREAM_SEND = Template("""\
            for element in 0 to $last loop
                if element = 0 then
                    pause := $spacing;
                else
                    pause := 0;
                end if;
                if gaps then
                    pause := pause + (3 * frame + 5 * element) mod 4;
                end if;
                idle(pause);
                if element < inputs then
                    in_data <= to_signed(samples(frame * inputs + element), in_data'length);
                end if;
                if element = $last then
                    in_last <= '1';
                end if;
                in_valid <= '1';
                tick;
                in_valid <= '0';
                in_last <= '0';
                in_data <= not in_data;
            end loop;""")

_AXIS_VARIABLES = f"""\
{_STREAM_VARIABLES}\
        -- With gaps, outputs are taken in one clock of three.
        variable ticks: natural := 0;
        variable slow, taking: boolean := false;
"""

# Ready is set for the next rising edge. No output of the network changes before that edge.
_AXIS_CHECK = """\
            ticks := ticks + 1;
            taking := not slow or ticks mod 3 = 0;
            if taking then
                m_axis_tready <= '1';
            else
                m_axis_tready <= '0';
            end if;
"""

# A network that never takes a sample must not hang the test bench.
_AXIS_SEND = """\
            slow := gaps;
            for element in 0 to inputs - 1 loop
                if gaps then
                    idle((3 * frame + 5 * element) mod 4);
                end if;
                s_axis_tdata <= to_signed(samples(frame * inputs + element), s_axis_tdata'length);
                if element = inputs - 1 then
                    s_axis_tlast <= '1';
                end if;
                s_axis_tvalid <= '1';
                for waiting in 1 to 3 * settle loop
                    exit when s_axis_tready = '1';
                    tick;
                end loop;
                tick;
                s_axis_tvalid <= '0';
                s_axis_tlast <= '0';
                s_axis_tdata <= not s_axis_tdata;
            end loop;"""

_PARALLEL_CHECK = Template("""\
            if out_valid = '1' then
                if received < frames then
                    if $equal then
                        matched := matched + 1;
                    else
                        report "frame " & natural'image(received) & " differs" severity warning;
                    end if;
                end if;
                received := received + 1;
            end if;""")

_PARALLEL_SEND = Template("""\
            pause := $spacing;
            if gaps then
                pause := pause + (3 * frame) mod 4;
            end if;
            idle(pause);
$data
            in_valid <= '1';
            tick;
            in_valid <= '0';
$other""")


# The converter gives the code of the sensor that the multiplexer has selected.
_CONVERTER_SEND = Template("""\
            for moment in 0 to $last loop
                adc <= to_signed(samples(frame * inputs + to_integer(address)), adc'length);
                if gaps and moment mod $slot /= $sample then
                    adc <= not to_signed(samples(frame * inputs), adc'length);
                end if;
                tick;
            end loop;""")


_SPI_VARIABLES = f"""\
{_STREAM_VARIABLES}\
        -- A transfer: its clocks, what is asked for, the code that answers, and its bit.
        variable edges, asked, channel, code: natural := 0;
        variable next_bit: std_logic := '1';
        variable was: std_logic := '0';
"""

# The converter takes a bit when sclk rises and sends one when it falls.
_SPI_SEND = Template("""\
            for moment in 0 to $final loop
                if cs_n = '1' then
                    edges := 0;
                    asked := 0;
                    miso <= '1';
                elsif sclk = '1' and was = '0' then
                    edges := edges + 1;
                    miso <= next_bit;
                    if edges <= $asking then
                        asked := 2 * asked;
                        if mosi = '1' then
                            asked := asked + 1;
                        end if;
                    end if;
                    if edges = $asking then
                        case asked is
$commands
                            when others => report "no such command" severity failure;
                        end case;
                        code := (samples(frame * inputs + channel) + $middle) / $step * $times;
                        if code > $most then
                            code := $most;
                        end if;
$turned                    end if;
                elsif sclk = '0' and was = '1' then
                    next_bit := '1';
                    if edges >= $before then
                        next_bit := '0';
                    end if;
                    if edges >= $before and edges < $last then
                        if (code / 2 ** ($last - 1 - edges)) mod 2 = 1 then
                            next_bit := '1';
                        end if;
                    end if;
$again                    if $zero then
                        next_bit := '0';
                    end if;
                    miso <= next_bit;
                    if gaps then
                        miso <= not next_bit;
                    end if;
                end if;
                was := sclk;
                tick;
            end loop;""")

_AGAIN = Template("""\
                    if edges >= $last then
                        if (code / 2 ** (edges + 1 - $last)) mod 2 = 1 then
                            next_bit := '1';
                        end if;
                    end if;
""")

_TURNED = Template("""\
                        code := (code + $half) mod $span;
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
            f"                            when {int(part.commands[n], 2)} => channel := {n};"
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
        zero=" or ".join(f"edges = {clock - 1}" for clock in part.zeros),
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
    equal = (
        f"out_data_{i} = to_signed(results(received * outputs + {i}), out_data_{i}'length)"
        for i in range(design.outputs)
    )
    return _PARALLEL_CHECK.substitute(equal=("\n" + 24 * " " + "and ").join(equal))


def _parallel_send(design: Network) -> str:
    ports = [f"in_data_{k}" for k in range(design.inputs)]
    return _PARALLEL_SEND.substitute(
        spacing=design.interval - 1,
        data="\n".join(
            f"            {port} <= to_signed(samples(frame * inputs + {k}), {port}'length);"
            for k, port in enumerate(ports)
        ),
        other="\n".join(f"            {port} <= not {port};" for port in ports),
    )


def due(design: Network) -> str:
    """How many frames of outputs come, as VHDL."""
    return "(frames - past)" if design.past else "frames"


def _stream_check(design: Network, taken: str, data: str, last: str) -> str:
    return _STREAM_CHECK.substitute(taken=taken, data=data, last=last, due=due(design))


GAPS = ("as close as the design takes them", "with gaps")
STREAM = Style(
    _STREAM_VARIABLES,
    GAPS,
    lambda design: _stream_check(design, "out_valid = '1'", "out_data", "out_last"),
    _stream_send,
)
AXIS = Style(
    _AXIS_VARIABLES,
    GAPS,
    lambda design: (
        _AXIS_CHECK
        + _stream_check(design, "taking and m_axis_tvalid = '1'", "m_axis_tdata", "m_axis_tlast")
    ),
    lambda design: _AXIS_SEND,
)
PARALLEL = Style("", GAPS, _parallel_check, _parallel_send)
# The sequencer goes on after the last frame, so outputs beyond that frame are not checked.
CONVERTER = Style(
    _STREAM_VARIABLES,
    (
        "with a settled converter",
        "with codes that are right in the clock that takes them alone",
    ),
    lambda design: _stream_check(
        design, f"out_valid = '1' and received < {due(design)}", "out_data", "out_last"
    ),
    _converter_send,
)
SPI = Style(
    _SPI_VARIABLES,
    ("with bits that come when sclk falls", "with bits that come as late as it rises"),
    CONVERTER.check,
    _spi_send,
)


# The styles, by the ``stream`` of the network.
STYLES = {
    "serial": STREAM,
    "words": PARALLEL,
    "axi_stream": AXIS,
    "converter": CONVERTER,
    "spi": SPI,
}
