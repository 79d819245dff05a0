"""Tests boards: their files, their clocks, what is around a design, and bitstreams."""

import hashlib
import json
import re
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from conftest import on_engine
from refused import Desk
from shared import Shared, printed

from golden.input_error import InputError
from golden.instruments.uart_instrument import UartInstrument
from golden.link.packets import image_packet
from golden.numbers.fixed import Codes
from tactus.boards import Board, bitstream, board_names, load_board
from tactus.boards.bitstream import (
    Report,
    build,
    cells,
    ice40_netlist,
    read_record,
    record_path,
    sources,
    state,
)
from tactus.boards.board import FOLDER
from tactus.boards.wrapper import RESET_WIDTH, clock_for, wrapper
from tactus.core.cli import BETWEEN
from tactus.core.store import VARIABLE
from tactus.export.exporter import export
from tactus.scene import Scene, load_scene
from tactus.synth import tools
from tactus.verify.sign_off.cell_models import models_for
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


def number(text: str, name: str) -> int:
    found = re.search(rf"\.{name}\((?:\d'd)?(\d+)\)", text)
    assert found, name
    return int(found[1])


@pytest.mark.parametrize("mhz", [10, 12, 24, 25.175, 33.3333, 48, 62.5, 64, 100, 125])
def test_the_pll_of_an_ecp5(mhz: float) -> None:
    """Checks the frequency by the formula of ecppll, and every limit."""
    clock = clock_for(load_board("ulx3s"), mhz)
    names = ("CLKI_DIV", "CLKFB_DIV", "CLKOP_DIV", "CLKOS_DIV")
    divide_in, factor, closing, divide_out = (number(clock.text, name) for name in names)
    compared = Fraction(25, divide_in)
    inside = compared * factor * closing
    assert clock.mhz == inside / divide_out
    assert Fraction(str(mhz)) * Fraction(199, 200) <= clock.mhz <= Fraction(str(mhz))
    assert compared >= Fraction(25, 8)
    assert 400 <= inside <= 800
    assert 10 <= inside / closing <= 400
    assert max(divide_in, closing, divide_out) <= 128
    assert factor <= 80


@pytest.mark.parametrize("mhz", [16.5, 18, 24, 30, 36, 48])
def test_the_pll_of_an_ice40(mhz: float) -> None:
    """Checks the frequency by the formula of icepll, and every limit."""
    clock = clock_for(load_board("icebreaker"), mhz)
    assert "SB_PLL40_PAD" in clock.text
    divide_in, loop = number(clock.text, "DIVR") + 1, number(clock.text, "DIVF") + 1
    inside = Fraction(12, divide_in) * loop
    assert clock.mhz == inside / 2 ** number(clock.text, "DIVQ")
    assert Fraction(str(mhz)) * Fraction(199, 200) <= clock.mhz <= Fraction(str(mhz))
    assert 533 <= inside <= 1066
    assert 1 <= number(clock.text, "DIVQ") <= 6


# A design with the same ports that counts its clock edges in reset, and a model of a PLL.
STUBS = """
module SB_PLL40_PAD #(parameter FEEDBACK_PATH = "", DIVR = 0, DIVF = 0, DIVQ = 0, FILTER_RANGE = 0)
  (input PACKAGEPIN, RESETB, BYPASS, output PLLOUTGLOBAL, output reg LOCK);
  assign PLLOUTGLOBAL = PACKAGEPIN;
  initial begin LOCK = 0; #100 LOCK = 1; end
endmodule
module {entity} ({ports});
  input clk, rst, miso;
  output sclk, cs_n, mosi, tx, {others};
  output converter_error;
  assign tx = miso, converter_error = miso;
  integer edges = 0;
  always @(posedge clk) if (rst) edges = edges + 1;
endmodule
module bench;
  reg oscillator = 0, miso = 0;
  wire tx, converter_error;
  board board(.oscillator(oscillator), .miso(miso), .tx(tx), .converter_error(converter_error));
  always #1 oscillator = !oscillator;
  task show;
    $display("%0d %b%b%b", board.inner.edges, board.inner.rst, tx, converter_error);
  endtask
  initial begin
    #{most} show;
    miso = 1; #100 show;
    $finish;
  end
endmodule
"""


@pytest.mark.parametrize("clock_mhz", [12.0, 24.0])
def test_a_design_begins_in_reset(tmp_path: Path, clock_mhz: float) -> None:
    """The reset lasts 2**RESET_WIDTH clock edges after a PLL has locked. A lamp may be inverted."""
    scene, board = scene_with(tmp_path, clock_mhz), load_board("icebreaker")
    design = scene.twin()
    text = wrapper(scene, design, board, clock_for(board, clock_mhz))
    own = {"clk", "rst", "miso", "sclk", "cs_n", "mosi", "tx", "converter_error"}
    names = [port.name for port in design.ports]
    others = ", ".join(name for name in names if name not in own)
    most = 2 * (1 << RESET_WIDTH) + 400
    stubs = STUBS.format(entity=design.entity, ports=", ".join(names), others=others, most=most)
    edges, first, same, second = printed(tmp_path, text + stubs)
    # The PLL locks after the 50th edge, and two registers delay this.
    waited = 52 if clock_mhz != board.clock_mhz else 0
    assert int(edges) == int(same) == (1 << RESET_WIDTH) + waited
    assert (first, second) == ("001", "010")


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
def test_the_cells_of_a_board_do_what_its_verilog_does(tmp_path: Path) -> None:
    """From the wires of the converter, the cells send the bytes that the twin predicts."""
    board = load_board(SHIPPED[0][1])
    scene = scene_with(tmp_path, board.clock_mhz, f"{CONVERTER}counter_width = 11\n{LINE}")
    design = scene.twin()
    voltages = np.random.default_rng(1).integers(-8192, 8192, (24, 1))
    played = play(scene, board, voltages, tmp_path)
    assert played.differ == played.unknown == 0
    assert played.compared > 20 * design.interval
    expected = expected_of(design, voltages)
    found = frames_of(played.line, design)
    # The first packet is sent after a scan, and the last one may be incomplete.
    assert len(found) >= (len(voltages) - 2) // design.packet_scans >= 7
    assert all(expected[count - 1] == (s, outputs) for count, s, outputs in found)


@pytest.mark.all_only
def test_the_cells_of_a_shipped_instrument(tmp_path: Path) -> None:
    """After loading its image, the outputs are those of the twin and of the Verilog.

    The cells of the larger board take three times as long; its Verilog plays the recorded frames
    (test_benches.py), and its family's cells the smallest instrument.
    """
    name, board = SHIPPED[-1]
    scene = load_scene(name)
    design = scene.twin()
    voltages = scene.vectors().codes[:16]
    played = play(scene, load_board(board), voltages, tmp_path)
    assert played.differ == played.unknown == 0
    assert played.compared > 12 * design.interval
    expected = {tuple(s): outputs for s, outputs in expected_of(design, voltages)}
    assert len(expected) == len(voltages)
    found = frames_of(played.line, design)
    # No frame is computed before the image is loaded, and the last one may be incomplete.
    computed = [(s, outputs) for count, s, outputs in found if count]
    assert len(computed) >= (len(voltages) - 2) // design.packet_scans - 1 >= 5
    assert all(expected[tuple(s)] == outputs for s, outputs in computed)


@pytest.mark.all_only
def test_a_wrong_cell_of_a_board_is_seen(tmp_path: Path) -> None:
    scene = scene_with(tmp_path, 12.0, f"{CONVERTER}counter_width = 11\n{LINE}")
    voltages = np.random.default_rng(1).integers(-8192, 8192, (12, 1))

    def wrong(netlist: str) -> str:
        """Invert one line of one table."""
        names = re.findall(r"\.LUT_INIT\(16'h(\w{4})\)", netlist)
        return netlist.replace(f"16'h{names[0]}", f"16'h{int(names[0], 16) ^ 0xFFFF:04x}", 1)

    assert play(scene, load_board("icebreaker"), voltages, tmp_path, wrong).differ > 0


# This model answers as an MCP3208: bit n is on the wire at the n-th rise of sclk.
BENCH = """
module bench;
  reg oscillator = 0, miso = 1, rx = 1;
  wire [{top}:0] one, two;
  {instances}
  always #1 oscillator = !oscillator;
  reg [11:0] codes [0:{codes}]; initial $readmemh("codes.hex", codes);
  reg [7:0] image [0:{image}]; initial $readmemh("image.hex", image);
  integer fallen = 0, risen = 0, transfer = -1, begun, at, byte_at, bit_at;
  reg [4:0] order; reg [11:0] code;
  always @(negedge one[1]) begin fallen = 0; risen = 0; transfer = transfer + 1; end
  always @(posedge one[1]) miso = 1;
  always @(posedge one[0]) if (!one[1]) begin
    risen = risen + 1;
    if (risen <= 5) order = {{order[3:0], one[2]}};
    if (risen == 5 && order[2:0] != transfer % {inputs}) $display("order %b", order);
  end
  always @(negedge one[0]) if (!one[1]) begin
    fallen = fallen + 1; at = fallen + 1; code = codes[transfer % {all}];
    if (at < 7) miso = 1; else if (at == 7) miso = 0;
    else if (at <= 19) miso = code[19 - at]; else miso = code[at - 19];
  end
  integer compared = 0, differ = 0, unknown = 0;
  // Before the first command mosi is not known.
  always @(negedge oscillator) if (transfer >= 0) begin
    compared = compared + 1;
    if (one !== two) differ = differ + 1;
    if (^one === 1'bx) unknown = unknown + 1;
  end
  integer got; reg [7:0] heard;
  always @(negedge two[3]) if ($time > {begin} && got < 0) begin
    got = 0;
    #({divisor}) for (got = 0; got < 8; got = got + 1) begin #({bit}) heard[got] = two[3]; end
    #({bit}) if (two[3]) $display("byte %h", heard); else $display("stop");
    got = -1;
  end
  initial begin
    got = -1;
    #{begin} for (byte_at = 0; byte_at < {bytes}; byte_at = byte_at + 1) begin
      rx = 0; #{bit};
      for (bit_at = 0; bit_at < 8; bit_at = bit_at + 1) begin
        rx = image[byte_at][bit_at]; #{bit};
      end
      rx = 1; #{bit};
    end
    // While an image is loaded the converter is read, too.
    begun = transfer;
    wait (transfer == begun + {all});
    $display("compared %0d %0d %0d", compared, differ, unknown);
    $finish;
  end
endmodule
"""

Change = Callable[[str], str]


@dataclass(frozen=True)
class Played:
    """What a simulation has shown.

    line: The bytes that the cells sent.
    compared, differ, unknown: The numbers of compared clocks, of clocks in which an output of the
        cells differs from the Verilog, and of clocks in which an output is unknown.
    """

    line: bytes
    compared: int
    differ: int
    unknown: int


def play(scene: Scene, board: Board, voltages: Codes, folder: Path, change: Change = str) -> Played:
    """Load the image of the scene, if it takes one, and play the converter's codes of voltages.

    ``change`` is applied to the netlist.
    """
    design = scene.twin()
    verilog, made = folder / "verilog", sources(scene, design, board)
    export(scene, "verilog", verilog)
    netlist = cells(verilog, made, board)
    order = (verilog / "compile_order.txt").read_text().split()
    engine = design.core
    image = image_packet(engine.loaded.to_bytes()) if engine.loaded else b""
    reader = design.converter_reader
    codes = reader.converted(voltages).ravel()
    outputs = ["sclk", "cs_n", "mosi", "tx", "converter_error"]
    outputs += [port.name for port in design.ports if port.name.startswith("dac_")]
    instances = []
    for name, module in (("one", "board"), ("two", "board_cells")):
        joined = [f".{port}({name}[{n}])" for n, port in enumerate(outputs)]
        joined += [".oscillator(oscillator)", ".miso(miso)", *([".rx(rx)"] if image else [])]
        instances.append(f"{module} {name}_of({', '.join(joined)});")
    text = BENCH.format(
        top=len(outputs) - 1,
        instances=" ".join(instances),
        codes=len(codes) - 1,
        image=max(0, len(image) - 1),
        inputs=reader.inputs,
        begin=2 * (1 << RESET_WIDTH) + 100,
        divisor=design.divisor,
        bit=2 * design.divisor,
        bytes=len(image),
        all=len(codes),
    )
    (folder / "codes.hex").write_text("".join(f"{code:03x}\n" for code in codes))
    (folder / "image.hex").write_text("".join(f"{byte:02x}\n" for byte in image or b"\0"))
    (folder / "bench.v").write_text(text)
    netlist = netlist.replace("module board(", "module board_cells(", 1)
    assert "module board_cells(" in netlist
    (folder / "cells.v").write_text(change(netlist))
    (folder / "models.v").write_text(models_for(board.family, netlist))
    files = [f"verilog/{name}" for name in [*order, "board.v"]]
    files += ["models.v", "cells.v", "bench.v"]
    compile_ = ["iverilog", "-g2012", "-s", "bench", "-o", "run", *files]
    for command in (compile_, ["vvp", "-n", "run"]):
        run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        assert run.returncode == 0, run.stdout + run.stderr
    lines = [line.split() for line in run.stdout.splitlines()]
    assert not [words for words in lines if words[0] in ("order", "stop")], run.stdout
    (counts,) = (words[1:] for words in lines if words[0] == "compared")
    line = bytes(int(words[1], 16) for words in lines if words[0] == "byte")
    return Played(line, *map(int, counts))


def frames_of(line: bytes, design: UartInstrument) -> list[tuple[int, list[int], list[int]]]:
    """The count, samples and outputs of each packet. The line begins between two packets."""
    layout = design.packet_sender.layout
    size = layout.packet_bytes
    found = []
    for at in range(0, len(line) - size + 1, size):
        frame = layout.from_payload(line[at + 3], line[at + 4 : at + size - 2])
        assert layout.to_bytes(frame) == line[at : at + size]
        found.append((frame.count, list(frame.samples), list(frame.outputs)))
    return found


def expected_of(design: UartInstrument, voltages: Codes) -> list[tuple[list[int], list[int]]]:
    """The expected samples and outputs of each frame."""
    reader = design.converter_reader
    samples = reader.process(reader.converted(voltages))
    outputs = np.asarray(design.process(voltages))
    return [(list(s), list(o)) for s, o in zip(samples.tolist(), outputs.tolist(), strict=True)]
