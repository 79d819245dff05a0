"""Tests the two tiers of make test: it counts what ALL=1 adds, and an empty selection fails."""

import os
import re
import subprocess
import sys

import pytest

from tactus.verify.benches.collected import ROOT

# A test of the second tier that takes less than a second.
LEFT = "tests/test_mutate.py::test_a_selection_that_yosys_takes_out_is_an_error"


def run(*words: str) -> subprocess.CompletedProcess[str]:
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTEST")}
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *words]
    return subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )


def test_a_file_that_is_missing_is_named() -> None:
    result = run("test_gradient.py", "-n", "1")
    assert result.returncode == pytest.ExitCode.USAGE_ERROR
    assert "TESTS=test_gradient.py: no such file or folder; did you mean" in result.stderr


def test_the_summary_counts_what_is_left_and_a_choice_that_runs_nothing_fails() -> None:
    result = run(LEFT)
    assert "[1] tests/test_mutate.py" in result.stdout
    assert "left to make test ALL=1" in result.stdout
    assert result.returncode == pytest.ExitCode.NO_TESTS_COLLECTED
    assert "error: no test was chosen that could run" in result.stdout


def test_a_block_and_pages_are_selections_of_pytest() -> None:
    def chosen(*words: str) -> str:
        said = subprocess.run(
            [sys.executable, "tests/chosen.py", *words],
            cwd=ROOT,
            env=os.environ | {"DRY": "1"},
            capture_output=True,
            text=True,
            check=False,
        )
        return said.stdout + said.stderr

    assert "pytest -k comparator_bank and not test_site" in chosen("--block=comparator_bank")
    assert re.search(r"pytest -m pages .*tests/test_pages\.py", chosen("--pages"))
    assert "did you mean 'comparator_bank'" in chosen("--block=comparater_bank")
