"""A VHDL-93 test bench that needs nothing but a simulator."""

from string import Template

from golden.common.port import Port
from golden.instruments.uart_instrument import UartInstrument
from golden.networks.axis_network import TUSER_HALF
from golden.networks.network import Network
from tactus.export.handover.example import vhdl_map, vhdl_signals
from tactus.export.handover.styles import STYLES, connected, due, load_numbers, settle_clocks

_TEXT = Template("""\
-- Plays the recorded frames of scene $scene into $top, $first and again
-- $second, and compares every output.
-- Says how many frames match; ends with an assertion of severity failure where one does not. Inputs
-- change and outputs are read at the falling edge.

library ieee;
use ieee.std_logic_1164.all;
use ieee.numeric_std.all;

use work.${top}_vectors.all;

entity ${top}_tb is
end entity ${top}_tb;

architecture self_check of ${top}_tb is

    constant half_period: time := 5 ns;
    -- Clocks from the last element of a frame until all outputs have left, slowly, and some more.
    constant settle: positive := $settle;

$signals
    signal running: boolean := true;

begin

    dut: entity work.$top
        port map (
$map
        );

    clock: process
    begin
        while running loop
            clk <= '0';
            wait for half_period;
            clk <= '1';
            wait for half_period;
        end loop;
        wait;
    end process clock;

    play: process
        variable complete: boolean := true;
        -- Frames that came out, that match, and that were refused.
        variable received, matched, refused: natural := 0;
$variables
        -- One clock: looks at what stands on the outputs.
        procedure tick is
        begin
            wait until falling_edge(clk);
$refused$check
        end procedure tick;

        procedure idle(clocks: natural) is
        begin
            for count in 1 to clocks loop
                tick;
            end loop;
        end procedure idle;

        procedure tell(how: string) is
        begin
            idle(settle);
            report natural'image(matched) & " of " & natural'image($due) & " frames match, "
                & how severity note;
            complete := complete and matched = $due and received = $due and refused = 0;
            received := 0;
            matched := 0;
$judged        end procedure tell;

        procedure send_frame(frame: natural; gaps: boolean) is
            variable pause: natural := 0;
        begin
$send
        end procedure send_frame;

        procedure send_all(gaps: boolean) is
        begin
            rst <= '1';
$quiet            idle(2);
            rst <= '0';
$load            for frame in 0 to frames - 1 loop
                send_frame(frame, gaps);
            end loop;
        end procedure send_all;
    begin
        send_all(false);
        tell("$first");
        send_all(true);
        tell("$second");
        running <= false;
        assert complete
            report "$top does not give the recorded results" severity failure;
        wait;
    end process play;

end architecture self_check;
""")

# Hardware that never takes a byte must not hang the test bench.
_LOAD = """\
            for number in image'range loop
                load_data <= to_unsigned(image(number), load_data'length);
                if number = image'high then
                    load_last <= '1';
                end if;
                load_valid <= '1';
                for waiting in 1 to settle loop
                    exit when load_ready = '1';
                    tick;
                end loop;
                tick;
                load_valid <= '0';
                load_last <= '0';
                load_data <= not load_data;
            end loop;
"""

# The line carries the packet of the image.
_LOAD_LINE = Template("""\
            for number in image'range loop
                for level in 0 to $last loop
                    if level = 0 then
                        rx <= '0';
                    elsif level = $last or (image(number) / 2 ** (level - 1)) mod 2 = 1 then
                        rx <= '1';
                    else
                        rx <= '0';
                    end if;
                    idle($divisor);
                end loop;
            end loop;
            idle($rest);
""")

# The winner of a frame comes behind its last output, and before that of the next frame.
_DECIDED_VARIABLES = """\
        -- Frames whose largest output was told, and those for which index and margin are right.
        variable decided, right: natural := 0;
"""
_DECIDED = Template("""
            if $valid then
                if decided < $due then
                    if to_integer($index) = winners(2 * decided)
                        and to_integer($margin) = winners(2 * decided + 1)
                    then
                        right := right + 1;
                    else
                        report "the winner of frame " & natural'image(decided) & " differs"
                            severity warning;
                    end if;
                end if;
                decided := decided + 1;
            end if;""")
_JUDGED = Template("""\
            report natural'image(right) & " of " & natural'image($due) & " winners match, "
                & how severity note;
            complete := complete and right = $due and decided = $due;
            decided := 0;
            right := 0;
""")

_REFUSED = """\
            if frame_error = '1' then
                refused := refused + 1;
            end if;
"""


def test_bench(scene: str, design: Network, ports: list[Port]) -> str:
    """The text of the entity ``<top>_tb``."""
    style = STYLES[design.stream]
    used = connected(ports)
    left_open = tuple(port.name for port in ports if port not in used)
    return _TEXT.substitute(
        scene=scene,
        top=design.entity,
        settle=settle_clocks(design),
        signals=vhdl_signals(used),
        map=vhdl_map(ports, left_open),
        variables=style.variables + (_DECIDED_VARIABLES if design.argmax else ""),
        refused=_REFUSED if "frame_error" in {port.name for port in ports} else "",
        check=style.check(design) + _decided(design),
        judged=_JUDGED.substitute(due=due(design)) if design.argmax else "",
        first=style.passes[0],
        second=style.passes[1],
        send=style.send(design),
        due=due(design),
        quiet="            rx <= '1';\n" if "rx" in {port.name for port in ports} else "",
        load=_load(design),
    )


def _decided(design: Network) -> str:
    """The VHDL that checks the winner in each clock; empty where there is none."""
    if not design.argmax:
        return ""
    valid, index, margin = "winner_valid = '1'", "winner_index", "winner_margin"
    if design.stream == "axi_stream":
        valid = "taking and m_axis_tvalid = '1' and m_axis_tlast = '1'"
        index = f"m_axis_tuser({TUSER_HALF - 1} downto 0)"
        margin = f"m_axis_tuser({2 * TUSER_HALF - 1} downto {TUSER_HALF})"
    elif design.stream in ("converter", "spi"):
        # An instrument goes on after the last frame.
        valid += f" and decided < {due(design)}"
    return _DECIDED.substitute(due=due(design), valid=valid, index=index, margin=margin)


def _load(design: Network) -> str:
    """The VHDL that sends the image; empty where there is none."""
    if not design.image:
        return ""
    if not isinstance(design, UartInstrument):
        return _LOAD
    return _LOAD_LINE.substitute(load_numbers(design))
