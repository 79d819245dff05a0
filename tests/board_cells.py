"""Simulates a whole board as cells of its device beside its Verilog, from converter to line."""

import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from golden.instruments.uart_instrument import UartInstrument
from golden.link.packets import image_packet
from golden.networks.engine import Engine
from golden.numbers.fixed import Codes
from tactus.boards import Board
from tactus.boards.bitstream import cells, sources
from tactus.boards.wrapper import RESET_WIDTH
from tactus.export.exporter import export
from tactus.scene import Scene
from tactus.verify.sign_off.cell_models import models_for

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
    assert isinstance(design, UartInstrument)
    verilog, made = folder / "verilog", sources(scene, design, board)
    export(scene, "verilog", verilog)
    netlist = cells(verilog, made, board)
    order = (verilog / "compile_order.txt").read_text().split()
    engine = design.core
    assert isinstance(engine, Engine)
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
