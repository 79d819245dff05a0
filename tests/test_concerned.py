"""make test BLOCK= and PAGES=1: what is chosen, and what is not."""

import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from concerned import concerns
from conftest import LONG
from copied import ROOT
from documented import Documented

from golden.activation.comparator_bank import ComparatorBank
from golden.activation.lut import Lut

# Neither simulates: what is listed here is chosen in a second.
FILES = ("tests/test_census.py", "tests/test_benches.py", "tests/test_docs.py")


def calls_it() -> object:
    def inside() -> object:
        return ComparatorBank

    return inside


def calls_what_calls_it() -> object:
    return calls_it()


def calls_another() -> object:
    return Lut


def item(file: str, function: object = calls_another, **parameters: object) -> SimpleNamespace:
    return SimpleNamespace(
        path=Path(f"{file}.py"),
        name="test",
        function=function,
        callspec=SimpleNamespace(params=parameters),
    )


@pytest.mark.parametrize(
    "chosen",
    [
        item("test_benches", block="comparator_bank", case="rails"),
        item("test_docs", sheet=ROOT / "docs" / "blocks" / "comparator_bank.md"),
        item("test_census", path=ROOT / "tb" / "activation" / "tb_comparator_bank.py"),
        item(
            "test_documented",
            item=Documented("make x", ROOT / "docs" / "blocks" / "comparator_bank.md"),
        ),
        item("test_comparator_bank"),
        item("test_gradient", calls_it),
        item("test_gradient", calls_what_calls_it),
    ],
    ids=lambda one: one.path.stem,
)
def test_what_concerns_a_block(chosen: SimpleNamespace) -> None:
    assert concerns(chosen, "comparator_bank", LONG)
    assert not concerns(chosen, "engine", LONG)


@pytest.mark.parametrize(
    "left",
    [
        item("test_benches", block="lut", case="comparator_bank-case"),
        item("test_gradient"),
        item("test_export", calls_it),
        item("test_site", block="comparator_bank"),
    ],
    ids=lambda one: one.path.stem,
)
def test_what_does_not(left: SimpleNamespace) -> None:
    assert not concerns(left, "comparator_bank", LONG)


def chosen(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "tests/chosen.py", *words],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )


def test_a_run_of_a_block_has_nothing_else() -> None:
    said = chosen("--block=comparator_bank", f"--tests=--collect-only -q -n 0 {' '.join(FILES)}")
    found = re.findall(r"^(tests/\w+\.py)::(.*)$", said.stdout, re.M)
    assert {file for file, _ in found} == set(FILES)
    assert all("comparator_bank" in name for _, name in found)


def test_a_block_that_there_is_not_is_refused() -> None:
    said = chosen("--block=comparater_bank")
    assert said.returncode == 2
    assert said.stderr == (
        "error: BLOCK=comparater_bank: no such block; did you mean 'comparator_bank'?\n"
    )


def test_a_run_of_the_pages_collects_only_their_files() -> None:
    said = chosen("--pages", "--tests=--collect-only -q -n 0 tests/test_pages.py tests/test_lut.py")
    assert set(re.findall(r"^(tests/\w+\.py)::", said.stdout, re.M)) == {"tests/test_pages.py"}
