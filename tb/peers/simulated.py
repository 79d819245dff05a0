"""Simulates a peer's pipeline in Icarus, with one frame per clock."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from golden.fixed import Codes
from golden.input_error import InputError
from golden.precision import SIGNAL
from tb.peers.installed import run

BENCH = """`timescale 1ns / 1ps
module play;
    reg clk = 0;
    reg [{taken}-1:0] frames [0:{count}-1];
    reg [{taken}-1:0] model_inp;
    wire [{given}-1:0] model_out;
    integer n;
    {top} dut (.clk(clk), .model_inp(model_inp), .model_out(model_out));
    initial begin
        $readmemh("frames.hex", frames);
        for (n = 0; n < {count} + {clocks} - 1; n = n + 1) begin
            model_inp = frames[n < {count} ? n : 0];
            #5 clk = 1;
            #5 clk = 0;
            if (n >= {clocks} - 1) $display("%h", model_out);
        end
    end
endmodule
"""


def simulated(verilog: Path, top: str, frames: Codes, outputs: int, clocks: int) -> Codes:
    """The outputs of a pipeline without a handshake, ``clocks`` edges after each frame.

    Parameters
    ----------
    verilog : Path
        A folder with ``.v`` files and the files that they read.
    top : str
        A module with ports ``clk``, ``model_inp`` and ``model_out``; the first code of a frame is
        in the lowest bits.
    frames : integer array, shape (frames, inputs)
        The codes of the samples.
    outputs, clocks : int

    Raises
    ------
    InputError
        When Icarus fails, or when a bit is unknown.
    """
    taken, given = (SIGNAL.width * n for n in (frames.shape[1], outputs))
    words = [f"{packed(frame):x}" for frame in frames.tolist()]
    (verilog / "frames.hex").write_text("\n".join([*words, ""]), encoding="utf-8")
    sources = sorted(file.name for file in verilog.glob("*.v"))
    bench = BENCH.format(taken=taken, given=given, count=len(frames), clocks=clocks, top=top)
    (verilog / "play.bench").write_text(bench, encoding="utf-8")
    run(["iverilog", "-g2012", "-s", "play", "-o", "play.vvp", *sources, "play.bench"], verilog)
    printed = run(["vvp", "-n", "play.vvp"], verilog).split()
    unknown = [word for word in printed if set(word.lower()) & set("xz")]
    if unknown or len(printed) != len(frames):
        raise InputError(
            f"{top}: got {len(printed)} frames of outputs, {len(unknown)} with unknown bits, "
            f"expected {len(frames)} and none"
        )
    return np.array([unpacked(int(word, 16), outputs) for word in printed], dtype=np.int64)


def packed(codes: list[int]) -> int:
    """Codes as one word; the first code is in the lowest bits."""
    mask = (1 << SIGNAL.width) - 1
    return sum((code & mask) << (SIGNAL.width * n) for n, code in enumerate(codes))


def unpacked(word: int, count: int) -> list[int]:
    """The codes in a word that ``packed`` has made."""
    mask, sign = (1 << SIGNAL.width) - 1, 1 << (SIGNAL.width - 1)
    codes = (word >> (SIGNAL.width * n) & mask for n in range(count))
    return [(code ^ sign) - sign for code in codes]
