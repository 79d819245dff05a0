"""Simulates a peer's pipeline in Icarus, with one frame per clock."""

from pathlib import Path

import numpy as np

from golden.input_error import InputError
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from studies.peers.installed import run

BENCH = """`timescale 1ns / 1ps
module play;
    reg clk = 0;
    reg [{taken}-1:0] frames [0:{count}-1];
    reg [{taken}-1:0] model_inp;
    wire [{given}-1:0] model_out;
    integer n;
    peer dut (.clk(clk), .model_inp(model_inp), .model_out(model_out));
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


def check(
    name: str,
    verilog: Path,
    frames: Codes,
    expected: Codes,
    clocks: int,
    widths: tuple[int, int] = (SIGNAL.width, SIGNAL.width),
) -> None:
    """Refuse a pipeline whose outputs differ from those of its own project's model.

    The parameters are those of ``simulated``.
    """
    assert_equal_outputs(
        name, simulated(verilog, frames, expected.shape[1], clocks, widths), expected
    )


def assert_equal_outputs(name: str, found: Codes, expected: Codes) -> None:
    """Refuse outputs that differ from those of a model."""
    wrong = int((found != expected).any(axis=1).sum())
    if wrong:
        raise InputError(
            f"{name}: {wrong} of {len(expected)} frames differ between simulation and model, "
            "expected none"
        )


def simulated(
    verilog: Path,
    frames: Codes,
    outputs: int,
    clocks: int,
    widths: tuple[int, int] = (SIGNAL.width, SIGNAL.width),
) -> Codes:
    """The outputs of a pipeline without a handshake, ``clocks`` edges after each frame.

    verilog: A folder with ``.v`` files and the files that they read. Their module ``peer`` has
        ports ``clk``, ``model_inp`` and ``model_out``; the first code of a frame is in the lowest
        bits.
    frames, shape (frames, inputs): The codes of the samples.
    widths: The bits of a sample and of an output.
    """
    taken, given = widths[0] * frames.shape[1], widths[1] * outputs
    words = [f"{packed(frame, widths[0]):x}" for frame in frames.tolist()]
    (verilog / "frames.hex").write_text("\n".join([*words, ""]), encoding="utf-8")
    sources = sorted(file.name for file in verilog.glob("*.v"))
    bench = BENCH.format(taken=taken, given=given, count=len(frames), clocks=clocks)
    (verilog / "play.bench").write_text(bench, encoding="utf-8")
    run(["iverilog", "-g2012", "-s", "play", "-o", "play.vvp", *sources, "play.bench"], verilog)
    printed = run(["vvp", "-n", "play.vvp"], verilog).split()
    unknown = [word for word in printed if set(word.lower()) & set("xz")]
    if unknown or len(printed) != len(frames):
        raise InputError(
            f"{verilog.name}: got {len(printed)} frames of outputs, {len(unknown)} with unknown "
            f"bits, expected {len(frames)} and none"
        )
    codes = [unpacked(int(word, 16), outputs, widths[1]) for word in printed]
    return np.array(codes, dtype=np.int64)


def packed(codes: list[int], width: int) -> int:
    """Codes as one word; the first code is in the lowest bits."""
    mask = (1 << width) - 1
    return sum((code & mask) << (width * n) for n, code in enumerate(codes))


def unpacked(word: int, count: int, width: int) -> list[int]:
    """The codes in a word that ``packed`` has made."""
    mask, sign = (1 << width) - 1, 1 << (width - 1)
    codes = (word >> (width * n) & mask for n in range(count))
    return [(code ^ sign) - sign for code in codes]
