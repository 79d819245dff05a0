"""Tests the exporter's rules for text, one by one."""

from collections.abc import Callable
from textwrap import dedent

import pytest

from golden.layers.output_controller import OutputController
from golden.numbers.fixed import Fix
from tactus.export import tidy
from tactus.export.hierarchy import describe


@pytest.mark.parametrize(
    ("rule", "before", "after"),
    [
        (
            tidy.name_architecture,
            "architecture MyHDL of a is\nend architecture MyHDL;",
            "architecture rtl of a is\nend architecture rtl;",
        ),
        (
            tidy.fold_numbers,
            "(signed(resize(count, 3)) = (4 - 1))",
            "(signed(resize(count, 3)) = 3)",
        ),
        (tidy.fold_numbers, "for i in 0 to 9-1 loop", "for i in 0 to 8 loop"),
        (tidy.fold_numbers, "a(11-1 downto (11 - 6))", "a(10 downto 5)"),
        (tidy.fold_numbers, "a <= b - 1", "a <= b - 1"),
        (tidy.fold_numbers, "a <= (2 - 5)", "a <= (2 - 5)"),
        (tidy.fold_numbers, "x(4 - 1)", "x(4 - 1)"),
        (tidy.drop_shifts_by_nothing, "a <= shift_right(b, 0);", "a <= b;"),
        (tidy.drop_shifts_by_nothing, "a <= shift_left(b, 0);", "a <= b;"),
        (tidy.drop_shifts_by_nothing, "a <= shift_right(b, 10);", "a <= shift_right(b, 10);"),
        (
            tidy.compare_flags,
            "signal a: std_logic;\nif bool(a) then\nelsif bool(a) then",
            "signal a: std_logic;\nif a = '1' then\nelsif a = '1' then",
        ),
        (
            tidy.compare_flags,
            "signal a: unsigned(3 downto 0);\nif bool(a) then",
            "signal a: unsigned(3 downto 0);\nif bool(a) then",
        ),
        (tidy.drop_parentheses, "a <= (b + c);", "a <= b + c;"),
        (tidy.drop_parentheses, "if (a = 1) then", "if a = 1 then"),
        (tidy.drop_parentheses, "elsif (a < (- 3)) then", "elsif a < -3 then"),
        (tidy.drop_parentheses, "a <= (b + c) - (d + e);", "a <= (b + c) - (d + e);"),
        (tidy.drop_parentheses, "a <= b - (- 3);", "a <= b - (- 3);"),
        (tidy.drop_parentheses, "a(i) <= a((i - 1));", "a(i) <= a(i - 1);"),
        (
            tidy.drop_empty_loops,
            "a(0) <= b;\nfor i in 1 to 0 loop\n    a(i) <= a(i - 1);\nend loop;\nc <= a(0);\n",
            "a(0) <= b;\nc <= a(0);\n",
        ),
        (
            tidy.drop_empty_loops,
            "for i in 1 to 2 loop\n    a(i) <= a(i - 1);\nend loop;\n",
            "for i in 1 to 2 loop\n    a(i) <= a(i - 1);\nend loop;\n",
        ),
        (
            tidy.fill_arrays,
            "type t_array_a is array(0 to 1) of bit;\n  a(0) <= '0';\n  a(1) <= '0';\n",
            "type t_array_a is array(0 to 1) of bit;\n  a <= (others => '0');\n",
        ),
        (
            tidy.fill_arrays,
            "type t_array_a is array(0 to 2) of bit;\n  a(0) <= '0';\n  a(1) <= '0';\n",
            "type t_array_a is array(0 to 2) of bit;\n  a(0) <= '0';\n  a(1) <= '0';\n",
        ),
        (
            tidy.fill_arrays,
            "type t_array_a is array(0 to 1) of bit;\n  a(0) <= b;\n  a(1) <= c;\n",
            "type t_array_a is array(0 to 1) of bit;\n  a(0) <= b;\n  a(1) <= c;\n",
        ),
        (tidy.fold_numbers, "for i in 1 to 4-1 loop", "for i in 1 to 3 loop"),
        (tidy.shorten_bit_strings, '8X"0a"', 'X"0a"'),
        (tidy.shorten_bit_strings, '9X"00a"', '"000001010"'),
        (tidy.close_ranges, "signed (3 downto 0)", "signed(3 downto 0)"),
        (tidy.drop_unused_packages, "use std.textio.all;\nentity a is", "entity a is"),
        (
            tidy.drop_unused_packages,
            "use std.textio.all;\nvariable L: line;",
            "use std.textio.all;\nvariable L: line;",
        ),
        (tidy.drop_unused_packages, "use work.pck_myhdl_011.all;\na <= b;", "a <= b;"),
        (
            tidy.drop_unused_packages,
            "use work.pck_myhdl_011.all;\na <= stdl(b = 1);",
            "use work.pck_myhdl_011.all;\na <= stdl(b = 1);",
        ),
        (
            tidy.indent_architecture,
            "architecture rtl of a is\nsignal b: bit;\nbegin\nb <= c;\nend architecture rtl;",
            "architecture rtl of a is\n    signal b: bit;\nbegin\n    b <= c;\n\n"
            "end architecture rtl;",
        ),
    ],
)
def test_rule(rule: Callable[[str], str], before: str, after: str) -> None:
    assert rule(before) == after


TABLE = {
    "vhdl": """\
rom0_read: process (addr) is
begin
    case to_integer(addr) is
        when 0 => word <= "0100";
        when 1 => word <= "1110";
        when 2 => word <= "1110";
        when others => word <= "1110";
    end case;
end process rom0_read;
""",
    "verilog": """\
always @(addr) begin: rom0_read
    case (addr)
        0: word = 4;
        1: word = (-2);
        2: word = (-2);
        default: word = (-2);
    endcase
end
""",
}


def test_a_vhdl_table_says_what_its_words_stand_for_and_ends_with_others() -> None:
    meanings = {"rom0_read": Fix(4, 3).texts([4, -2])}
    assert tidy.annotate_tables(TABLE["vhdl"], "vhdl", meanings) == dedent(
        """\
        rom0_read: process (addr) is
        begin
            case to_integer(addr) is
                when 0 => word <= "0100";  -- 0.5
                when others => word <= "1110";  -- -0.25
            end case;
        end process rom0_read;
        """
    )


def test_a_verilog_table_says_what_its_words_stand_for_and_keeps_its_rows() -> None:
    meanings = {"rom0_read": Fix(4, 3).texts([4, -2])}
    assert tidy.annotate_tables(TABLE["verilog"], "verilog", meanings) == dedent(
        """\
        always @(addr) begin: rom0_read
            case (addr)
                0: word = 4;  // 0.5
                1: word = (-2);  // -0.25
                2: word = (-2);  // -0.25
                default: word = (-2);  // -0.25
            endcase
        end
        """
    )


def test_a_table_of_one_word_that_is_read_with_a_clock_keeps_its_process() -> None:
    text = dedent(
        """\
        rom0_read: process (clk) is
        begin
            if rising_edge(clk) then
                case to_integer(addr) is
                    when 0 => word <= "1110";
                    when others => word <= "1110";
                end case;
            end if;
        end process rom0_read;
        """
    )
    assert tidy.annotate_tables(text, "vhdl", {"rom0_read": ["-0.25"]}) == dedent(
        """\
        rom0_read: process (clk) is
        begin
            if rising_edge(clk) then
                word <= "1110";  -- -0.25
            end if;
        end process rom0_read;
        """
    )


MEMORY = {
    "vhdl": """\
type t_array_memory is array(0 to 4) of unsigned(7 downto 0);
constant memory: t_array_memory := (
    X"0a",
    X"00",
    X"0b",
    X"00",
    X"00");
""",
    "verilog": """\
reg [7:0]  memory [0:5-1];
initial begin
    memory[0] <= 10;
    memory[1] <= 0;
    memory[2] <= 4'hb;
    memory[3] <= 0;
    memory[4] <= 0;
end
""",
}
NOTED = {
    "vhdl": """\
type t_array_memory is array(0 to 4) of unsigned(7 downto 0);
constant memory: t_array_memory := (
    X"0a",  -- ten
    X"00",  -- none
    X"0b",  -- eleven
    others => X"00");  -- not used
""",
    "verilog": """\
reg [7:0]  memory [0:5-1];
integer memory_n;
initial begin
    memory[0] <= 10;  // ten
    memory[1] <= 0;  // none
    memory[2] <= 4'hb;  // eleven
    for (memory_n = 3; memory_n < 5; memory_n = memory_n + 1) memory[memory_n] <= 0;  // not used
end
""",
}


@pytest.mark.parametrize("language", ["vhdl", "verilog"])
def test_a_memory_says_what_its_words_stand_for_and_ends_in_one_row(language: str) -> None:
    meanings = {"memory": ["ten", "none", "eleven", "not used"]}
    assert tidy.annotate_tables(MEMORY[language], language, meanings) == NOTED[language]


@pytest.mark.parametrize("language", ["vhdl", "verilog"])
def test_a_table_that_is_not_there_is_a_fault(language: str) -> None:
    with pytest.raises(ValueError, match="rom1_read: got 0 tables of this name, expected 1"):
        tidy.annotate_tables(TABLE[language], language, {"rom1_read": ["1"]})


def test_a_docstring_is_resolved() -> None:
    docstring = """Row address.

    Row ``spec.addr_width`` bits, of ``spec.outputs``; see ``in_valid``.
    """
    spec = OutputController(outputs=2)
    assert describe(docstring, spec) == dedent(
        """\
        Row address.

        Row 1 bit, of 2; see in_valid."""
    )
