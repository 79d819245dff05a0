"""How a test bench sends a frame and reads one, by the kind of the top's ports."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from string import Template

from golden.networks.network import Network
from hdl.ports import Port


@dataclass(frozen=True)
class Style:
    """VHDL for the gaps of the test bench's text.

    Attributes
    ----------
    variables : str
        Declarations of the process.
    check, send : callable
        What one clock looks at, and how a frame is sent, of a design.
    """

    variables: str
    check: Callable[[Network], str]
    send: Callable[[Network], str]


_STREAM_VARIABLES = """\
        -- Outputs of the frame that is coming out, and how many of them are right.
        variable place, correct: natural := 0;
"""

_STREAM_CHECK = """\
            if out_valid = '1' then
                if received < frames and place < outputs then
                    if out_data = to_signed(results(received * outputs + place), out_data'length)
                    then
                        correct := correct + 1;
                    end if;
                end if;
                place := place + 1;
                if out_last = '1' then
                    if place = outputs and correct = outputs then
                        matched := matched + 1;
                    else
                        report "frame " & natural'image(received) & " differs" severity warning;
                    end if;
                    received := received + 1;
                    place := 0;
                    correct := 0;
                end if;
            end if;"""

# Between valid elements the data is another code, which must not matter; so is what stands in the
# slots of a cascade.
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


STREAM = Style(_STREAM_VARIABLES, lambda design: _STREAM_CHECK, _stream_send)
PARALLEL = Style("", _parallel_check, _parallel_send)


def style_of(ports: list[Port]) -> Style:
    """The style of a top with these ports."""
    return STREAM if "in_last" in {port.name for port in ports} else PARALLEL
