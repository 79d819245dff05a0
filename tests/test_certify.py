"""The certificate of a small scene, its script, and what turns it red or amber."""

from __future__ import annotations

import shutil
from contextlib import chdir
from dataclasses import astuple
from pathlib import Path

import pytest
from changed_bits import KINDS, Change, draw, without_comments
from shared import Shared

from tb.certify.__main__ import certify
from tb.certify.delivered import STEPS, Wanted, check
from tb.certify.results import OUTPUT, StepResult, read_results
from tb.sign_off.equal_proof import EQUAL, compare

SCENE = "rails-engine"
SEED = 3
# Changes of each kind in every run, and in all.
CHANGES, MORE = 2, 20


@pytest.fixture
def certificate(shared: Shared) -> Path:
    """The certificate of a small engine, with what its script found. Tests must not change it.

    It is written as the command does it: below a folder that is named from the current one.
    """
    folder = shared.folder / "certified" / SCENE / "certificate"

    def make() -> None:
        with chdir(shared.folder):
            wanted = Wanted(frames=10, seed=SEED, families=())
            results = certify(shared.scene(SCENE), wanted, Path("certified"))
        # The command keeps what was printed only where a step is red.
        (folder / OUTPUT).mkdir(exist_ok=True)
        lines = ["\t".join(astuple(result)) for result in results]
        (folder / OUTPUT / "results.txt").write_text("\n".join(lines), encoding="utf-8")

    shared.once("certificate", make)
    return folder


@pytest.fixture
def copied(certificate: Path, tmp_path: Path) -> Path:
    """A copy that may be changed."""
    return Path(shutil.copytree(certificate, tmp_path / "copy"))


def colours(folder: Path) -> dict[str, str]:
    return {result.step: result.colour for result in read_results(folder)}


def test_every_step_is_green_but_the_one_that_was_not_asked_for(certificate: Path) -> None:
    results = read_results(certificate)
    assert [result.step for result in results] == list(STEPS)
    assert results[-1] == StepResult("amber", "cells", "no family was asked for")
    assert {result.colour for result in results[:-1]} == {"green"}, results


def test_the_page_begins_with_what_was_not_done(certificate: Path) -> None:
    text = (certificate / "certificate.md").read_text(encoding="utf-8")
    head = text.partition("| step |")[0]
    assert "- amber: cells: no family was asked for" in head
    assert "green" in text
    page = (certificate / "certificate.html").read_text(encoding="utf-8")
    assert page.index("cells: no family") < page.index("<main>")
    digests = (certificate / "SHA256SUMS").read_text(encoding="utf-8")
    assert "certificate.html" in digests
    assert "design/vhdl/engine.vhd" in digests


def test_a_changed_file_has_another_digest(copied: Path) -> None:
    (copied / "inputs" / "more.txt").write_text("x", encoding="utf-8")
    assert check(copied, "digests") == 0
    next(iter((copied / "inputs").glob("*.toml"))).write_text("x", encoding="utf-8")
    assert check(copied, "digests") == 1
    assert colours(copied) == {"digests": "red"}


def test_a_missing_tool_and_an_unknown_answer_are_amber(copied: Path) -> None:
    assert check(copied, "sums", Z3="no-such-program") == 2
    assert colours(copied) == {"sums": "amber"}
    unknown = copied / "unknown"
    unknown.write_text("#!/bin/sh\necho unknown\n", encoding="ascii")
    unknown.chmod(0o755)
    assert check(copied, "sums", "properties", Z3=str(unknown)) == 2
    assert colours(copied) == {"properties": "amber", "sums": "amber"}


def test_a_weight_that_is_too_large_can_overflow(copied: Path) -> None:
    file = copied / "sums" / "sums.smt2"
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace("(* ", "(* 100000 ", 1), encoding="utf-8")
    assert check(copied, "sums") == 1


def must_be_found(folder: Path, change: Change) -> None:
    """A changed bit turns the script red, or is proved to change nothing."""
    sound = (folder / change.file).read_bytes()
    change.make(folder)
    check(folder, "equality", "vhdl", "verilog", DIGESTS="0")
    if "red" in colours(folder).values():
        return
    changed = (folder / change.file).read_bytes()
    language = change.file.split("/")[1]
    if without_comments(changed, language) == without_comments(sound, language):
        return
    assert language == "verilog", f"{change} is not found"
    entity = Path(change.file).stem
    others = [f for f in (folder / "design/verilog").glob("*.v") if f.stem != entity]
    found = compare(entity, sound.decode(), changed.decode("latin-1"), others)
    assert found["result"] == EQUAL, f"{change} is not found"


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("number", range(CHANGES))
def test_a_changed_bit_turns_the_script_red(copied: Path, kind: str, number: int) -> None:
    *_, change = draw(copied, kind, number + 1, SEED)
    must_be_found(copied, change)


@pytest.mark.all_only
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("number", range(CHANGES, MORE))
def test_more_changed_bits_turn_the_script_red(copied: Path, kind: str, number: int) -> None:
    *_, change = draw(copied, kind, number + 1, SEED)
    must_be_found(copied, change)
