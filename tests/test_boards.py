"""Tests boards: their files, their clocks, what is around a design, and bitstreams."""

import hashlib
import json
import re
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from conftest import on_engine
from refused import Desk
from shared import Shared, printed

from golden.input_error import InputError
from tactus.boards import Board, bitstream, board_names, load_board
from tactus.boards.bitstream import (
    FAMILIES,
    NETLIST,
    Report,
    build,
    ice40_netlist,
    read_record,
    record_path,
    sources,
    state,
)
from tactus.boards.board import FOLDER
from tactus.boards.wrapper import RESET_WIDTH, Clock, clock_for, wrapper
from tactus.core.cli import BETWEEN
from tactus.core.store import VARIABLE
from tactus.export.exporter import export
from tactus.scene import Scene, load_scene
from tactus.synth import tools
from tactus.verify.benches.runner import run_job
from tactus.verify.sign_off.netlist import models_for, on_cells, played
from tb.common.cases import FRONT_END, random_mlp

# The scenes that are shipped for each board.
SHIPPED = [("digit-board", "ulx3s"), ("digit-board-small", "icebreaker")]
CONVERTER = f'{FRONT_END}converter = "mcp3208"\n'
LINE = "\n[uart]\n"


def scene_with(folder: Path, clock_mhz: float, sections: str = CONVERTER + LINE) -> Scene:
    """The smallest possible instrument, on an engine."""
    mlp, hardware = random_mlp((1, 1, 3), 1.0, 1), f"clock_mhz = {clock_mhz}"
    return load_scene(str(on_engine(folder, [mlp], sections=sections, hardware=hardware)))


@pytest.mark.parametrize("name", board_names())
def test_a_board_is_read_with_each_of_its_devices(tmp_path: Path, name: str) -> None:
    board = load_board(name)
    assert board.device == board.devices[0]
    for device in board.devices:
        assert load_board(name, device) == replace(board, device=device)
    path = tmp_path / "mine.toml"
    path.write_text((FOLDER / f"{name}.toml").read_text())
    assert load_board(str(path)) == replace(board, name="mine", path=path)


def pll_of(folder: Path, name: str, mhz: float, settings: Sequence[str]) -> tuple[Clock, list[int]]:
    """The clock that a board makes, and settings of its PLL as they stand in the wrapper."""
    scene, board = scene_with(folder, 25.0), load_board(name)
    clock = clock_for(board, mhz)
    text = wrapper(scene, scene.twin(), board, clock)
    found = [re.search(rf"\.{one}\((?:\d'd)?(\d+)\)", text) for one in settings]
    assert Fraction(str(mhz)) * Fraction(199, 200) <= clock.mhz <= Fraction(str(mhz))
    return clock, [int(one[1]) for one in found]


@pytest.mark.parametrize("mhz", [10, 12, 24, 25.175, 33.3333, 48, 62.5, 64, 100, 125])
def test_the_pll_of_an_ecp5(tmp_path: Path, mhz: float) -> None:
    """Checks the frequency by the formula of ecppll, and every limit."""
    names = ("CLKI_DIV", "CLKFB_DIV", "CLKOP_DIV", "CLKOS_DIV")
    clock, settings = pll_of(tmp_path, "ulx3s", mhz, names)
    divide_in, factor, closing, divide_out = settings
    compared = Fraction(25, divide_in)
    inside = compared * factor * closing
    assert clock.mhz == inside / divide_out
    assert compared >= Fraction(25, 8)
    assert 400 <= inside <= 800
    assert 10 <= inside / closing <= 400
    assert max(divide_in, closing, divide_out) <= 128
    assert factor <= 80


@pytest.mark.parametrize("mhz", [16.5, 18, 24, 30, 36, 48])
def test_the_pll_of_an_ice40(tmp_path: Path, mhz: float) -> None:
    """Checks the frequency by the formula of icepll, and every limit."""
    clock, settings = pll_of(tmp_path, "icebreaker", mhz, ("DIVR", "DIVF", "DIVQ"))
    divide_in, loop, halvings = settings
    inside = Fraction(12, divide_in + 1) * (loop + 1)
    assert clock.mhz == inside / 2**halvings
    assert 533 <= inside <= 1066
    assert 1 <= halvings <= 6


# A design with the same ports, whose line shows its reset, and a model of a PLL.
DESIGN = """
module {entity} ({ports});
  input clk, rst, miso;
  output sclk, cs_n, mosi, tx, {others};
  output converter_error;
  assign tx = rst, converter_error = miso;
endmodule
"""
BENCH = """
module pll_model #(parameter FEEDBACK_PATH = "", DIVR = 0, DIVF = 0, DIVQ = 0, FILTER_RANGE = 0)
  (input PACKAGEPIN, RESETB, BYPASS, output PLLOUTGLOBAL, output reg LOCK);
  assign PLLOUTGLOBAL = PACKAGEPIN;
  initial begin LOCK = 0; #100 LOCK = 1; end
endmodule
module bench;
  reg oscillator = 0, miso = 0;
  wire tx, converter_error;
  board board(.oscillator(oscillator), .miso(miso), .tx(tx), .converter_error(converter_error));
  always #1 oscillator = !oscillator;
  integer edges = 0;
  always @(posedge oscillator) if (tx !== 0) edges = edges + 1;
  initial begin
    #{most} $display("%0d %b%b", edges, tx, converter_error);
    miso = 1; #100 $display("%0d %b%b", edges, tx, converter_error);
    $finish;
  end
endmodule
"""


@pytest.mark.parametrize("mapped", [False, pytest.param(True, marks=pytest.mark.all_only)])
@pytest.mark.parametrize(
    ("name", "clock_mhz"), [("icebreaker", 12.0), ("icebreaker", 24.0), ("ulx3s", 25.0)]
)
def test_a_design_begins_in_reset(
    tmp_path: Path, name: str, clock_mhz: float, mapped: bool
) -> None:
    """The reset lasts 2**RESET_WIDTH clock edges after a PLL has locked. A lamp may be inverted.

    This holds for the Verilog and for the cells to which it is mapped.
    """
    scene, board = scene_with(tmp_path, clock_mhz), load_board(name)
    design = scene.twin()
    own = {"clk", "rst", "miso", "sclk", "cs_n", "mosi", "tx", "converter_error"}
    names = [port.name for port in design.ports]
    others = ", ".join(name for name in names if name not in own)
    text = wrapper(scene, design, board, clock_for(board, clock_mhz))
    text += DESIGN.format(entity=design.entity, ports=", ".join(names), others=others)
    if mapped:
        (tmp_path / "board.v").write_text(text)
        FAMILIES[board.family].synthesise(tmp_path)
        script = f"read_json {NETLIST}; write_verilog -noattr netlist.v"
        tools.run_tool("yosys", ["-q", "-p", script], tmp_path)
        text = (tmp_path / "netlist.v").read_text()
    text = text.replace("SB_PLL40_PAD", "pll_model")
    if mapped:
        text += models_for(board.family, text)
    found = printed(tmp_path, text + BENCH.format(most=2 * (1 << RESET_WIDTH) + 400))
    # The PLL locks after the 50th edge, and two registers delay this.
    edges = (1 << RESET_WIDTH) + (52 if clock_mhz != board.clock_mhz else 0)
    lamp = ["01", "00"] if board.pins["converter_error"].inverted else ["00", "01"]
    assert found == [str(edges), lamp[0], str(edges), lamp[1]]


def test_all_that_a_scene_lacks_for_a_board_is_told_at_once(tmp_path: Path) -> None:
    """Also the clock that no PLL can make."""
    scene = scene_with(tmp_path, 3.0, "")
    with pytest.raises(InputError) as refused:
        sources(scene, scene.twin(), load_board("ulx3s"))
    first, second, third = str(refused.value).split(BETWEEN)
    assert "front_end.converter: got none" in first
    assert "uart: got none" in second
    assert "hardware.clock_mhz: got 3, no PLL" in third


def test_the_pins_files_name_every_pin_that_is_used(tmp_path: Path) -> None:
    scene = scene_with(tmp_path, 25.0)
    lines = sources(scene, scene.twin(), load_board("ulx3s")).pins.splitlines()
    found = {tuple(line.split('"')[1::2]) for line in lines if line.startswith("LOCATE")}
    pins = {"oscillator": "G2", "wifi_gpio0": "L2", "tx": "L4", "miso": "A9", "mosi": "A10"}
    pins |= {"sclk": "B11", "cs_n": "B9", "converter_error": "B2"}
    assert found == set(pins.items())
    assert 'IOBUF PORT "miso" IO_TYPE=LVCMOS33 PULLMODE=UP;' in lines
    assert 'FREQUENCY PORT "oscillator" 25 MHZ;' in lines
    scene = scene_with(tmp_path, 12.0)
    lines = sources(scene, scene.twin(), load_board("icebreaker")).pins.splitlines()
    assert "set_io -pullup yes miso 47" in lines
    assert {"set_io tx 9", "set_frequency oscillator 12"} <= set(lines)


@pytest.mark.all_only
def test_the_command(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    """It makes a bitstream, takes it from the store later, and refuses a slow one."""
    scene_with(desk.folder, 12.0)
    assert desk.call("bitstream", "mine.toml", "icebreaker") == (0, "")
    folder = desk.folder / "build" / "mine" / "bitstream" / "icebreaker"
    packed = (folder / "mine.bin").read_bytes()
    facts = json.loads((folder / "bitstream.json").read_text())
    assert facts["sha256"] == hashlib.sha256(packed).hexdigest()
    # A bitstream of an iCE40 begins with these bytes, after its comment.
    assert bytes.fromhex("7eaa997e") in packed[:200]
    assert facts["report"]["clock_mhz"] > facts["report"]["needed_mhz"] == 12
    assert 0 < facts["report"]["used"]["block RAMs"] < facts["report"]["available"]["block RAMs"]

    def none(*_: object, **__: object) -> None:
        raise AssertionError("a tool was asked")

    monkeypatch.setattr(tools, "run_tool", none)
    monkeypatch.setattr(bitstream, "run_tool", none)
    assert desk.call("bitstream", "mine.toml", "icebreaker") == (0, "")
    assert (folder / "mine.bin").read_bytes() == packed

    slow = {"report": facts["report"] | {"clock_mhz": 11.5}, "bitstream": ""}
    monkeypatch.setattr(bitstream, "stored", lambda *_, **__: slow)
    says = "iCEBreaker, iCE40UP5K: 11.5 MHz reached, 12 MHz needed"
    desk.refuses("bitstream", "mine.toml", "icebreaker", says=says)


@pytest.mark.parametrize(("name", "board"), SHIPPED)
def test_the_record_is_of_this_design(shared: Shared, name: str, board: str) -> None:
    scene, target = load_scene(name), load_board(board)
    report, made_of = read_record(record_path(scene, target))
    made = sources(scene, scene.twin(), target)
    again = f"run: make bitstream RECORD=1 SCENE={name} BOARD={board}"
    assert state(shared.export(name, "verilog"), made) == made_of, again
    assert report.clock_mhz >= report.needed_mhz == made.clock_mhz
    assert all(report.used[kind] <= report.available[kind] for kind in report.used)


def built(scene: Scene, board: Board, folder: Path) -> tuple[bytes, Report]:
    verilog = folder / "verilog"
    export(scene, "verilog", verilog)
    return build(verilog, sources(scene, scene.twin(), board), board)


@pytest.mark.all_only
@pytest.mark.parametrize(("name", "board"), SHIPPED)
def test_the_same_bytes_twice(tmp_path: Path, monkeypatch, name: str, board: str) -> None:
    """The tools run twice, and the design takes the recorded resources."""
    scene, target = load_scene(name), load_board(board)
    found = []
    for run in ("one", "other"):
        monkeypatch.setenv(VARIABLE, str(tmp_path / run))
        found.append(built(scene, target, tmp_path))
    assert found[0] == found[1]
    assert found[0][1] == read_record(record_path(scene, target))[0]


@pytest.mark.all_only
@pytest.mark.parametrize(
    ("board", "mhz"),
    [
        *((load_board("ulx3s", device), 48.0) for device in load_board("ulx3s").devices),
        (load_board("icebreaker"), 24.0),
    ],
    ids=lambda one: getattr(one, "device", one),
)
def test_every_device_and_a_pll(tmp_path: Path, board: Board, mhz: float) -> None:
    _, report = built(scene_with(tmp_path, mhz), board, tmp_path)
    assert report.clock_mhz >= report.needed_mhz == mhz


# The product of 17 bits takes two multipliers, and its register is an operand of the next ones.
CHAIN = """
module chain (input clk, input [16:0] a, input [13:0] b, input signed [13:0] c,
              output reg signed [31:0] y);
  reg [16:0] a1; reg [13:0] b1; reg [30:0] product;
  wire [16:0] cut = product[29:13];
  wire signed [17:0] wide = {1'b0, cut};
  always @(posedge clk) begin
    a1 <= a; b1 <= b; product <= a1 * b1; y <= wide * c;
  end
endmodule
"""
COMPARED = """
module bench;
  reg clk = 0; reg [16:0] a; reg [13:0] b; reg signed [13:0] c; wire [31:0] one, two;
  chain one_of(clk, a, b, c, one);
  chain_cells two_of(.clk(clk), .a(a), .b(b), .c(c), .y(two));
  integer n, same = 0;
  initial for (n = 0; n < 300; n = n + 1) begin
    a = $random; b = $random; c = $random; #1 clk = 1; #1 clk = 0;
    if (n > 3 && one === two) same = same + 1;
    if (n == 299) $display("%0d", same);
  end
endmodule
"""


@pytest.mark.all_only
def test_a_register_between_two_multipliers(tmp_path: Path) -> None:
    """ice40_dsp of Yosys loses bits of such a register, so this pass is left out."""
    (tmp_path / "chain.v").write_text(CHAIN)
    netlist = ice40_netlist(tmp_path, "chain").replace("module chain(", "module chain_cells(")
    assert "SB_MAC16" in netlist
    text = models_for("ice40", netlist) + netlist + CHAIN + COMPARED
    assert printed(tmp_path, text) == ["296"]


@pytest.mark.all_only
def test_the_cells_of_an_instrument_do_what_the_twin_does(shared: Shared) -> None:
    """They load its image. On the cells of an ECP5 the instrument is recorded (test_records.py)."""
    outcome = run_job(
        on_cells(played(shared.subject("uart_instrument", case="reload-uart")), "ice40")
    )
    assert outcome.passed, outcome.complaint()
