"""VHDL computes the same as Verilog: this is recorded for every block, and the proof can fail."""

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import tiered
from shared import Shared

from golden.input_error import InputError
from tactus.verify.benches.runner import run_job
from tactus.verify.sign_off import equal, record
from tactus.verify.sign_off.equal import Pair, check_record, netlist_of, settle
from tactus.verify.sign_off.equal_gates import synthesise
from tactus.verify.sign_off.equal_netlist import list_lengths, to_verilog
from tactus.verify.sign_off.equal_proof import compare

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")

# These are compared in every run. make prove compares all blocks.
QUICK = ("output_controller",)
# The benches of these blocks run on their VHDL netlists: in every run one with a table and
# registers, and with ALL=1 one of each area, with arithmetic, memories and streams. The others
# follow from records that test_records.py compares: their netlists equal the Verilog, which
# passes the bench.
PLAYED = ("comparator_bank",)
OF_EACH_AREA = (
    *("pade", "lane_memory", "readout", "argmax", "packet_sender", "engine", "frame_window"),
    "load_profile",
)


@pytest.fixture
def pair(shared: Shared) -> Callable[[str], Pair]:
    """A function from a block to its pair of exports, which are made once in a run."""

    def both(block: str) -> Pair:
        return Pair(shared.subject(block), shared.subject(block, "ghdl"))

    return both


@pytest.mark.parametrize("block", QUICK)
def test_equal(pair: Callable[[str], Pair], block: str) -> None:
    (result,) = settle([pair(block)])
    assert result.complaints == []
    facts = record.read_record(equal.KIND, block)
    assert {**facts, "yosys": ""} == {**record.short(result.facts()), "yosys": ""}


@pytest.mark.parametrize("block", tiered(PLAYED, OF_EACH_AREA))
def test_the_netlist_of_the_vhdl_passes_the_bench(
    pair: Callable[[str], Pair], tmp_path: Path, block: str
) -> None:
    """GHDL's netlist behaves as its simulator does, because the same bench passes."""
    both = pair(block)
    job = replace(both.verilog, build=tmp_path)
    shutil.copytree(both.verilog.hdl_folder, job.hdl_folder)
    for entity in both.entities:
        text = f"`timescale 1ns/10ps\n{to_verilog(*netlist_of(both, entity))}"
        (job.hdl_folder / f"{entity}.v").write_text(text)
    outcome = run_job(job)
    assert outcome.passed, outcome.complaint()


def test_a_record_of_another_source_is_stale(
    pair: Callable[[str], Pair], tmp_path: Path, monkeypatch
) -> None:
    both = pair("output_controller")
    facts = record.read_record(equal.KIND, "output_controller")
    monkeypatch.setattr(record, "RECORDS", tmp_path)
    (complaint,) = check_record(both)
    assert complaint.endswith(record.PROVE.format("output_controller"))
    record.write_record(equal.KIND, "output_controller", {**facts, "source": "another"})
    (complaint,) = check_record(both)
    assert "is of another source" in complaint
    assert complaint.endswith(record.PROVE.format("output_controller"))


# Small entities in both languages: ports, declarations and statements. x is signed, u is not.
VHDL = """library IEEE;
use IEEE.std_logic_1164.all;
use IEEE.numeric_std.all;
entity small is
    port (clk: in std_logic; x: in signed(7 downto 0); u: in unsigned(0 downto 0);
          write: in std_logic; y: out signed(7 downto 0));
end entity small;
architecture rtl of small is
    signal kept: signed(7 downto 0);
    type t_array_memory is array(0 to 5) of signed(7 downto 0);
    signal memory: t_array_memory;
    signal addr: unsigned(2 downto 0);
begin
    addr <= unsigned(x(2 downto 0));
    y <= kept;
    process (clk) is begin
        if rising_edge(clk) then
            {vhdl}
        end if;
    end process;
end architecture rtl;
"""
VERILOG = """module small (input clk, input signed [7:0] x, input [0:0] u, input write,
              output signed [7:0] y);
reg signed [7:0] kept;
reg signed [7:0] memory [0:5];
wire [2:0] addr = x[2:0];
assign y = kept;
always @(posedge clk) begin
    {verilog}
end
endmodule
"""
# VHDL, its meaning in Verilog, and the Verilog with a mistake. Most mistakes are those of GHDL.
MEANT = {
    "default of a choice": (
        "case to_integer(addr) is when 0 => kept <= x; when others => kept <= -x; end case;",
        "case (addr) 0: kept <= x; default: kept <= -x; endcase",
        "case (addr) 0: kept <= x; endcase",
    ),
    "arithmetic shift": ("kept <= shift_right(x, 3);", "kept <= x >>> 3;", "kept <= x >> 3;"),
    "number wider than its wire": (
        "if u < 2 then kept <= x; end if;",
        "if (u < 2) kept <= x;",
        "if (u < 0) kept <= x;",
    ),
    "product with a sign": (
        "kept <= resize(shift_right(x * x(3 downto 0), 4), 8);",
        "kept <= ({{4{x[7]}}, x} * {{8{x[3]}}, x[3:0]}) >> 4;",
        "kept <= ({{4{x[7]}}, x} * {8'b0, x[3:0]}) >> 4;",
    ),
    "read or write": (
        "if write = '1' then memory(to_integer(addr)) <= x;"
        " else kept <= memory(to_integer(addr)); end if;",
        "if (write) memory[addr] <= x; else kept <= memory[addr];",
        "if (write) begin memory[addr] <= x; kept <= memory[addr]; end",
    ),
}


def small(tmp_path: Path, vhdl: str) -> str:
    """GHDL's netlist of the small entity as Verilog."""
    text = VHDL.replace("{vhdl}", vhdl)
    (tmp_path / "small.vhd").write_text(text)
    module = synthesise([tmp_path / "small.vhd"], "small", tmp_path)["small"]
    return to_verilog(module, list_lengths(text))


@pytest.mark.parametrize("what", MEANT)
def test_meant_by_the_standard_and_not_as_ghdl_prints_it(tmp_path: Path, what: str) -> None:
    vhdl, right, wrong = MEANT[what]
    gate = small(tmp_path, vhdl)
    for text, same in ((right, True), (wrong, False)):
        gold = VERILOG.replace("{verilog}", text)
        assert (compare("small", gold, gate, []) == []) == same, text


def test_a_mistake_of_ghdl_that_is_not_mended_is_found(tmp_path: Path) -> None:
    """GHDL swaps number and signal, so no block may have such a subtraction."""
    gate = small(tmp_path, "kept <= 100 - x;")
    gold = VERILOG.replace("{verilog}", "kept <= 100 - x;")
    assert compare("small", gold, gate, []) == ["kept.d"]


def test_registers_of_one_language_alone_are_named(tmp_path: Path) -> None:
    gold = VERILOG.replace("{verilog}", "other <= x; kept <= other;")
    gold = gold.replace("assign y", "reg signed [7:0] other; assign y")
    (where,) = compare("small", gold, small(tmp_path, "kept <= x;"), [])
    assert where.startswith("a register of one side alone, gold/")


def test_vhdl_that_ghdl_refuses_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"^small: ghdl --synth: "):
        small(tmp_path, "kept <= x and;")


def test_a_latch_is_an_error(tmp_path: Path) -> None:
    gold = VERILOG.replace("assign y", "reg l; always @* if (write) l = u; assign y")
    with pytest.raises(InputError, match="dlatch"):
        compare("small", gold.replace("{verilog}", "kept <= l;"), small(tmp_path, "kept <= x;"), [])
