"""Tests that proofs of blocks are recorded, that they can fail, and that some succeed."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from shared import Shared

from golden.input_error import InputError
from tactus.verify.benches.collected import PROOFS, properties_of
from tactus.verify.benches.runner import Job
from tactus.verify.sign_off import record
from tactus.verify.sign_off.prove import check_record, entities, settle
from tactus.verify.sign_off.solver import Answer, Inquiry
from tb.common.properties import Property

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")


@pytest.fixture
def export(shared: Shared) -> Callable[[str, str], Job]:
    """A function from block and case to the first entity of the block, with a shared export."""

    return lambda block, case: shared.subject(block, case=case)


@pytest.fixture
def rows(export: Callable[[str, str], Job]) -> Job:
    """A block with few registers."""
    return entities("output_controller", export)[0]


def property_with(**changes: object) -> Property:
    sound = Property("bound", "It counts to two.", ("count <= 2",), ((r"count \+ 1", "count + 3"),))
    return replace(sound, **changes)


def proved(job: Job, item: Property, folder: Path) -> Answer:
    return Inquiry(job, item, folder).prove()


@pytest.mark.parametrize("block", PROOFS)
def test_every_property_can_fail(export: Callable[[str, str], Job], block: str) -> None:
    for job in entities(block, export):
        items = properties_of(job)
        assert len({item.name for item in items}) == len(items)
        assert all(item.refuted_by for item in items)


def test_proved_and_refuted(rows: Job, tmp_path: Path) -> None:
    for item in properties_of(rows):
        assert settle(rows, item, tmp_path / "work").faults == [], item.name


def test_what_is_false_is_refuted_with_a_trace(rows: Job, tmp_path: Path) -> None:
    answer = proved(rows, property_with(states=("count <= 1",)), tmp_path)
    assert not answer.holds
    assert answer.failed == "REFUTED at clock 3: states_0"
    assert "$var" in answer.trace


def test_what_no_induction_shows_is_no_proof(rows: Job, tmp_path: Path) -> None:
    """A register never counts so far, but to show this takes more clocks than the induction has."""
    watch = "reg [7:0] far = 0; always @(posedge clk) far <= rst || far == 4 ? 0 : far + 1;"
    item = property_with(states=("far != 100",), watch=watch)
    assert "no induction over 3 clocks" in proved(rows, item, tmp_path).failed
    assert proved(rows, replace(item, induction=0), tmp_path).holds
    assert proved(rows, replace(item, helps=("far <= 4",)), tmp_path).holds


def test_a_contradiction_proves_nothing(rows: Job, tmp_path: Path) -> None:
    item = property_with(assumes={"never": "0"})
    assert "contradicts itself" in proved(rows, item, tmp_path).failed


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({"reached": ("count == 3",)}, "reached_0 is not reached in 20 clocks"),
        ({"refuted_by": ((r"in_valid", "(!in_valid)"),)}, "does not refute it"),
        ({"states": ("count <= 1",)}, "REFUTED"),
    ],
)
def test_a_proof_that_means_nothing_is_a_fault(
    rows: Job, tmp_path: Path, changes: dict, fault: str
) -> None:
    assert fault in "; ".join(settle(rows, property_with(**changes), tmp_path).faults)


def test_a_free_signal_takes_any_value(rows: Job, tmp_path: Path) -> None:
    assert not proved(rows, property_with(free=("count",)), tmp_path).holds
    with pytest.raises(InputError, match="nothing"):
        proved(rows, property_with(free=("nothing",)), tmp_path)


def test_a_pattern_that_is_nowhere_is_an_error(rows: Job, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="changes nothing"):
        settle(rows, property_with(refuted_by=(("nowhere", ""),)), tmp_path)


def test_a_stale_record_names_the_command(rows: Job, tmp_path: Path, monkeypatch) -> None:
    found = record.read_record("proof", "output_controller")
    monkeypatch.setattr(record, "RECORDS", tmp_path)
    (missing,) = check_record([rows])
    record.write_record("proof", "output_controller", {**found, "source": "other"})
    (stale,) = check_record([rows])
    record.write_record("proof", "output_controller", {**found, "properties": []})
    (lacking,) = check_record([rows])
    assert "another source" in stale
    assert "other properties than tb_output_controller.py" in lacking
    assert all(
        record.PROVE.format("output_controller") in text for text in (missing, stale, lacking)
    )
