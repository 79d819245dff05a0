"""The records of every block exist and are of its present source, whatever was recorded."""

import pytest
from shared import Shared

from tactus.verify.benches.collected import BENCHES
from tactus.verify.sign_off import coverage, equal, prove
from tactus.verify.sign_off.coverage import named_by
from tactus.verify.sign_off.current import COMMANDS, of_this_verilog
from tactus.verify.sign_off.netlist_record import KIND as NETLIST
from tactus.verify.sign_off.netlist_record import SCENES, Entity
from tactus.verify.sign_off.proofs import PROOFS
from tactus.verify.sign_off.record import read_record, records, short
from tactus.verify.sign_off.source import verilog
from tactus.verify.sign_off.subject import recorded_cases
from tactus.verify.sign_off.unknown import UNKNOWN

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")

NAMES = {name: case for block in BENCHES for name, case in recorded_cases(block).items()}


def test_every_block_has_a_score() -> None:
    assert sorted(NAMES) == sorted(records("mutation"))
    assert set(PROOFS) <= set(BENCHES)


@pytest.mark.parametrize("name", NAMES)
def test_records_of_a_case_are_of_this_verilog(shared: Shared, name: str) -> None:
    block = name.partition(".")[0]
    job = shared.subject(block, case=NAMES[name])
    now = verilog(job)
    found = [of_this_verilog(kind, name, now) for kind in ("mutation", coverage.KIND, UNKNOWN)]
    assert found == [""] * 3
    score = read_record("mutation", name)
    assert (score["entity"], score["scene"]) == (job.entity, job.scene.name)
    again = f"the twin names something else; run: make coverage BLOCK={block} RECORD=1"
    assert read_record(coverage.KIND, name)["named"] == short(named_by(job.twin)), again
    registers = read_record(UNKNOWN, name)
    assert registers["passed"]
    assert bool(registers["control"]) == bool(registers["reset"])
    assert registers["control proved over clocks"] is None


@pytest.mark.parametrize("block", BENCHES)
def test_records_of_a_block_are_of_this_source(shared: Shared, block: str) -> None:
    pair = equal.Pair(shared.subject(block), shared.subject(block, "ghdl"))
    assert equal.check_record(pair) == []
    if block in PROOFS:
        planned = prove.entities(block, lambda block, case: shared.subject(block, case=case))
        assert prove.check_record(planned) == []
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
        expected.setdefault(short(verilog(job)), set(Entity(job, "").families()))
    assert found == expected, again
