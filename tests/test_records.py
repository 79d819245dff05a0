"""Records are of the present source; proofs, equality and coverage of blocks can fail."""

import shutil
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from conftest import tiered
from hypothesis import given
from hypothesis import strategies as st
from shared import Shared, copied_job

from golden.activation.abs_unit import AbsUnit
from golden.common.block import Block, walk
from golden.common.border import Border, State
from golden.common.port import Unsigned, input_port, output_port
from golden.input_error import InputError
from golden.layers.argmax import Argmax
from golden.layers.weighted_sum import WeightedSum
from golden.networks.parallel import Neuron
from golden.numbers.fixed import Fix, Rounding, cut
from golden.numbers.precision import SIGNAL
from tactus.scene import DEFAULT_SCENES
from tactus.verify import sim
from tactus.verify.benches.collected import BENCHES, CASES, CASES_OF, PROOFS, properties_of
from tactus.verify.benches.runner import Job, run_job
from tactus.verify.sign_off import equal, prove, record
from tactus.verify.sign_off.equal import Pair, compare, netlists_of
from tactus.verify.sign_off.equal_netlist import netlists, to_verilog
from tactus.verify.sign_off.netlist import KIND as NETLIST
from tactus.verify.sign_off.netlist import SCENES, families_of
from tactus.verify.sign_off.record import (
    COMMANDS,
    another_trace,
    read_record,
    recorded_cases,
    records,
    short,
    stale_records,
    verilog,
)
from tactus.verify.sign_off.solver import Answer, Inquiry
from tactus.verify.sign_off.unknown import UNKNOWN
from tb.common.coverage import Coverage, add, missing
from tb.common.properties import Property

NAMES = {name: case for block in BENCHES for name, case in recorded_cases(block).items()}


def test_every_block_is_recorded_and_nothing_else() -> None:
    assert sorted(NAMES) == sorted(records("mutation")) == sorted(records(UNKNOWN))
    compared = {(block, case) for block in BENCHES for case in equal.cases(block)}
    found = records(equal.KIND).items()
    assert {(name.partition(".")[0], one["scene"]) for name, one in found} == compared
    assert sorted(BENCHES) == sorted(records(NETLIST))
    assert sorted(PROOFS) == sorted(records("proof"))
    assert set(PROOFS) <= set(BENCHES)


@pytest.mark.parametrize("name", NAMES)
def test_records_of_a_case_are_of_this_verilog(shared: Shared, name: str) -> None:
    block = name.partition(".")[0]
    job = shared.subject(block, case=NAMES[name])
    for kind in ("mutation", UNKNOWN):
        again = f"run: {COMMANDS[kind].format(block)}"
        assert read_record(kind, name)["verilog"] == short(verilog(job)), again
    score = read_record("mutation", name)
    assert (score["entity"], score["scene"]) == (job.entity, job.scene.name)
    registers = read_record(UNKNOWN, name)
    assert registers["passed"]
    assert bool(registers["control"]) == bool(registers["reset"])
    assert registers["control proved over clocks"] is None


@pytest.mark.parametrize("block", BENCHES)
def test_records_of_a_block_are_of_this_source(shared: Shared, block: str) -> None:
    for case in equal.cases(block):
        assert Pair(*(shared.subject(block, case, s) for s in ("icarus", "ghdl"))).stale() == []
    if block in PROOFS:
        planned = prove.entities(block, shared.subject)
        assert prove.check_record(planned) == []
        for items in map(properties_of, planned):
            assert len({item.name for item in items}) == len(items)
            assert all(item.refuted_by for item in items)
    runs = read_record(NETLIST, block)["runs"]
    again = f"run: {COMMANDS[NETLIST].format(block)}"
    assert all(run["passed"] and run["compared"] for run in runs), again
    found: dict[str, set[str]] = {}
    for run in runs:
        found.setdefault(run["verilog"], set()).add(run["family"])
    jobs = [shared.subject(block, case=case) for case in recorded_cases(block).values()]
    jobs += [job for name in SCENES for job in shared.jobs(name, "icarus") if job.block == block]
    expected: dict[str, set[str]] = {}
    for job in jobs:
        expected.setdefault(short(verilog(job)), set(families_of(job)))
    assert found == expected, again


BLOCK = "abs_unit"


@pytest.mark.parametrize(("seed", "kinds"), [(1, []), (2, list(COMMANDS))], ids=["same", "other"])
def test_another_trace_makes_records_stale(shared: Shared, tmp_path, seed: int, kinds: list[str]):
    job = shared.subject(BLOCK)
    (tmp_path / job.scene.name).mkdir()
    (tmp_path / job.scene.name / "verilog").symlink_to(job.hdl_folder)
    outcome = run_job(replace(job, build=tmp_path, seed=seed))
    assert outcome.passed
    found = stale_records(outcome)
    assert [line.split("run: ")[1] for line in found] == [COMMANDS[k].format(BLOCK) for k in kinds]


def test_what_another_scene_plays_is_not_compared(shared: Shared) -> None:
    outcome = run_job(shared.subject(BLOCK))
    outcome.facts["played"] = {"another": "trace"}
    assert stale_records(outcome)
    other = replace(outcome.job, scene=shared.scene("digit"))
    assert stale_records(replace(outcome, job=other)) == []


def test_a_record_of_some_tests_is_of_those() -> None:
    recorded = {"tests": "(a)", "played": {"a": "1"}}
    assert not another_trace(recorded, {"a": "1", "b": "2"})
    assert another_trace(recorded, {"a": "3", "b": "2"})
    assert another_trace(recorded, {"b": "2"})
    assert another_trace(recorded | {"played": {}}, {"a": "1"})
    whole = recorded | {"tests": "all"}
    assert another_trace(whole, {"a": "1", "b": "2"})
    assert not another_trace(whole, {"a": "1"})


@pytest.fixture
def rows(shared: Shared) -> Job:
    """A block with few registers."""
    return prove.entities("output_controller", shared.subject)[0]


def property_with(**changes: object) -> Property:
    sound = Property("bound", "It counts to two.", ("count <= 2",), ((r"count \+ 1", "count + 3"),))
    return replace(sound, **changes)


def proved(job: Job, item: Property) -> Answer:
    return Inquiry(job, item).ask("prove")


def test_proved_and_refuted(rows: Job) -> None:
    for item in properties_of(rows):
        assert prove.settle(rows, item).faults == [], item.name


def test_what_is_false_is_refuted_with_a_trace(rows: Job) -> None:
    answer = proved(rows, property_with(states=("count <= 1",)))
    assert not answer.holds
    assert answer.failed == "REFUTED at clock 3: states_0"
    assert "$var" in answer.trace


def test_what_no_induction_shows_is_no_proof(rows: Job) -> None:
    """A register never counts so far, but to show this takes more clocks than the induction has."""
    watch = "reg [7:0] far = 0; always @(posedge clk) far <= rst || far == 4 ? 0 : far + 1;"
    item = property_with(states=("far != 100",), watch=watch)
    assert "no induction over 3 clocks" in proved(rows, item).failed
    assert proved(rows, replace(item, induction=0)).holds
    assert proved(rows, replace(item, helps=("far <= 4",))).holds


def test_a_contradiction_proves_nothing(rows: Job) -> None:
    item = property_with(assumes={"never": "0"})
    assert "contradicts itself" in proved(rows, item).failed


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({"reached": ("count == 3",)}, "reached_0 is not reached in 20 clocks"),
        ({"refuted_by": ((r"in_valid", "(!in_valid)"),)}, "does not refute it"),
        ({"states": ("count <= 1",)}, "REFUTED"),
    ],
)
def test_a_proof_that_means_nothing_is_a_fault(rows: Job, changes: dict, fault: str) -> None:
    assert fault in "; ".join(prove.settle(rows, property_with(**changes)).faults)


def test_a_free_signal_takes_any_value(rows: Job) -> None:
    assert not proved(rows, property_with(free=("count",))).holds
    with pytest.raises(InputError, match="nothing"):
        proved(rows, property_with(free=("nothing",)))


def test_a_pattern_that_is_nowhere_is_an_error(rows: Job) -> None:
    with pytest.raises(InputError, match="changes nothing"):
        prove.settle(rows, property_with(refuted_by=(("nowhere", ""),)))


def test_a_stale_record_names_the_command(rows: Job, tmp_path: Path, monkeypatch) -> None:
    found = read_record("proof", "output_controller")
    monkeypatch.setattr(record, "RECORDS", tmp_path)
    (missing,) = prove.check_record([rows])
    (lost,) = record.of_another_source(equal.KIND, "engine.rails-lanes", "")
    assert lost.endswith("is missing; run: make prove BLOCK=engine RECORD=1")
    record.write_record("proof", "output_controller", {**found, "source": "other"})
    (stale,) = prove.check_record([rows])
    record.write_record("proof", "output_controller", {**found, "properties": []})
    (lacking,) = prove.check_record([rows])
    assert "another source" in stale
    assert "other properties than tb_output_controller.py" in lacking
    assert all(
        record.PROVE.format("output_controller") in text for text in (missing, stale, lacking)
    )


def test_a_block_is_simulated_in_the_case_of_its_records(tmp_path: Path, capsys) -> None:
    (scene,) = sim.scenes(None, "axis_network", tmp_path)
    assert scene.name == NAMES["axis_network"]
    assert f"case {scene.name}: the first of the bench of axis_network" in capsys.readouterr().out
    (scene,) = sim.scenes("digit-single", "hybrid", tmp_path)
    assert (scene.name, capsys.readouterr().out) == ("digit-single", "")
    assert [one.name for one in sim.scenes(None, None, tmp_path)] == [*DEFAULT_SCENES]


def test_a_bench_without_a_case_is_told(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setitem(CASES_OF, "abs_unit", [])
    with pytest.raises(InputError, match="BLOCK=abs_unit: CASES of its bench: got none, expected"):
        sim.scenes(None, "abs_unit", tmp_path)


class Counter(Block):
    """A block with one border, one state and ports of each kind."""

    block = "counter"

    @property
    def borders(self) -> tuple[Border, ...]:
        return (
            Border("full", "count", 5),
            Border("over", "count", 50, unreachable="it stops at 7"),
        )

    @property
    def states(self) -> tuple[State, ...]:
        return (State("count", range(3)),)

    @property
    def ports(self):
        winner = Argmax(SIGNAL, 3).result_ports("winner")[1]
        return (input_port("in_valid", ""), output_port("addr", "", Unsigned(2, last=2)), winner)

    @property
    def unreachable(self) -> dict[str, str]:
        return {"addr=1": "it is skipped"}


def test_what_is_not_met_is_named() -> None:
    coverage = Coverage(Counter())
    coverage.meet("count", np.array([4, 4, 6]))
    coverage.visit(State("count", range(3)), np.array([0, 2, 2, 9]))
    coverage.count_port("in_valid", ["1", "1", "X"])
    coverage.count_port("addr", ["00", "11", "UU"])
    assert missing(Counter(), coverage.counts) == [
        "border full: nothing at 5",
        "state count: never 1",
        "port in_valid: never 0",
        "port addr: never 2",
    ]
    more = Coverage(Counter())
    more.meet("count", np.array([5]))
    more.visit(State("count", range(3)), np.array([1]))
    more.count_port("in_valid", ["0"])
    more.count_port("addr", ["10"])
    add(coverage.counts, more.counts)
    assert missing(Counter(), coverage.counts) == []
    assert coverage.counts["borders"]["full"] == {"below": 2, "from": 1}
    assert coverage.counts["ports"]["addr"] == {"0": 1, "1": 0, "2": 1}


def test_a_border_that_is_not_met_fails_the_bench(shared: Shared, tmp_path, monkeypatch) -> None:
    """The twin names one more border than the bench reaches."""
    block = shared.subject("abs_unit")
    known = AbsUnit.borders.fget
    more = property(lambda unit: (*known(unit), Border("another", "code", 10**6)))
    monkeypatch.setattr(AbsUnit, "borders", more)
    outcome = run_job(copied_job(block, tmp_path))
    assert not outcome.passed
    assert (
        outcome.complaint()
        == f"Error: {block.entity}: not driven: border another: nothing at 999999"
    )


SMALL = Fix(4, 3)
CODES = range(SMALL.low, SMALL.high + 1)
WEIGHT = st.integers(-15, 15)


def total(weights: list[int], frame, start: int, shift: int) -> int:
    return start + sum((w * int(x)) >> shift for w, x in zip(weights, frame, strict=True))


@given(
    st.lists(WEIGHT, min_size=1, max_size=2),
    st.integers(-12, 12),
    st.integers(0, 3),
    st.integers(-300, 300),
    st.booleans(),
)
def test_of_two_weights_none_is_closer(weights, bias, shift, target, above) -> None:
    layer = WeightedSum(SMALL, Fix(6, 2), Fix(4, 0), shift)
    start = bias << layer.bias_shift
    sums = [total(weights, frame, start, shift) for frame in product(CODES, repeat=len(weights))]
    side = [s for s in sums if (s >= target if above else s <= target)]
    found = layer.closest(weights, bias, target, above, np.random.default_rng(0))
    if not any(weights):
        return
    if not side:
        assert found is None
    else:
        assert found is not None
        best = min(side) if above else max(side)
        assert total(weights, found, start, shift) == best


def test_a_sum_saturates_from_its_border_on() -> None:
    neuron = Neuron(SMALL, Fix(6, 3), SMALL, 0, (9, -11, 7), 3)
    low, high = neuron.ends
    kept = cut(np.array([low - 1, low, high - 1, high]), neuron.out_shift, Rounding.ROUND)
    assert kept.tolist() == [SMALL.low - 1, SMALL.low, SMALL.high, SMALL.high + 1]
    below, above = neuron.borders_of("sum", neuron.weights, neuron.bias)
    assert (below.at, above.at) == (low, high)
    assert not below.unreachable
    assert not above.unreachable


# These are compared in every run. make prove compares all blocks.
QUICK = ("output_controller",)
# The benches of these blocks run on their VHDL netlists: in every run one with a table and
# registers, and with ALL=1 one of each area, with arithmetic, memories and streams. The others
# follow from records that test_records.py compares: their netlists equal the Verilog, which
# passes the bench.
PLAYED = ("comparator_bank",)
OF_EACH_AREA = (
    *("pade", "readout", "argmax", "engine", "frame_window"),
    "load_profile",
)


def pair(shared: Shared, block: str) -> Pair:
    return Pair(shared.subject(block), shared.subject(block, simulator="ghdl"))


@pytest.mark.parametrize("block", QUICK)
def test_equal(shared: Shared, block: str) -> None:
    ((both, differ),) = equal.settle([pair(shared, block)])
    assert differ == []
    facts = read_record(equal.KIND, block)
    assert {**facts, "yosys": ""} == {**short(both.facts()), "yosys": ""}


@pytest.mark.all_only
def test_every_part_is_compared_in_some_case(shared: Shared) -> None:
    compared = {
        part.block
        for block in BENCHES
        for case in equal.cases(block)
        for first in [next(p for p in walk(shared.scene(case).twin()) if p.block == block)]
        for part in walk(first)
    }
    assert {part.block for case in CASES for part in walk(shared.scene(case).twin())} == compared


@pytest.mark.parametrize("block", tiered(PLAYED, OF_EACH_AREA))
def test_the_netlist_of_the_vhdl_passes_the_bench(
    shared: Shared, tmp_path: Path, block: str
) -> None:
    """GHDL's netlist behaves as its simulator does, because the same bench passes."""
    both = pair(shared, block)
    job = replace(both.verilog, build=tmp_path)
    shutil.copytree(both.verilog.hdl_folder, job.hdl_folder)
    for entity in both.entities:
        text = f"`timescale 1ns/10ps\n{to_verilog(netlists_of(both.vhdl.hdl_folder)[entity])}"
        (job.hdl_folder / f"{entity}.v").write_text(text)
    outcome = run_job(job)
    assert outcome.passed, outcome.complaint()


# Small entities in both languages: ports, declarations and statements. x is signed, u is not.
VHDL = """library IEEE;
use IEEE.std_logic_1164.all;
use IEEE.numeric_std.all;
entity small is
    port (clk: in std_logic; x: in signed(7 downto 0); u: in unsigned(0 downto 0);
          write: in std_logic; y: out signed(7 downto 0));
end entity small;
architecture rtl of small is
    signal kept: signed(7 downto 0);
    type t_array_memory is array(0 to 5) of signed(7 downto 0);
    signal memory: t_array_memory;
    signal addr: unsigned(2 downto 0);
begin
    addr <= unsigned(x(2 downto 0));
    y <= kept;
    process (clk) is begin
        if rising_edge(clk) then
            {vhdl}
        end if;
    end process;
end architecture rtl;
"""
VERILOG = """module small (input clk, input signed [7:0] x, input [0:0] u, input write,
              output signed [7:0] y);
reg signed [7:0] kept;
reg signed [7:0] memory [0:5];
wire [2:0] addr = x[2:0];
assign y = kept;
always @(posedge clk) begin
    {verilog}
end
endmodule
"""
# VHDL, its meaning in Verilog, and the Verilog with a mistake. Most mistakes are those of GHDL.
MEANT = {
    "default of a choice": (
        "case to_integer(addr) is when 0 => kept <= x; when others => kept <= -x; end case;",
        "case (addr) 0: kept <= x; default: kept <= -x; endcase",
        "case (addr) 0: kept <= x; endcase",
    ),
    "arithmetic shift": ("kept <= shift_right(x, 3);", "kept <= x >>> 3;", "kept <= x >> 3;"),
    "number wider than its wire": (
        "if u < 2 then kept <= x; end if;",
        "if (u < 2) kept <= x;",
        "if (u < 0) kept <= x;",
    ),
    "product with a sign": (
        "kept <= resize(shift_right(x * x(3 downto 0), 4), 8);",
        "kept <= ({{4{x[7]}}, x} * {{8{x[3]}}, x[3:0]}) >> 4;",
        "kept <= ({{4{x[7]}}, x} * {8'b0, x[3:0]}) >> 4;",
    ),
    "read or write": (
        "if write = '1' then memory(to_integer(addr)) <= x;"
        " else kept <= memory(to_integer(addr)); end if;",
        "if (write) memory[addr] <= x; else kept <= memory[addr];",
        "if (write) begin memory[addr] <= x; kept <= memory[addr]; end",
    ),
}


def small(tmp_path: Path, vhdl: str) -> str:
    """GHDL's netlist of the small entity as Verilog."""
    text = VHDL.replace("{vhdl}", vhdl)
    (tmp_path / "small.vhd").write_text(text)
    return to_verilog(netlists([tmp_path / "small.vhd"], "small")["small"])


@pytest.mark.parametrize("what", MEANT)
def test_meant_by_the_standard_and_not_as_ghdl_prints_it(tmp_path: Path, what: str) -> None:
    vhdl, right, wrong = MEANT[what]
    gate = small(tmp_path, vhdl)
    for text, same in ((right, True), (wrong, False)):
        gold = VERILOG.replace("{verilog}", text)
        assert (compare("small", gold, gate, []) == []) == same, text


def test_a_mistake_of_ghdl_that_is_not_mended_is_found(tmp_path: Path) -> None:
    """GHDL swaps number and signal, so no block may have such a subtraction."""
    gate = small(tmp_path, "kept <= 100 - x;")
    gold = VERILOG.replace("{verilog}", "kept <= 100 - x;")
    assert compare("small", gold, gate, []) == ["kept.d"]


def test_registers_of_one_language_alone_are_named(tmp_path: Path) -> None:
    gold = VERILOG.replace("{verilog}", "other <= x; kept <= other;")
    gold = gold.replace("assign y", "reg signed [7:0] other; assign y")
    (where,) = compare("small", gold, small(tmp_path, "kept <= x;"), [])
    assert where.startswith("a register of one side alone, gold/")


def test_vhdl_that_ghdl_refuses_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"^small: ghdl --synth: "):
        small(tmp_path, "kept <= x and;")


def test_a_latch_is_an_error(tmp_path: Path) -> None:
    gold = VERILOG.replace("assign y", "reg l; always @* if (write) l = u; assign y")
    with pytest.raises(InputError, match="dlatch"):
        compare("small", gold.replace("{verilog}", "kept <= l;"), small(tmp_path, "kept <= x;"), [])
