"""Tests that benches on netlists and on unknown registers find faults, and their records."""

import re
from pathlib import Path

import pytest
from conftest import tiered
from shared import Shared, copied_job, printed

from tactus.synth.cells import SYNTHESISE, XILINX
from tactus.synth.timing import routed_netlist
from tactus.synth.tools import run_tool
from tactus.verify.benches.runner import Job, run_job
from tactus.verify.sign_off.cell_models import models_for
from tactus.verify.sign_off.netlist import on_cells
from tactus.verify.sign_off.netlist_record import played
from tactus.verify.sign_off.record import read_record
from tactus.verify.sign_off.unknown import UNKNOWN, Netlist, clocks_to_prove

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")

# A memory that becomes a block RAM, and a block that nextpnr places in a few seconds.
SMALL, SMALL_ROUTED = "bipartite_pair", "scan_sequencer"


# One block for each family. make sim NETLIST= runs all, and its records are compared with the
# exports.
@pytest.mark.parametrize(
    "case",
    tiered([(SMALL, "virtex-2")], [(SMALL, "series-7"), (SMALL_ROUTED, "ecp5")]),
    ids="-".join,
)
def test_a_netlist_does_what_the_twin_does(shared: Shared, case: tuple[str, str]) -> None:
    block, family = case
    job = on_cells(played(shared.subject(block)), family)
    assert f"make sim BLOCK={block} NETLIST={family} " in run_and_read(job)


def run_and_read(job: Job) -> str:
    """Run a bench, which must pass, and return its log."""
    outcome = run_job(job)
    assert outcome.passed, outcome.complaint()
    return outcome.log.read_text()


def turns_red(job: Job) -> bool:
    outcome = run_job(job)
    return not outcome.passed and bool(re.search(r" FAIL=[1-9]", outcome.log.read_text()))


@pytest.mark.parametrize(
    "fault",
    tiered(
        [("abs_unit", "virtex-2", r"(LUT\d #\(\s*\.INIT\(\d+'h)([0-9a-f]+)")],
        [
            (SMALL, "series-7", r"(\.INIT_00\(256'h[0-9a-f]*?)([0-9a-f])(?=\))"),
            (SMALL_ROUTED, "ecp5", r"(\.INITVAL\(16'h)([0-9a-f]+)"),
        ],
    ),
    ids=lambda fault: f"{fault[0]}-{fault[1]}",
)
def test_a_cell_that_is_wrong_turns_the_bench_red(
    shared: Shared, tmp_path: Path, fault: tuple[str, str, str]
) -> None:
    """All bits of the cell are inverted, since a single bit may be for impossible inputs."""
    block, family, pattern = fault
    job = copied_job(on_cells(shared.subject(block), family), tmp_path)
    file = job.hdl_folder / job.files[0]

    def flip(found: re.Match[str]) -> str:
        digits = len(found[2])
        return f"{found[1]}{int(found[2], 16) ^ ((1 << 4 * digits) - 1):0{digits}x}"

    text, count = re.subn(pattern, flip, file.read_text(), count=1)
    assert count
    file.write_text(text)
    assert turns_red(job)


def test_nothing_that_is_valid_hangs_on_an_unknown_register(shared: Shared) -> None:
    assert run_and_read(on_cells(played(shared.subject("abs_unit")), UNKNOWN))


def test_a_register_that_is_not_reset_is_found(shared: Shared, tmp_path: Path) -> None:
    """It is the recorded one. What is proved as recorded is not proved without its reset."""
    job = copied_job(played(shared.subject("abs_unit")), tmp_path)
    netlist, found = Netlist(job), read_record(UNKNOWN, "abs_unit")
    reset = {register.name: register for register in netlist.registers() if register.reset}
    control = reset[found["control"]]
    assert turns_red(netlist.bench(job, control))
    assert clocks_to_prove(netlist) == found["proved over clocks"]
    assert clocks_to_prove(netlist, control) is None


def test_an_unknown_condition_gives_what_both_branches_agree_on(
    shared: Shared, tmp_path: Path
) -> None:
    """The exported Verilog itself would take the else branch."""
    job = copied_job(shared.subject("abs_unit"), tmp_path)
    file = job.hdl_folder / job.files[0]
    file.write_text(
        """module abs_unit(input clk, input rst, input in, output reg same, output reg other);
  reg never;
  always @(posedge clk) begin
    never <= never;
    if (rst) same <= 0; else if (never) same <= in; else same <= in;
    if (rst) other <= 0; else if (never) other <= ~in; else other <= in;
  end
endmodule
"""
    )
    netlist = Netlist(job)
    assert {r.name: r.reset for r in netlist.registers()} == {
        "never": False,
        "same": True,
        "other": True,
    }
    bench = """module bench;
  reg clk = 0, rst = 1; wire same, other;
  abs_unit dut(clk, rst, 1'b1, same, other);
  always #1 clk = ~clk;
  initial begin
    #2 $display("%b%b", same, other); rst = 0; #2 $display("%b%b", same, other); $finish;
  end
endmodule
"""
    texts = {"plain": file.read_text(), "unknown": netlist.verilog()}
    assert {name: printed(tmp_path, text + bench) for name, text in texts.items()} == {
        "plain": ["00", "11"],
        "unknown": ["00", "1x"],
    }


def test_what_is_held_outlasts_a_reset_and_other_data_does_not(
    shared: Shared, tmp_path: Path
) -> None:
    job = copied_job(shared.subject("abs_unit"), tmp_path)
    file = job.hdl_folder / job.files[0]
    file.write_text(
        """module abs_unit(input clk, input rst, input in, output reg held_0, output reg other);
  always @(posedge clk) if (!rst) begin held_0 <= in; other <= in; end
endmodule
"""
    )
    bench = """module bench;
  reg clk = 0, rst = 1; wire held_0, other;
  abs_unit dut(clk, rst, 1'b1, held_0, other);
  always #1 clk = ~clk;
  always #2 $display("%b%b", held_0, other);
  initial begin #2 rst = 0; #2 rst = 1; #3 $finish; end
endmodule
"""
    assert printed(tmp_path, Netlist(job).verilog() + bench) == ["xx", "11", "1x"]


@pytest.mark.all_only
@pytest.mark.parametrize(
    ("weight", "taken"), [(-28794, "q"), (-28793, "q + b")], ids=["even", "sum"]
)
def test_a_register_in_a_multiplier_keeps_the_copies_of_its_sign(
    tmp_path: Path, weight: int, taken: str
) -> None:
    """Yosys' own script loses them in a multiplier of Series 7, as docs/verification.md says."""
    (tmp_path / "sum.v").write_text(
        f"""module sum(input clk, input signed [13:0] b, output reg signed [31:0] s);
  reg signed [31:0] q;
  always @(posedge clk) begin q <= b * {weight}; s <= {taken}; end
endmodule
"""
    )
    bench = """module bench;
  reg clk = 0; wire signed [31:0] s;
  sum dut(clk, 14'd8191, s);
  initial begin repeat (10) begin #1 clk = 1; #1 clk = 0; end $display("%0d", s); $finish; end
endmodule
"""
    right = {}
    for name, script in {"own": XILINX, "ours": SYNTHESISE["xc7"]}.items():
        mapped = script.format(family="xc7", top="sum")
        run = f"read_verilog sum.v; {mapped}; write_verilog -noattr n.cells"
        run_tool("yosys", ["-q", "-p", run], tmp_path)
        netlist = (tmp_path / "n.cells").read_text()
        got = printed(tmp_path, models_for("xc7", netlist) + netlist + bench)
        right[name] = got == [str(8191 * weight + 8191 * (taken != "q"))]
    assert right == {"own": False, "ours": True}


# One port writes and one reads words of 18 bits, 16 of which are data. Word 0 is 1 with both bits
# of parity set, and word 1 is 2 with none set.
VIRTEX = """RAMB16_S18_S18 #(.INIT_00(256'h00020001), .INITP_00(256'h3), .SRVAL_B(18'h3ffff),
    .WRITE_MODE_A("{mode}")) memory(.CLKA(clk), .CLKB(clk), .ENA(1'b1), .ENB(1'b1), .WEA(write),
    .WEB(1'b0), .SSRA(1'b0), .SSRB(clear), .ADDRA(at), .ADDRB(of), .DIA(data[15:0]),
    .DIPA(data[17:16]), .DIB(16'd0), .DIPB(2'd0), .DOB(word[15:0]), .DOPB(word[17:16]));"""
SERIES_7 = """RAMB{size}E1 #(.INIT_00(256'h00020001), .INITP_00(256'h3), .SRVAL_B(18'h3ffff),
    .WRITE_MODE_A("{mode}"), .WRITE_WIDTH_A(18), .READ_WIDTH_B(18), .RAM_MODE("TDP")) memory(
    .CLKARDCLK(clk), .CLKBWRCLK(clk), .ENARDEN(1'b1), .ENBWREN(1'b1), .WEA({lanes}),
    .WEBWE(8'd0), .RSTRAMARSTRAM(1'b0), .RSTRAMB(clear), .ADDRARDADDR({{2'b10, at, 4'd0}}),
    .ADDRBWRADDR({{2'b10, of, 4'd0}}), .DIADI({{16'd0, data[15:0]}}), .DIPADIP(data[17:16]),
    .DIBDI(0), .DIPBDIP(0), .DOBDO(wide), .DOPBDOP(parity)); wire [31:0] wide; wire [3:0] parity;
    assign word = {{parity[1:0], wide[15:0]}};"""
SERIES_7_OF = {
    size: SERIES_7.replace("{size}", size).replace("{lanes}", f"{{{{{lanes}{{{{write}}}}}}}}")
    for size, lanes in (("18", 2), ("36", 4))
}
MEMORIES = {
    "virtex-2": ("xc2v", VIRTEX),
    **{f"series-7 of {size} Kbit": ("xc7", text) for size, text in SERIES_7_OF.items()},
}
BENCH = """module bench;
  reg clk = 0, write = 0, clear = 0; reg [9:0] at = 0, of = 0; reg [17:0] data = 18'h2abcd;
  wire [17:0] word;
  {memory}
  always #1 clk = ~clk;
  task step(input w, input [9:0] a, input [9:0] f, input c); begin
    write = w; at = a; of = f; clear = c; #2 $display("%h", word);
  end endtask
  initial begin
    step(0, 0, 0, 0); step(0, 0, 1, 0); step(1, 1, 0, 0); step(0, 0, 1, 0); step(1, 0, 0, 0);
    step(0, 0, 0, 0); step(0, 0, 0, 1); $finish;
  end
endmodule
"""


def printed_with(folder: Path, family: str, bench: str) -> list[str]:
    """The output of a bench, with the models that it needs."""
    return printed(folder, models_for(family, bench) + bench)


@pytest.mark.parametrize("mode", ["READ_FIRST", "WRITE_FIRST", "NO_CHANGE"])
@pytest.mark.parametrize("memory", MEMORIES)
def test_a_block_ram(tmp_path: Path, memory: str, mode: str) -> None:
    """Tests the contents, a written word, a word that is read meanwhile, and the reset value."""
    family, text = MEMORIES[memory]
    meanwhile = "30001" if mode == "READ_FIRST" else "xxxxx"
    bench = BENCH.replace("{memory}", text.format(mode=mode))
    wanted = ["30001", "00002", "30001", "2abcd", meanwhile, "2abcd", "3ffff"]
    assert printed_with(tmp_path, family, bench) == wanted


def test_what_is_not_modelled_stops_the_simulation(tmp_path: Path) -> None:
    _, text = MEMORIES["series-7 of 36 Kbit"]
    text = text.format(mode="READ_FIRST").replace('"TDP"', '"SDP"')
    bench = BENCH.replace("{memory}", text)
    assert "modelled" in printed_with(tmp_path, "xc7", bench)


# A memory with registers around it, so that nextpnr can time it. Its contents have no symmetry.
MEMORY = """module memory(input clk, write, input [{top}:0] at, of, input [{high}:0] data,
    output reg [{high}:0] word);
  (* no_rw_check *) reg [{high}:0] words [0:{words}-1];
  reg [{top}:0] from;
  wire [{high}:0] found = words[from];
  integer i;
  initial for (i = 0; i < {words}; i = i + 1) words[i] = 5 * i + (i >> 2) + 3;
  always @(posedge clk) begin
    if (write) words[at] <= data;
    from <= of;
    word <= found;
  end
endmodule
"""
# A word is never read in the clock in which it is written.
SEEN = """module bench;
  reg clk = 0, write = 0; reg [{top}:0] at = 0, of = 0; reg [{high}:0] data = 0; integer n;
  wire [{high}:0] word;
  memory dut(.clk(clk), .write(write), .at(at), .of(of), .data(data), .word(word));
  initial begin
    for (n = 0; n < 200; n = n + 1) begin
      of = 7 * n - 21; at = 7 * n; data = 2011 * n + 1; write = n > 20 && n % 3 != 0;
      #1 clk = 1; #1 clk = 0; if (n > 1) $display("%h", word);
    end
    $finish;
  end
endmodule
"""


@pytest.mark.all_only
@pytest.mark.parametrize(
    ("width", "address", "cell"),
    [(6, 4, 'MODE("DPRAM")')]
    + [(n, 15 - n.bit_length(), f"DATA_WIDTH_B(32'd{n})") for n in (18, 36)],
    ids=["LUTs", "18", "36"],
)
def test_a_memory_of_an_ecp5_is_written_and_read_as_its_verilog(
    tmp_path: Path, width: int, address: int, cell: str
) -> None:
    """It also begins with the same words. With 6 bits, a memory of LUTs has two unused outputs."""
    sizes = {"high": width - 1, "top": address - 1, "words": 1 << address}
    memory, bench = MEMORY.format(**sizes), SEEN.format(**sizes)
    folder = tmp_path / "verilog"
    folder.mkdir()
    (folder / "memory.v").write_text(memory)
    routed = routed_netlist(folder, "memory")
    assert cell in routed
    got = printed_with(tmp_path, "ecp5", routed + bench)
    assert len(got) == 198
    assert got == printed_with(tmp_path, "ecp5", memory + bench)
