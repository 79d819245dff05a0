"""The certificate of a small scene, its script, and what turns it red or amber."""

from __future__ import annotations

import os
import shutil
import subprocess
import sysconfig
from pathlib import Path

import pytest
from changed_bits import KINDS, Change, draw, without_comments
from shared import Shared

from tb.certify.delivered import SCRIPT, STEPS, Wanted, deliver, write_digests
from tb.certify.page import write_page
from tb.certify.results import Result, read_results
from tb.sign_off.equal_proof import EQUAL, compare

SCENE = "rails-engine"
SEED = 3
# Changes of each kind in every run, and in all.
CHANGES, MORE = 2, 20


@pytest.fixture
def certificate(shared: Shared) -> Path:
    """The certificate of a small engine, with what its script found. Tests must not change it."""
    folder = shared.folder / "certificate"

    def make() -> None:
        for language in ("vhdl", "verilog"):
            shared.export(SCENE, language)
        folder.mkdir()
        wanted = Wanted(frames=10, seed=SEED, families=())
        made = deliver(shared.scene(SCENE), shared.build, folder, wanted, lambda _: None)
        digests = write_digests(folder)
        run(folder)
        write_page(made, read_results(folder), digests, folder)
        write_digests(folder)

    shared.once("certificate", make)
    return folder


@pytest.fixture
def copied(certificate: Path, tmp_path: Path) -> Path:
    """A copy that may be changed."""
    return Path(shutil.copytree(certificate, tmp_path / "copy"))


def run(folder: Path, *steps: str, **environment: str) -> int:
    """Run the script; its exit code."""
    path = f"{os.environ['PATH']}{os.pathsep}{sysconfig.get_path('scripts')}"
    command = ["sh", str(folder / SCRIPT), *steps]
    return subprocess.run(
        command, env={**os.environ, "PATH": path, **environment}, check=False, timeout=3600
    ).returncode


def colours(folder: Path) -> dict[str, str]:
    return {result.step: result.colour for result in read_results(folder)}


def test_every_step_is_green_but_the_one_that_was_not_asked_for(certificate: Path) -> None:
    results = read_results(certificate)
    assert [result.step for result in results] == list(STEPS)
    assert results[-1] == Result("amber", "cells", "no family was asked for")
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
    assert run(copied, "digests") == 0
    next(iter((copied / "inputs").glob("*.toml"))).write_text("x", encoding="utf-8")
    assert run(copied, "digests") == 1
    assert colours(copied) == {"digests": "red"}


def test_a_missing_tool_and_an_unknown_answer_are_amber(copied: Path) -> None:
    assert run(copied, "sums", Z3="no-such-program") == 2
    assert colours(copied) == {"sums": "amber"}
    unknown = copied / "unknown"
    unknown.write_text("#!/bin/sh\necho unknown\n", encoding="ascii")
    unknown.chmod(0o755)
    assert run(copied, "sums", "properties", Z3=str(unknown)) == 2
    assert colours(copied) == {"properties": "amber", "sums": "amber"}


def test_a_weight_that_is_too_large_can_overflow(copied: Path) -> None:
    file = copied / "sums" / "sums.smt2"
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace("(* ", "(* 100000 ", 1), encoding="utf-8")
    assert run(copied, "sums") == 1


def check(folder: Path, change: Change) -> None:
    """A changed bit turns the script red, or is proved to change nothing."""
    sound = (folder / change.file).read_bytes()
    change.make(folder)
    run(folder, "equality", "vhdl", "verilog", DIGESTS="0")
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
    check(copied, change)


@pytest.mark.all_only
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("number", range(CHANGES, MORE))
def test_more_changed_bits_turn_the_script_red(copied: Path, kind: str, number: int) -> None:
    *_, change = draw(copied, kind, number + 1, SEED)
    check(copied, change)
