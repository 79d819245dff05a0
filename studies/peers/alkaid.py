"""alkaid: installs and runs it, simulates the Verilog that it writes, and counts the cells."""

import json
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from golden.activation.bipartite_table import BLOCK_RAM, bipartite_table
from golden.input_error import InputError
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from studies.peers.task import Task, row
from tactus.core.files import replace_file
from tactus.core.fingerprint import fingerprint
from tactus.report.measure.table import Cell

REQUIREMENT = "alkaid==0.8.2"
PROGRAM = Path(__file__).with_name("alkaid_network.py")
ADDER = "shift_adder.v"
# Changes of its adder, as regular expressions. A difference whose second operand has the lower last
# place is written as two: the lower bits, and the upper ones less a borrow, which Yosys builds as a
# sum of three. Here it is one. And no sum is merged with others into carry-save form, which takes
# more LUTs.
EDITS = [
    (r"if \(SHIFT1 == 0\)", "if (SHIFT1 == 0 || (SHIFT1 < 0 && IS_SUB == 1))"),
    (r"(wire \[[^]]*\] accum;)", r"(* keep *) \1"),
]
# The rows: the operands of an adder, and the changes.
WAYS: dict[str, tuple[str, list[tuple[str, str]]]] = {
    "sums of two": ("two", EDITS),
    "sums of three": ("three", []),
}
# The lowest bits that the weights of the second layer do without, so that errors are near those of
# our design. One bit less in the first layer already raises errors by a third above these.
LEFT_OUT = {"digit-fast-full": 2}
# One frame per clock, through a pipeline without a handshake.
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


def installed(folder: Path) -> Path:
    """The Python of an environment in ``folder`` with alkaid, which is made if it is not there."""
    python, ready = folder / "bin" / "python", folder / ".ready"
    wanted = fingerprint([], REQUIREMENT, sys.version)
    if python.exists() and ready.is_file() and ready.read_text(encoding="utf-8") == wanted:
        return python
    print(f"setting up {folder}", flush=True)
    run([sys.executable, "-m", "venv", "--clear", str(folder)])
    pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    try:
        # It is written in part in C++. Without a wheel pip would try to compile it.
        run([*pip, "--only-binary", "alkaid", REQUIREMENT])
    except InputError as error:
        raise InputError(
            f"{REQUIREMENT}: not installed; this needs a network, and a wheel for this machine\n"
            f"{error}"
        ) from None
    with replace_file(ready) as temporary:
        temporary.write_text(wanted, encoding="utf-8")
    return python


def run(command: list[str], folder: Path | None = None) -> str:
    """Run a program and return what it printed."""
    name = Path(command[0]).name
    try:
        result = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        raise InputError(f"not installed: {name}") from None
    if result.returncode:
        last = (result.stdout + result.stderr).strip().splitlines()[-5:]
        raise InputError(f"{name}: " + "\n".join(last))
    return result.stdout


def question(task: Task) -> dict[str, Any]:
    """The codes of both layers, the words of our tables and the frames, in a form for JSON."""
    table = bipartite_table(BLOCK_RAM)
    first, second = (
        {"weights": layer.weights, "biases": layer.biases, "frac": layer.fmt.frac}
        for layer in (task.constants.first, task.constants.second)
    )
    below = LEFT_OUT.get(task.name, 0)
    rounded = (np.array(second["weights"]) + (1 << below >> 1)) >> below << below
    return {
        "first": first,
        "second": {**second, "weights": rounded.tolist()},
        "frames": task.frames.tolist(),
        "bases": table.bases,
        "corrections": table.corrections,
    }


def rows(python: Path, task: Task, folder: Path) -> Iterator[dict[str, Cell]]:
    """The rows of a network, whose Verilog is written into ``folder``."""
    folder.mkdir(parents=True)
    (folder / "given.json").write_text(json.dumps(question(task)), encoding="utf-8")
    # The program runs isolated, so that it sees nothing of this project.
    run([str(python), "-I", str(PROGRAM), str(folder)])
    answer = json.loads((folder / "answer.json").read_text(encoding="utf-8"))
    outputs = np.array(answer["outputs"], dtype=np.int64)
    for way, (operands, edits) in WAYS.items():
        verilog = folder / way.replace(" ", "_")
        collect(folder / operands / "src", verilog, edits)
        clocks = answer["clocks"][operands]
        found = simulated(verilog, task.frames, outputs.shape[1], clocks)
        wrong = int((found != outputs).any(axis=1).sum())
        if wrong:
            raise InputError(
                f"alkaid: {wrong} of {len(outputs)} frames differ between simulation and model, "
                "expected none"
            )
        name = f"alkaid, {way}"
        yield row(task.name, name, verilog, "peer", (clocks, 1), task.errors(outputs))


def collect(source: Path, folder: Path, edits: list[tuple[str, str]]) -> None:
    """Copy the Verilog and tables that alkaid wrote into a new folder, and change its adder."""
    folder.mkdir()
    for file in (*source.glob("*.v"), *source.glob("static/*.v"), *source.glob("memfiles/*.mem")):
        if not file.name.endswith("_wrapper.v"):
            shutil.copy(file, folder)
    for pattern, text in edits:
        path = folder / ADDER
        changed, count = re.subn(pattern, text, path.read_text(encoding="utf-8"))
        if count != 1:
            raise InputError(f"alkaid: {ADDER}: got {count} times {pattern}, expected once")
        path.write_text(changed, encoding="utf-8")


def simulated(verilog: Path, frames: Codes, outputs: int, clocks: int) -> Codes:
    """The outputs in Icarus, ``clocks`` edges after each frame.

    verilog: The files of a module ``peer`` with ports ``clk``, ``model_inp`` and ``model_out``; the
        first code of a frame is in the lowest bits.
    """
    width, mask = SIGNAL.width, (1 << SIGNAL.width) - 1
    words = [
        sum((code & mask) << (width * n) for n, code in enumerate(frame))
        for frame in frames.tolist()
    ]
    (verilog / "frames.hex").write_text("".join(f"{word:x}\n" for word in words), encoding="utf-8")
    sources = sorted(file.name for file in verilog.glob("*.v"))
    bench = BENCH.format(
        taken=width * frames.shape[1], given=width * outputs, count=len(frames), clocks=clocks
    )
    (verilog / "play.bench").write_text(bench, encoding="utf-8")
    run(["iverilog", "-g2012", "-s", "play", "-o", "play.vvp", *sources, "play.bench"], verilog)
    printed = run(["vvp", "-n", "play.vvp"], verilog).split()
    unknown = [word for word in printed if set(word.lower()) & set("xz")]
    if unknown or len(printed) != len(frames):
        raise InputError(
            f"{verilog.name}: got {len(printed)} frames of outputs, {len(unknown)} with unknown "
            f"bits, expected {len(frames)} and none"
        )
    codes = [[int(word, 16) >> (width * n) & mask for n in range(outputs)] for word in printed]
    return (np.array(codes, dtype=np.int64) ^ (mask + 1 >> 1)) - (mask + 1 >> 1)
