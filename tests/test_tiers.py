"""Tests the two tiers of make test: it counts what ALL=1 adds, and an empty selection fails."""

import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import pytest
from conftest import long_first, tiered

from tactus.verify.benches.collected import ROOT

# A test of the second tier that takes less than a second.
LEFT = "tests/test_bench_planning.py::test_the_benches_of_a_drawn_scene_have_a_plan[20]"


@cache
def run(*words: str) -> subprocess.CompletedProcess[str]:
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTEST")}
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *words]
    return subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )


@pytest.mark.parametrize("cores", tiered([("-n", "1")], [()]), ids=["workers", "alone"])
@pytest.mark.parametrize("chosen", [(LEFT,), ("tests/test_lut.py", "-k", "no_such_test")])
def test_a_choice_that_runs_nothing_fails(chosen: tuple[str, ...], cores: tuple[str, ...]) -> None:
    result = run(*chosen, *cores)
    assert result.returncode == pytest.ExitCode.NO_TESTS_COLLECTED
    assert "error: no test was chosen that could run" in result.stdout


def test_a_file_that_is_missing_is_named() -> None:
    result = run("test_lut.py", "-n", "1")
    assert result.returncode == pytest.ExitCode.USAGE_ERROR
    assert "TESTS=test_lut.py: no such file or folder; did you mean" in result.stderr


def test_the_summary_counts_what_is_left() -> None:
    said = run(LEFT, "-n", "1").stdout
    assert "[1] tests/test_bench_planning.py" in said
    assert "left to make test ALL=1" in said


def test_all_of_it_runs_what_is_left() -> None:
    result = run(LEFT, "--all", "-n", "1")
    assert result.returncode == 0, result.stdout
    assert "1 passed" in result.stdout


@pytest.mark.parametrize("workers", [1, 2, 3])
def test_each_worker_begins_with_benches_and_has_all_of_a_case(workers: int) -> None:
    def item(file: str, **parameters: str) -> SimpleNamespace:
        called = SimpleNamespace(params=parameters)
        return SimpleNamespace(path=Path(f"{file}.py"), callspec=called, nodeid=str(parameters))

    cases = [f"case {n}" for n in range(6)]
    benches = [item("test_benches", block=b, case=c) for c in cases for b in ("abs_unit", "lut")]
    again = [item("test_benches", case=c) for c in cases]
    others = [item("test_lut", n=str(n)) for n in range(60)]
    items = [*others, *benches, *again]
    ordered = long_first(items, workers)
    assert sorted(map(id, ordered)) == sorted(map(id, items))
    size = len(items) // workers
    shares = [ordered[n * size : (n + 1) * size] for n in range(workers)]
    found = [[i for i in share if i.path.stem == "test_benches"] for share in shares]
    assert sum(map(len, found)) == len(benches) + len(again)
    for share, mine in zip(shares, found, strict=True):
        assert share[: len(mine)] == mine
        assert len(mine) == 3 * len({i.callspec.params["case"] for i in mine})
