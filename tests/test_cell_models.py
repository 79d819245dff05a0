"""The models of memories behave as the manuals say when they are read, written and reset."""

import subprocess
from pathlib import Path

import pytest

from tactus.synth.timing import routed_netlist
from tactus.verify.sign_off.cell_models import models_for

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


def played(folder: Path, family: str, bench: str) -> list[str]:
    """The output of a bench, with the models that it needs."""
    (folder / "text.v").write_text(models_for(family, bench) + bench)
    for command in (["iverilog", "-g2012", "-o", "text", "text.v"], ["vvp", "-n", "text"]):
        result = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return result.stdout.split()


@pytest.mark.parametrize("mode", ["READ_FIRST", "WRITE_FIRST", "NO_CHANGE"])
@pytest.mark.parametrize("memory", MEMORIES)
def test_a_block_ram(tmp_path: Path, memory: str, mode: str) -> None:
    """Tests the contents, a written word, a word that is read meanwhile, and the reset value."""
    family, text = MEMORIES[memory]
    meanwhile = "30001" if mode == "READ_FIRST" else "xxxxx"
    bench = BENCH.replace("{memory}", text.format(mode=mode))
    wanted = ["30001", "00002", "30001", "2abcd", meanwhile, "2abcd", "3ffff"]
    assert played(tmp_path, family, bench) == wanted


def test_what_is_not_modelled_stops_the_simulation(tmp_path: Path) -> None:
    _, text = MEMORIES["series-7 of 36 Kbit"]
    text = text.format(mode="READ_FIRST").replace('"TDP"', '"SDP"')
    bench = BENCH.replace("{memory}", text)
    assert "modelled" in played(tmp_path, "xc7", bench)


@pytest.mark.parametrize(
    ("family", "cell"), [("xc2v", "LUT4"), ("xc7", "CARRY4"), ("ecp5", "PFUMX")]
)
def test_only_what_a_netlist_names_comes_with_it(family: str, cell: str) -> None:
    text = models_for(family, f"{cell} one();")
    assert f"module {cell}" in text
    assert "specify" not in text
    assert text.count("endmodule") == 1


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
    [(6, 4, 'MODE("DPRAM")'), (9, 11, "DATA_WIDTH_B(32'd9)"), (18, 10, "DATA_WIDTH_B(32'd18)")],
    ids=["LUTs", "9", "18"],
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
    got = played(tmp_path, "ecp5", routed + bench)
    assert len(got) == 198
    assert got == played(tmp_path, "ecp5", memory + bench)
