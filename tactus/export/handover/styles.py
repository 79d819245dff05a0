"""How a test bench sends and reads a frame, for each kind of stream that a network has."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from string import Template

from golden.common.port import Port
from golden.instruments.converter_instrument import ConverterInstrument
from golden.instruments.uart_instrument import UartInstrument
from golden.link.uart_transmitter import BYTE_BITS
from golden.networks.network import Network
from golden.sensing.converter_parts import TWOS


@dataclass(frozen=True)
class Style:
    """VHDL that fills the gaps in the text of the test bench.

    variables: The declarations of the process.
    passes: All frames are sent twice; these two texts say how.
    check, send: For a design: what is checked in each clock, and how a frame is sent.
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


@dataclass(frozen=True)
class SpiText:
    """The parts of a text that answers transfers, in one language.

    send, command, again, turned: ``command`` is what a command of the converter does. ``again`` is
        for a part that repeats its bits, and ``turned`` for one that gives numbers with a sign.
    clock, either, never: A condition on the number of a clock, what joins such conditions, and one
        that never holds.
    """

    send: Template
    command: Template
    again: Template
    turned: Template
    clock: str
    either: str
    never: str


def spi_send(text: SpiText) -> Callable[[Network], str]:
    """What answers the transfers of a design, in the language of the text."""

    def send(design: Network) -> str:
        assert isinstance(design, ConverterInstrument)
        reader = design.converter_reader
        part, middle = reader.part, 1 << (reader.fmt.width - 1)
        step, times = 1 << max(0, -reader.shift), 1 << max(0, reader.shift)
        turned = text.turned.substitute(half=1 << (part.bits - 1), span=1 << part.bits)
        return text.send.substitute(
            final=reader.scan_clocks - 1,
            asking=len(part.commands[0]),
            commands="\n".join(
                text.command.substitute(asked=int(part.commands[n], 2), channel=n)
                for n in range(reader.inputs)
            ),
            middle=middle + step // 2,
            step=step,
            times=times,
            most=(1 << part.bits) - 1,
            turned=turned if part.coding == TWOS else "",
            before=part.first - 1,
            last=part.last,
            again=text.again.substitute(last=part.last) if part.mirrored else "",
            zero=text.either.join(text.clock.format(clock - 1) for clock in part.zeros)
            or text.never,
        )

    return send


def converter_send(text: Template) -> Callable[[Network], str]:
    """What gives the codes of a converter, in the language of the text."""

    def send(design: Network) -> str:
        scan = design.scanner
        assert scan is not None
        return text.substitute(
            last=scan.scan_clocks - 1, slot=scan.slot_clocks, sample=scan.sample_clock
        )

    return send


def stream_send(text: Template) -> Callable[[Network], str]:
    """What sends the elements of a frame one after the other, in the language of the text."""

    def send(design: Network) -> str:
        elements = design.input_controller.inputs
        return text.substitute(last=elements - 1, spacing=design.interval - elements)

    return send


def parallel_check(text: Template, equal: Template, both: str) -> Callable[[Network], str]:
    """What compares all outputs of a frame at once; ``equal`` compares one, ``both`` joins two."""

    def check(design: Network) -> str:
        found = (equal.substitute(n=n) for n in range(design.outputs))
        return text.substitute(equal=f"\n{24 * ' '}{both} ".join(found))

    return check


def parallel_send(text: Template, data: Template, other: Template) -> Callable[[Network], str]:
    """What sends all samples of a frame at once.

    ``data`` sets one of them, and ``other`` makes it another code behind the frame.
    """

    def send(design: Network) -> str:
        data_lines, other_lines = (
            "\n".join(line.substitute(n=n) for n in range(design.inputs)) for line in (data, other)
        )
        return text.substitute(spacing=design.interval - 1, data=data_lines, other=other_lines)

    return send


def settle_clocks(design: Network) -> int:
    """Clocks from a frame's last element until all outputs have left slowly, and some more.

    Where frames overlap in a loop, one that comes late waits for the next turn of the loop.
    """
    clocks = design.output_clocks[-1]
    return clocks + design.interval + 3 * design.outputs * (clocks // design.interval + 2)


def connected(ports: Sequence[Port]) -> list[Port]:
    """The ports that a test bench connects.

    The held outputs are on the stream, too. Neither the profile nor a line is recorded.
    """
    return [p for p in ports if not p.name.startswith(("held_", "profile_", "dac_", "tx"))]


def load_numbers(design: UartInstrument) -> dict[str, int]:
    """What the packet of an image takes on a line: the last level of a byte, and clocks.

    Scans go on meanwhile, so that it takes a whole number of scans with the clocks ``rest``.
    """
    clocks = len(design.image) * BYTE_BITS * design.divisor
    return {
        "last": BYTE_BITS - 1,
        "divisor": design.divisor,
        "rest": -clocks % design.interval,
    }


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
    stream_send(_STREAM_SEND),
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
PARALLEL = Style(
    "",
    GAPS,
    parallel_check(
        _PARALLEL_CHECK,
        Template("out_data_$n = to_signed(results(received * outputs + $n), out_data_$n'length)"),
        "and",
    ),
    parallel_send(
        _PARALLEL_SEND,
        Template(
            "            in_data_$n <= to_signed(samples(frame * inputs + $n), in_data_$n'length);"
        ),
        Template("            in_data_$n <= not in_data_$n;"),
    ),
)
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
    converter_send(_CONVERTER_SEND),
)
SPI = Style(
    _SPI_VARIABLES,
    ("with bits that come when sclk falls", "with bits that come as late as it rises"),
    CONVERTER.check,
    spi_send(
        SpiText(
            _SPI_SEND,
            Template("                            when $asked => channel := $channel;"),
            _AGAIN,
            _TURNED,
            "edges = {}",
            " or ",
            "false",
        )
    ),
)


# The styles, by the ``stream`` of the network.
STYLES = {
    "serial": STREAM,
    "words": PARALLEL,
    "axi_stream": AXIS,
    "converter": CONVERTER,
    "spi": SPI,
}
